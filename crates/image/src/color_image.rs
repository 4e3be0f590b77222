//! Linear RGB triples: the input of metrics and tone mapping.

use crate::{ImageError, ToneMap, exposure_scale};

/// Linear RGB, one triple per pixel, the top row first.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width × height` linear triples (BT.709 primaries), the top row first.
    pub pixels: Vec<[f32; 3]>,
}

impl ColorImage {
    /// The image as a display shows it, but still linear: exposed by some stops, tone mapped, and
    /// clamped to [0, 1]. For [`flip`](crate::metrics::flip).
    pub fn to_display(&self, tone_map: ToneMap, exposure: f32) -> Self {
        let scale = exposure_scale(exposure);
        let show = |pixel: &[f32; 3]| {
            tone_map.apply(pixel.map(|value| value * scale)).map(|value| value.clamp(0.0, 1.0))
        };
        let pixels = self.pixels.iter().map(show).collect();
        Self { width: self.width, height: self.height, pixels }
    }

    /// Checks that both images have the same size and the right number of pixels.
    ///
    /// # Errors
    /// [`ImageError::SizeMismatch`] or [`ImageError::InvalidPicture`].
    pub(crate) fn check_comparable(&self, reference: &Self) -> Result<(), ImageError> {
        let size = (self.width, self.height);
        let reference_size = (reference.width, reference.height);
        if size != reference_size {
            return Err(ImageError::SizeMismatch { image: size, reference: reference_size });
        }
        let expected = self.width as usize * self.height as usize;
        if self.pixels.len() != expected || reference.pixels.len() != expected {
            return Err(ImageError::invalid_picture("the number of pixels is not width x height"));
        }
        if expected == 0 {
            return Err(ImageError::invalid_picture("the image has no pixels"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_is_applied_before_clamping() {
        let image = ColorImage { width: 1, height: 1, pixels: vec![[0.25, 0.75, -1.0]] };
        assert_eq!(image.to_display(ToneMap::None, 1.0).pixels, vec![[0.5, 1.0, 0.0]]);
        let mapped = image.to_display(ToneMap::Agx, 1.0).pixels[0];
        assert_eq!(mapped, ToneMap::Agx.apply([0.5, 1.5, -2.0]));
    }
}
