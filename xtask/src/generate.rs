//! The commands that need the renderer. They live in a separate program (`xtask-generate`), so that
//! `cargo xtask ci` starts without compiling the renderer.

use crate::workspace::cargo;

/// `cargo xtask assets`: meshes and pictures that the scenes use.
pub(crate) fn assets(arguments: &[String]) -> bool {
    run("assets", arguments)
}

/// `cargo xtask bits`: the comparison of two binaries.
pub(crate) fn bits(arguments: &[String]) -> bool {
    run("bits", arguments)
}

/// `cargo xtask docs`: reference pages.
pub(crate) fn docs(arguments: &[String]) -> bool {
    run("docs", arguments)
}

/// `cargo xtask gallery`: the pictures of the gallery.
pub(crate) fn gallery(arguments: &[String]) -> bool {
    run("gallery", arguments)
}

/// `cargo xtask references`: the references of the test scenes.
pub(crate) fn references(arguments: &[String]) -> bool {
    run("references", arguments)
}

/// The triangles of a scene, as a file.
pub(crate) fn triangles(scene: &str, output: &str) -> bool {
    run("triangles", &[scene.to_owned(), output.to_owned()])
}

fn run(name: &str, arguments: &[String]) -> bool {
    let start = ["run", "--quiet", "--release", "--package", "xtask-generate", "--", name];
    let status = cargo().args(start).args(arguments).status();
    status.is_ok_and(|status| status.success())
}
