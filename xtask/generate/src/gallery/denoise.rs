//! Removes the noise of a picture whose samples were rendered in two halves.
//!
//! Non-local means with dual buffers (Rousselle et al., "Adaptive Rendering with Non-Local Means
//! Filtering", 2012): a pixel becomes the mean of those around it whose neighbourhoods look the
//! same within the noise. Each half is filtered with weights from the other one, so that weights
//! do not follow the noise that they remove. Albedo and normals guide the weights too (Rousselle et
//! al., "Robust Denoising using Feature and Color Information", 2013), and the light is filtered
//! without the albedo, which keeps textures sharp.

/// Three channels of a picture.
pub(super) type Planes = [Vec<f32>; 3];

/// What the filter looks at.
pub(super) struct Layers {
    pub(super) width: usize,
    /// The picture from either half of the samples.
    pub(super) halves: [Planes; 2],
    pub(super) albedo: Planes,
    pub(super) normal: Planes,
}

/// How far the filter looks for similar pixels, in pixels to each side.
const SEARCH_RADIUS: isize = 6;
/// Half of the neighbourhood by which pixels are compared.
const PATCH_RADIUS: usize = 2;
/// The variance of a pixel is the mean over so many pixels to each side.
const VARIANCE_RADIUS: usize = 2;
/// How many times the noise's standard deviation differences may be.
const STRENGTH: f32 = 0.6;
const ALBEDO_DEVIATION: f32 = 0.10;
const NORMAL_DEVIATION: f32 = 0.25;
/// How much brighter than its neighbours a pixel may be.
const SPIKE: f32 = 1.6;
/// Added to the albedo before light is divided by it.
const LEAST_ALBEDO: f32 = 0.05;

/// The picture without noise.
pub(super) fn denoise(layers: &Layers) -> Planes {
    let grid = Grid { width: layers.width, height: layers.albedo[0].len() / layers.width };
    let halves =
        [0, 1].map(|half| without_spikes(grid, demodulated(&layers.halves[half], &layers.albedo)));
    let brightness = [0, 1].map(|half| brightness(&halves[half]));
    let variance = variance(grid, &brightness);
    let mut sums: [Planes; 2] = [0, 1].map(|_| [0, 1, 2].map(|_| vec![0.0; grid.len()]));
    let mut weights = [0, 1].map(|_| vec![0.0_f32; grid.len()]);
    for down in -SEARCH_RADIUS..=SEARCH_RADIUS {
        for right in -SEARCH_RADIUS..=SEARCH_RADIUS {
            let shift = Shift { grid, right, down };
            let alike = feature_weights(shift, layers);
            for (guide, filtered) in [(0, 1), (1, 0)] {
                let weight = patch_weights(shift, &brightness[guide], &variance, &alike);
                add_shifted(shift, &weight, &halves[filtered], &mut sums[filtered]);
                for (sum, weight) in weights[filtered].iter_mut().zip(&weight) {
                    *sum += weight;
                }
            }
        }
    }
    std::array::from_fn(|channel| {
        let mean = |half: usize, pixel: usize| sums[half][channel][pixel] / weights[half][pixel];
        let albedo = &layers.albedo[channel];
        (0..grid.len())
            .map(|pixel| 0.5 * (mean(0, pixel) + mean(1, pixel)) * (albedo[pixel] + LEAST_ALBEDO))
            .collect()
    })
}

#[derive(Clone, Copy)]
struct Grid {
    width: usize,
    height: usize,
}

impl Grid {
    fn len(self) -> usize {
        self.width * self.height
    }

    /// The mean over a square around each pixel, within the picture.
    fn box_mean(self, plane: &[f32], radius: usize) -> Vec<f32> {
        let mut rows = vec![0.0; self.len()];
        for (row, mean) in plane.chunks(self.width).zip(rows.chunks_mut(self.width)) {
            for (x, mean) in mean.iter_mut().enumerate() {
                let near = &row[x.saturating_sub(radius)..(x + radius + 1).min(self.width)];
                *mean = near.iter().sum::<f32>() / near.len() as f32;
            }
        }
        let mut means = vec![0.0; self.len()];
        for (y, mean) in means.chunks_mut(self.width).enumerate() {
            let near = y.saturating_sub(radius)..(y + radius + 1).min(self.height);
            let share = 1.0 / near.len() as f32;
            for other in near {
                let row = &rows[other * self.width..(other + 1) * self.width];
                for (mean, value) in mean.iter_mut().zip(row) {
                    *mean += share * value;
                }
            }
        }
        means
    }
}

/// Every pixel beside the one at a distance from it.
#[derive(Clone, Copy)]
struct Shift {
    grid: Grid,
    right: isize,
    down: isize,
}

impl Shift {
    /// Calls `visit` with every pixel and its partner, where both are in the picture.
    fn pairs(self, mut visit: impl FnMut(usize, usize)) {
        let within = |size: usize, by: isize| {
            let start = by.min(0).unsigned_abs();
            start..size - by.max(0).unsigned_abs().min(size)
        };
        let offset = self.down * self.grid.width as isize + self.right;
        for y in within(self.grid.height, self.down) {
            for x in within(self.grid.width, self.right) {
                let pixel = y * self.grid.width + x;
                visit(pixel, pixel.wrapping_add_signed(offset));
            }
        }
    }
}

