//! `cargo xtask package`: checks that every published crate has the metadata that a registry shows,
//! can be published in order, and compiles from its package.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::workspace::{cargo, root};

/// The fields that every manifest must have; the registry requires fewer.
const FIELDS: &[&str] =
    &["description", "readme", "keywords", "categories", "license", "repository", "rust_version"];

/// The files that every package must hold besides its code. The lock file is for `cargo install
/// --locked`.
const FILES: &[&str] = &["Cargo.lock", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];

/// A crate that is published.
struct Package {
    name: String,
    version: String,
    missing_fields: Vec<&'static str>,
}

impl Package {
    /// The name of the package's folder and, without the extension, of its archive.
    fn stem(&self) -> String {
        format!("{}-{}", self.name, self.version)
    }
}

/// Runs all checks in order; stops at the first failure.
pub(crate) fn run(_arguments: &[String]) -> bool {
    match check() {
        Ok(package_count) => {
            println!("{package_count} packages are complete and compile");
            true
        }
        Err(problem) => {
            eprintln!("{problem}");
            false
        }
    }
}

fn check() -> Result<usize, String> {
    let packages = published_packages(&read_metadata()?);
    check_fields(&packages)?;

    // Checks packed files, missing versions and the order of dependencies, without compiling.
    let dry_run = ["publish", "--workspace", "--dry-run", "--no-verify", "--allow-dirty"];
    succeed(cargo().args(dry_run).arg("--quiet"))?;

    // Cargo would compile every package separately with its dependencies. One workspace of all
    // unpacked packages compiles each of them once.
    let folder = root().join("target").join("packaged");
    unpack(&packages, &folder)?;
    check_files(&packages, &folder)?;
    write_workspace(&packages, &folder)?;
    let mut compile = cargo();
    compile.current_dir(&folder).args(["check", "--workspace", "--quiet"]);
    compile.arg("--target-dir").arg(folder.join("target"));
    succeed(&mut compile)?;
    Ok(packages.len())
}

fn read_metadata() -> Result<Value, String> {
    let output = cargo()
        .args(["metadata", "--format-version", "1", "--no-deps"])
        .output()
        .map_err(|error| format!("cannot run cargo metadata: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("cannot read the output of cargo metadata: {error}"))
}

/// The crates of the workspace without `publish = false`.
fn published_packages(metadata: &Value) -> Vec<Package> {
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let published = packages.filter(|package| package["publish"].is_null());
    published
        .map(|package| Package {
            name: package["name"].as_str().unwrap_or_default().to_owned(),
            version: package["version"].as_str().unwrap_or_default().to_owned(),
            missing_fields: FIELDS.iter().copied().filter(|&key| is_empty(&package[key])).collect(),
        })
        .collect()
}

fn is_empty(value: &Value) -> bool {
    match value {
        Value::String(text) => text.is_empty(),
        Value::Array(items) => items.is_empty(),
        _ => true,
    }
}

fn check_fields(packages: &[Package]) -> Result<(), String> {
    let incomplete = packages.iter().filter(|package| !package.missing_fields.is_empty());
    let problems: Vec<String> = incomplete
        .map(|package| format!("{} lacks {}", package.name, package.missing_fields.join(", ")))
        .collect();
    if problems.is_empty() { Ok(()) } else { Err(problems.join("\n")) }
}

/// Packs the crates and unpacks the archives into an empty `folder`. Compiled dependencies of
/// earlier runs are kept.
fn unpack(packages: &[Package], folder: &Path) -> Result<(), String> {
    let mut pack = cargo();
    pack.args(["package", "--no-verify", "--allow-dirty", "--quiet"]);
    for package in packages {
        pack.args(["--package", &package.name]);
    }
    succeed(&mut pack)?;

    fs::create_dir_all(folder).map_err(|error| cannot_write(folder, &error))?;
    let archives = root().join("target").join("package");
    for package in packages {
        let old = folder.join(package.stem());
        if old.exists() {
            fs::remove_dir_all(&old).map_err(|error| cannot_write(&old, &error))?;
        }
        let archive = archives.join(format!("{}.crate", package.stem()));
        // `m`: all files in the archive have the same time of modification, by which Cargo would not
        // notice a change.
        succeed(Command::new("tar").arg("-xzmf").arg(archive).arg("-C").arg(folder))?;
    }
    Ok(())
}

fn check_files(packages: &[Package], folder: &Path) -> Result<(), String> {
    let paths = packages.iter().flat_map(|package| {
        let package_folder = folder.join(package.stem());
        FILES.iter().map(move |file| package_folder.join(file))
    });
    let missing: Vec<PathBuf> = paths.filter(|path| !path.is_file()).collect();
    if missing.is_empty() { Ok(()) } else { Err(format!("missing in packages: {missing:?}")) }
}

/// Creates a workspace of the unpacked packages, with the versions of this repository's lock file.
fn write_workspace(packages: &[Package], folder: &Path) -> Result<(), String> {
    let manifest = folder.join("Cargo.toml");
    fs::write(&manifest, workspace_manifest(packages))
        .map_err(|error| cannot_write(&manifest, &error))?;
    let lock = folder.join("Cargo.lock");
    fs::copy(root().join("Cargo.lock"), &lock).map_err(|error| cannot_write(&lock, &error))?;
    Ok(())
}

/// Dependencies between the packages name versions; the patch redirects them to the folders.
fn workspace_manifest(packages: &[Package]) -> String {
    let members: Vec<String> =
        packages.iter().map(|package| format!("{:?}", package.stem())).collect();
    let mut text = format!("[workspace]\nresolver = \"3\"\nmembers = [{}]\n", members.join(", "));
    text.push_str("\n[patch.crates-io]\n");
    for package in packages {
        let _ = writeln!(text, "{} = {{ path = {:?} }}", package.name, package.stem());
    }
    text
}

fn succeed(command: &mut Command) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(error) => Err(format!("cannot start {:?}: {error}", command.get_program())),
    }
}

fn cannot_write(path: &Path, error: &std::io::Error) -> String {
    format!("cannot write {}: {error}", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata() -> Value {
        serde_json::json!({ "packages": [
            {
                "name": "whole", "version": "1.2.3", "publish": null, "description": "A crate.",
                "readme": "README.md", "keywords": ["a"], "categories": ["b"], "license": "MIT",
                "repository": "https://example.org", "rust_version": "1.89",
            },
            { "name": "bare", "version": "1.2.3", "publish": null, "keywords": [] },
            { "name": "tool", "version": "0.0.0", "publish": [] },
        ] })
    }

    #[test]
    fn unpublished_crates_are_left_out() {
        let names: Vec<String> =
            published_packages(&metadata()).into_iter().map(|package| package.name).collect();
        assert_eq!(names, ["whole", "bare"]);
    }

    #[test]
    fn missing_fields_are_named() {
        let packages = published_packages(&metadata());
        assert!(check_fields(&packages[..1]).is_ok());
        let problem = check_fields(&packages).unwrap_err();
        assert!(problem.starts_with("bare lacks description, readme, keywords"), "{problem}");
    }

    #[test]
    fn the_workspace_patches_every_package() {
        let manifest = workspace_manifest(&published_packages(&metadata()));
        assert!(manifest.contains("members = [\"whole-1.2.3\", \"bare-1.2.3\"]"), "{manifest}");
        assert!(manifest.contains("\nbare = { path = \"bare-1.2.3\" }\n"), "{manifest}");
    }
}
