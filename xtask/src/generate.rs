//! The commands that make committed files: they need the renderer, so they are a program of their
//! own (`xtask-generate`), and `cargo xtask ci` starts without compiling it.

use crate::workspace::cargo;

/// `cargo xtask assets`: meshes and pictures that the scenes use.
pub(crate) fn assets(arguments: &[String]) -> bool {
    run("assets", arguments)
}

/// `cargo xtask docs`: reference pages.
pub(crate) fn docs(arguments: &[String]) -> bool {
    run("docs", arguments)
}

/// `cargo xtask gallery`: the pictures of the gallery.
pub(crate) fn gallery(arguments: &[String]) -> bool {
    run("gallery", arguments)
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
