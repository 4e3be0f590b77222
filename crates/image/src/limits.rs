//! Limits on the memory that a header may request.

use crate::ImageError;

/// Limits of a decoder. Images beyond them are rejected before memory is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// The maximum number of samples: width × height × channels.
    pub samples: u64,
    /// The maximum size of the decoded samples in bytes.
    pub bytes: u64,
}

impl Default for Limits {
    /// 2³¹ samples and 4 GiB.
    fn default() -> Self {
        Self { samples: 1 << 31, bytes: 4 << 30 }
    }
}

impl Limits {
    /// Checks the size of an image and returns its number of samples. A decoder that finds no memory
    /// ends the process, so this asks for the memory and gives it back.
    ///
    /// # Errors
    /// [`ImageError::TooLarge`] if the image has too many samples or bytes;
    /// [`ImageError::NoMemory`] if there is no memory for them.
    pub fn check(
        &self,
        width: u64,
        height: u64,
        channels: u64,
        bytes_per_sample: u64,
    ) -> Result<usize, ImageError> {
        let samples = width.saturating_mul(height).saturating_mul(channels);
        if samples > self.samples {
            let (what, allowed) = ("samples", self.samples);
            return Err(ImageError::TooLarge { what, requested: samples, allowed });
        }
        let bytes = samples.saturating_mul(bytes_per_sample);
        if bytes > self.bytes {
            let (what, allowed) = ("bytes", self.bytes);
            return Err(ImageError::TooLarge { what, requested: bytes, allowed });
        }
        let count = usize::try_from(bytes).unwrap_or(usize::MAX);
        match Vec::<u8>::new().try_reserve_exact(count) {
            // A sample has at least one byte, so their number fits as well.
            Ok(()) => Ok(samples as usize),
            Err(_) => Err(ImageError::NoMemory { bytes }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_beyond_64_bits_are_too_large() {
        let error = Limits::default().check(1 << 32, 1 << 32, 4, 4).unwrap_err();
        assert!(matches!(error, ImageError::TooLarge { what: "samples", .. }));
    }

    #[test]
    fn what_no_machine_can_hold_is_an_error() {
        let limits = Limits { samples: u64::MAX, bytes: u64::MAX };
        let error = limits.check(1 << 31, 1 << 31, 1, 4).unwrap_err();
        assert_eq!(error, ImageError::NoMemory { bytes: u64::MAX });
    }

    #[test]
    fn bytes_and_samples_are_limited_separately() {
        let limits = Limits { samples: 100, bytes: 100 };
        assert_eq!(limits.check(10, 10, 1, 1), Ok(100));
        let error = limits.check(10, 10, 1, 2).unwrap_err();
        assert_eq!(error, ImageError::TooLarge { what: "bytes", requested: 200, allowed: 100 });
    }
}
