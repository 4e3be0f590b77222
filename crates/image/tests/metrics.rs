//! Compares FLIP with the program of its authors.

use etendue_image::metrics::{DEFAULT_PIXELS_PER_DEGREE, flip};
use etendue_image::{ColorImage, decode};

const WIDTH: u32 = 48;
const HEIGHT: u32 = 32;

/// An image from a function of column and row.
fn image(color: impl Fn(f64, f64) -> [f64; 3]) -> ColorImage {
    let pixels = (0..WIDTH * HEIGHT)
        .map(|index| color(f64::from(index % WIDTH), f64::from(index / WIDTH)).map(|v| v as f32))
        .collect();
    ColorImage { width: WIDTH, height: HEIGHT, pixels }
}

/// Waves of several directions and wavelengths.
fn waves(x: f64, y: f64) -> [f64; 3] {
    [
        0.5 + 0.5 * (0.4 * x).sin(),
        0.5 + 0.5 * (0.3 * y + 0.1 * x).sin(),
        0.5 + 0.5 * (0.05 * x * y).cos(),
    ]
}

/// The waves with a green rectangle, a bright point, less red, and a different contrast in blue.
fn modified_waves(x: f64, y: f64) -> [f64; 3] {
    let [red, green, blue] = waves(x, y);
    let color = if (8.0..24.0).contains(&x) && (8.0..16.0).contains(&y) {
        [0.1, 0.8, 0.2]
    } else if (x, y) == (30.0, 20.0) {
        [1.5; 3]
    } else {
        [red * 0.9, green, blue]
    };
    [color[0], color[1], color[2].powf(1.2)]
}

/// The golden map was made by the authors' `flip-evaluator` 1.7 ("LDR", linear input clamped to
/// [0, 1], 67.02 pixels per degree). The tolerance allows for some single-precision roundings.
#[test]
fn flip_agrees_with_the_authors_program() {
    let (reference, image) = (image(waves), image(modified_waves));
    let map = flip(&image, &reference, DEFAULT_PIXELS_PER_DEGREE).unwrap();
    let golden = decode(include_bytes!("golden/flip_67.pfm"), "flip_67.pfm").unwrap().to_raw();
    assert_eq!(map.values.len(), golden.len());
    for (index, (value, expected)) in map.values.iter().zip(&golden).enumerate() {
        assert!((value - expected).abs() < 1e-5, "pixel {index}: {value}, expected {expected}");
    }
    let mean = golden.iter().map(|&value| f64::from(value)).sum::<f64>() / golden.len() as f64;
    assert!((map.mean - mean).abs() < 1e-6, "{} {mean}", map.mean);
}

#[test]
fn flip_is_symmetric_and_zero_for_equal_images() {
    let (a, b) = (image(waves), image(modified_waves));
    let there = flip(&a, &b, 30.0).unwrap();
    assert_eq!(there, flip(&b, &a, 30.0).unwrap());
    assert!(there.values.iter().all(|value| (0.0..=1.0).contains(value)));
    assert_eq!(flip(&a, &a, 30.0).unwrap().mean, 0.0);
}

/// Black against white is the largest achromatic difference: lightness differs by 100.
#[test]
fn flip_of_uniform_images_is_their_color_difference() {
    let (black, white) = (image(|_, _| [0.0; 3]), image(|_, _| [1.0; 3]));
    let map = flip(&white, &black, DEFAULT_PIXELS_PER_DEGREE).unwrap();
    let first = map.values[0];
    assert!(map.values.iter().all(|value| (value - first).abs() < 1e-4));
    // Green against blue is the largest difference of all, and maps to 1.
    let (green, blue) = (image(|_, _| [0.0, 1.0, 0.0]), image(|_, _| [0.0, 0.0, 1.0]));
    let map = flip(&green, &blue, DEFAULT_PIXELS_PER_DEGREE).unwrap();
    assert!(map.values.iter().all(|value| (value - 1.0).abs() < 1e-4));
    assert!(first < 1.0);
}

#[test]
fn flip_rejects_invalid_resolutions() {
    let image = image(waves);
    for pixels_per_degree in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e6] {
        assert!(flip(&image, &image, pixels_per_degree).is_err());
    }
}
