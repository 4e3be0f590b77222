//! Nested integrators.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_integrators::{IntegratorOptions, build_integrator};
use etendue_mitsuba::{LoadOptions, read_text};

/// The messages of building an integrator with another one nested in it.
fn messages(outer: &str, inner: &str) -> Vec<String> {
    let text = format!(
        r#"<scene version="3.0.0"><integrator type="{outer}">
            <integrator type="{inner}"/></integrator></scene>"#
    );
    let diagnostics = Diagnostics::new();
    let files = MemoryResources::default();
    let document = read_text(&text, &files, &LoadOptions::default(), &diagnostics).ok();
    let options = IntegratorOptions::default();
    let integrator = build_integrator(&document.unwrap(), &options, &diagnostics);
    assert!(integrator.is_some());
    diagnostics.sorted().into_iter().map(|diagnostic| diagnostic.message).collect()
}

#[test]
fn particles_that_are_left_out_are_reported() {
    for outer in ["aov", "moment"] {
        let message = format!("`{outer}` leaves out the particles of `ptracer`");
        assert_eq!(messages(outer, "ptracer"), [message]);
        assert_eq!(messages(outer, "path"), Vec::<String>::new());
    }
}
