//! Films: version 0.6's several layers in one film.

use etendue_document::{FlatNode, Value};

use super::approximation::Approximations;
use super::entries::take;

/// Upgrades one film. With `multichannel`, a film names one pixel format and one name for each
/// nested integrator; here, `aov` names the layers.
pub(super) fn upgrade(node: &mut FlatNode, approximations: &mut Approximations) {
    take(node, "channel_names");
    let formats = node.parameters.iter_mut().rfind(|parameter| parameter.name == "pixel_format");
    let Some(parameter) = formats else { return };
    let Value::String(text) = &mut parameter.value else { return };
    if let Some((first, _)) = text.split_once(',') {
        let message = "a film has one pixel format: of this list, the first counts";
        approximations.add(message, parameter.span);
        *text = first.trim().to_owned();
    }
}
