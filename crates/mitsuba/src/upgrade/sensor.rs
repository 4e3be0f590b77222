//! Sensors: a pinhole camera with an aperture is a thin lens.

use etendue_document::{Diagnostics, Fault, FlatNode};

use super::entries::{find, number, take};

/// Turns a `perspective` sensor with an aperture into a `thinlens`, as its author intended.
pub(super) fn upgrade(node: &mut FlatNode, diagnostics: &Diagnostics) {
    if node.plugin != "perspective" {
        return;
    }
    let Some(aperture) = find(node, "aperture_radius") else {
        return;
    };
    if number(&aperture.value) == Some(0.0) {
        take(node, "aperture_radius");
        return;
    }
    let message = format!("a `perspective` with `{}` is a `thinlens`", aperture.original_name);
    diagnostics.note(Fault::Approximation, aperture.span, message);
    node.plugin = "thinlens".into();
}
