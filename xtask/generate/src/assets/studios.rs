//! Photographers' studios as environments: soft boxes and the walls behind them.

use std::f64::consts::{PI, TAU};

use etendue::image::{EncodeOptions, ExrPrecision, FileFormat, Picture, encode};
use glam::DVec3;

use super::noise::{mix, step};

/// A rectangular light that faces the subject.
struct Softbox {
    /// Where it hangs, in degrees: from −z towards +x, and above the horizon.
    azimuth: f64,
    elevation: f64,
    /// Half of its width and height, in degrees.
    half_size: [f64; 2],
    radiance: [f64; 3],
}

impl Softbox {
    /// The light that comes from a direction: full in the middle, weaker towards the edges.
    fn light(&self, direction: DVec3) -> [f64; 3] {
        let axis = direction_to(self.azimuth.to_radians(), self.elevation.to_radians());
        let depth = direction.dot(axis);
        if depth < 0.05 {
            return [0.0; 3];
        }
        let right = DVec3::Y.cross(axis).normalize_or(DVec3::X);
        let place = [direction.dot(right), direction.dot(axis.cross(right))];
        let share: f64 = place
            .iter()
            .zip(self.half_size)
            .map(|(place, half)| (place / depth).abs() / half.to_radians().tan())
            .map(|place| (1.0 - step(0.9, 1.05, place)) * (1.0 - 0.25 * place * place))
            .product();
        self.radiance.map(|radiance| radiance * share)
    }
}

fn direction_to(azimuth: f64, elevation: f64) -> DVec3 {
    let (up, flat) = elevation.sin_cos();
    let (sin, cos) = azimuth.sin_cos();
    DVec3::new(flat * sin, up, -flat * cos)
}

/// A bright studio: a warm key light, a cool fill, and a large light overhead.
pub(super) fn bright() -> Vec<u8> {
    let boxes = [
        softbox(-60.0, 38.0, [26.0, 24.0], [17.0, 15.2, 12.8]),
        softbox(75.0, 22.0, [14.0, 34.0], [3.2, 3.6, 4.2]),
        softbox(180.0, 68.0, [34.0, 18.0], [4.6, 4.7, 4.8]),
        softbox(-165.0, 14.0, [9.0, 26.0], [2.4, 2.5, 2.7]),
    ];
    environment(&boxes, [0.17, 0.165, 0.16], [0.10, 0.09, 0.085])
}

/// A dark studio: strips of light that draw the edges of metal and glass.
pub(super) fn dark() -> Vec<u8> {
    let boxes = [
        softbox(-75.0, 30.0, [16.0, 34.0], [13.0, 12.6, 12.0]),
        softbox(80.0, 18.0, [7.0, 40.0], [7.5, 8.2, 9.2]),
        softbox(15.0, 55.0, [30.0, 9.0], [9.0, 8.6, 8.0]),
        softbox(170.0, 50.0, [40.0, 14.0], [2.6, 2.7, 2.9]),
    ];
    environment(&boxes, [0.045, 0.047, 0.052], [0.02, 0.019, 0.018])
}

const fn softbox(azimuth: f64, elevation: f64, half_size: [f64; 2], radiance: [f64; 3]) -> Softbox {
    Softbox { azimuth, elevation, half_size, radiance }
}

/// The soft boxes in a room with this ceiling and floor.
fn environment(boxes: &[Softbox], ceiling: [f64; 3], floor: [f64; 3]) -> Vec<u8> {
    let (width, height) = (320, 160);
    let color = |x: u32, y: u32| {
        let azimuth = TAU * (f64::from(x) + 0.5) / f64::from(width);
        let elevation = PI * (0.5 - (f64::from(y) + 0.5) / f64::from(height));
        let direction = direction_to(azimuth, elevation);
        let height = step(-0.5, 0.6, direction.y);
        let room: [f64; 3] =
            std::array::from_fn(|channel| mix(floor[channel], ceiling[channel], height));
        let add = |sum: [f64; 3], light: [f64; 3]| std::array::from_fn(|i| sum[i] + light[i]);
        boxes.iter().map(|light| light.light(direction)).fold(room, add).map(round)
    };
    let pixels: Vec<[f32; 3]> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| color(x, y))
        .collect();
    let mut picture = Picture::new(width, height);
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        picture.push(name, pixels.iter().map(|pixel| pixel[channel]).collect());
    }
    let options = EncodeOptions { exr_precision: ExrPrecision::Half, ..EncodeOptions::default() };
    encode(&picture, FileFormat::Exr, &options).expect("its channels are as large as it")
}

/// Rounds to steps so coarse that differences in the last bit between machines do not matter.
fn round(value: f64) -> f32 {
    ((value * 256.0).round() / 256.0) as f32
}
