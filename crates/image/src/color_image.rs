//! Linear RGB triples: what metrics and tone mapping work on.

use crate::ImageError;

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
    /// Checks that this image and its reference have the same size and as many pixels as they say.
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