/// The light divided by the albedo.
fn demodulated(color: &Planes, albedo: &Planes) -> Planes {
    std::array::from_fn(|channel| {
        let pairs = color[channel].iter().zip(&albedo[channel]);
        pairs.map(|(color, albedo)| color / (albedo + LEAST_ALBEDO)).collect()
    })
}

/// Limits single pixels that are far brighter than all but two of those around them, which no number
/// of similar pixels would average away.
fn without_spikes(grid: Grid, mut light: Planes) -> Planes {
    let brightness = brightness(&light);
    for pixel in 0..grid.len() {
        let (x, y) = (pixel % grid.width, pixel / grid.width);
        let mut near = [0.0_f32; 9];
        for (index, value) in near.iter_mut().enumerate() {
            let column = (x + index % 3).saturating_sub(1).min(grid.width - 1);
            let row = (y + index / 3).saturating_sub(1).min(grid.height - 1);
            *value = brightness[row * grid.width + column];
        }
        near.sort_by(f32::total_cmp);
        // The pixel itself is one of the nine.
        let limit = SPIKE * near[5];
        if brightness[pixel] > limit {
            for plane in &mut light {
                plane[pixel] *= limit / brightness[pixel];
            }
        }
    }
    light
}

/// The mean of the channels. Differences in colour are mostly those of the albedo.
fn brightness([red, green, blue]: &Planes) -> Vec<f32> {
    let pixels = red.iter().zip(green).zip(blue);
    pixels.map(|((red, green), blue)| (red + green + blue) / 3.0).collect()
}

/// The variance of a half, from how the two differ.
fn variance(grid: Grid, [first, second]: &[Vec<f32>; 2]) -> Vec<f32> {
    let pairs = first.iter().zip(second);
    let squares: Vec<f32> = pairs.map(|(a, b)| 0.5 * (a - b) * (a - b)).collect();
    grid.box_mean(&squares, VARIANCE_RADIUS)
}

/// How alike the surfaces are; zero where the partner is outside the picture.
fn feature_weights(shift: Shift, layers: &Layers) -> Vec<f32> {
    let mut weights = vec![0.0; shift.grid.len()];
    let squared = |planes: &Planes, a: usize, b: usize| {
        planes.iter().map(|plane| (plane[a] - plane[b]) * (plane[a] - plane[b])).sum::<f32>()
    };
    let precision = |deviation: f32| 0.5 / (deviation * deviation);
    shift.pairs(|pixel, partner| {
        let albedo = squared(&layers.albedo, pixel, partner) * precision(ALBEDO_DEVIATION);
        let normal = squared(&layers.normal, pixel, partner) * precision(NORMAL_DEVIATION);
        weights[pixel] = (-albedo - normal).exp();
    });
    weights
}

/// The weight of each pixel's partner: how alike both and their neighbourhoods are.
fn patch_weights(shift: Shift, light: &[f32], variance: &[f32], alike: &[f32]) -> Vec<f32> {
    let mut distances = vec![0.0; shift.grid.len()];
    shift.pairs(|pixel, partner| {
        let (here, there) = (variance[pixel], variance[partner]);
        let difference = light[pixel] - light[partner];
        // The noise alone makes for such a difference.
        let expected = here + here.min(there);
        let scale = 1e-8 + STRENGTH * STRENGTH * (here + there);
        distances[pixel] = (difference * difference - expected) / scale;
    });
    let mut weights = shift.grid.box_mean(&distances, PATCH_RADIUS);
    for (weight, alike) in weights.iter_mut().zip(alike) {
        *weight = (-weight.max(0.0)).exp() * alike;
    }
    weights
}

fn add_shifted(shift: Shift, weight: &[f32], light: &Planes, sums: &mut Planes) {
    for (light, sum) in light.iter().zip(sums) {
        shift.pairs(|pixel, partner| sum[pixel] += weight[pixel] * light[partner]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::random;

    /// An edge between 1 and 3 under noise: the noise shrinks, and the edge stays.
    #[test]
    fn noise_goes_and_edges_stay() {
        let grid = Grid { width: 48, height: 48 };
        let truth = |pixel: usize| if pixel % grid.width < 24 { 1.0 } else { 3.0 };
        let half = |seed: u32| {
            std::array::from_fn(|channel| {
                let noise = |pixel: usize| random(pixel as u32, channel as u32, seed) as f32 - 0.5;
                (0..grid.len()).map(|pixel| truth(pixel) + noise(pixel)).collect()
            })
        };
        let flat = |value: f32| [0, 1, 2].map(|_| vec![value; grid.len()]);
        let layers = Layers {
            width: grid.width,
            halves: [half(1), half(2)],
            albedo: flat(1.0 - LEAST_ALBEDO),
            normal: flat(0.0),
        };
        let error = |planes: &Planes| {
            let squares =
                planes[0].iter().enumerate().map(|(at, value)| (value - truth(at)).powi(2));
            (squares.sum::<f32>() / grid.len() as f32).sqrt()
        };
        let (before, after) = (error(&layers.halves[0]), error(&denoise(&layers)));
        assert!(before > 0.25 && after < 0.06, "{before} {after}");
    }
}
