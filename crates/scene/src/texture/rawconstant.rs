//! `rawconstant`: a constant number or vector, used as a texture.

use super::{TextureModel, Textures};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters, Value};
use etendue_spectrum::Spectrum;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The same everywhere: a number, or three as they are. For what is data and no colour, \
              such as a normal.",
    parameters: &[parameter("value", "float or vector", "", "The value; required.")],
    sample: r#"<texture type="rawconstant">
    <vector name="value" value="0.5, 0.5, 1"/>
</texture>"#,
};

/// Reads the texture.
#[must_use]
pub fn build(_: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Spectrum> {
    let value = match parameters.value("value").map(|(value, _)| value) {
        Some(Value::Vector(vector) | Value::Point(vector) | Value::Rgb(vector)) => {
            Spectrum::from_rgb(vector.as_vec3().to_array())
        }
        Some(Value::Float(number)) => Spectrum::splat(*number as f32),
        Some(Value::Integer(number)) => Spectrum::splat(*number as f32),
        Some(other) => {
            let message = format!("expected a number or a vector, found {}", other.kind());
            parameters.error(Fault::BadValue, "value", message);
            return None;
        }
        None => {
            parameters.error(Fault::MissingParameter, "value", "`rawconstant` needs a `value`");
            return None;
        }
    };
    if !value.is_finite() {
        parameters.error(Fault::BadValue, "value", "the value is not finite");
        return None;
    }
    Some(value)
}

impl TextureModel for Spectrum {
    fn eval(&self, _textures: Textures<'_>, _surface: &SurfaceInteraction) -> Spectrum {
        *self
    }

    fn mean(&self, _textures: Textures<'_>) -> Spectrum {
        *self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::Class;
    use glam::DVec3;

    #[test]
    fn vectors_stay_as_they_are() {
        let node = TestNode::new(Class::Texture, "rawconstant");
        let node = node.with("value", Value::Vector(DVec3::new(0.5, -1.0, 3.0)));
        assert_eq!(node.build_cleanly(build).rgb(), [0.5, -1.0, 3.0]);
    }

    #[test]
    fn numbers_count_for_all_three() {
        let node = TestNode::new(Class::Texture, "rawconstant").float("value", 0.25);
        assert_eq!(node.build_cleanly(build), Spectrum::splat(0.25));
    }
}
