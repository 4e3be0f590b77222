//! `clamp_indirect`: a limit on indirect light.

use etendue_spectrum::Spectrum;

/// The limit of what one vertex adds to a path's light if that light has been scattered more than
/// once. It removes fireflies, and makes pictures too dark.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClampIndirect(f32);

impl ClampIndirect {
    /// A limit on the greatest component; `None` for unlimited light.
    pub(crate) fn new(limit: Option<f32>) -> Self {
        Self(limit.unwrap_or(f32::INFINITY))
    }

    /// The limit, if there is one.
    pub(crate) fn limit(self) -> Option<f32> {
        (self.0 < f32::INFINITY).then_some(self.0)
    }

    /// Limits light that has been scattered `scattering_count` times on its way to the camera.
    #[inline(always)]
    pub(crate) fn apply(self, light: Spectrum, scattering_count: u32) -> Spectrum {
        if self.0 == f32::INFINITY || scattering_count < 2 {
            return light;
        }
        let greatest = light.max_component();
        if greatest > self.0 { light * (self.0 / greatest) } else { light }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_indirect_light_is_limited_and_it_keeps_its_hue() {
        let light = Spectrum::from_rgb([8.0, 4.0, 2.0]);
        let clamp = ClampIndirect::new(Some(2.0));
        assert_eq!(clamp.apply(light, 1), light);
        assert_eq!(clamp.apply(light, 2), Spectrum::from_rgb([2.0, 1.0, 0.5]));
        assert_eq!(clamp.apply(light * 0.25, 2), light * 0.25);
        assert_eq!(ClampIndirect::new(None).apply(light, 9), light);
    }
}
