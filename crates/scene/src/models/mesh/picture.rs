//! Points on a textured light, sampled in proportion to the texture.

use super::{MappedParallelogram, Mesh};
use crate::interaction::ShapeSample;
use etendue_sampling::{AliasTable, Distribution2D, warp};
use glam::{Affine2, Mat2, Vec2};

/// The texture of an emissive mesh.
#[derive(Clone, Copy)]
pub struct Glow<'a> {
    /// The luminance at texture coordinates.
    pub luminance: &'a dyn Fn(Vec2) -> f32,
    /// Columns and rows of the texture over the unit square of texture coordinates.
    pub resolution: [u32; 2],
}

/// The minimum density at any point, as a fraction of the mean density. It ensures that texture
/// details between the lookups can still be sampled.
const FLOOR: f32 = 0.05;
/// The maximum number of cells along one side of a parallelogram. A million cells take a few
/// megabytes.
const MAX_CELLS: f32 = 1024.0;
/// The maximum number of lookups in one triangle: 16² / 2.
const MAX_STEPS: f32 = 16.0;

/// A textured parallelogram, with points in proportion to the texture.
#[derive(Clone, Debug)]
pub(super) struct Slide {
    sheet: MappedParallelogram,
    distribution: Distribution2D,
    /// Maps texture coordinates to positions in the parallelogram.
    to_place: Affine2,
}

impl Slide {
    /// `None` if the texture coordinates do not determine the position, or the texture is black.
    pub(super) fn new(sheet: MappedParallelogram, glow: Glow<'_>) -> Option<Self> {
        let [across, down] = sheet.uv.edges;
        let to_uv = Affine2::from_mat2_translation(Mat2::from_cols(across, down), sheet.uv.corner);
        let to_place = to_uv.inverse();
        if !to_place.is_finite() {
            return None;
        }
        let texels = Vec2::new(glow.resolution[0] as f32, glow.resolution[1] as f32);
        let cells = |edge: Vec2| (edge.abs() * texels).max_element().clamp(1.0, MAX_CELLS) as u32;
        let size = (cells(across), cells(down));
        let weights = cell_weights(size, |place| (glow.luminance)(to_uv.transform_point2(place)));
        let distribution = Distribution2D::new(&weights, size).ok()?;
        Some(Self { sheet, distribution, to_place })
    }

    pub(super) fn sample(&self, random: Vec2) -> ShapeSample {
        let (place, density) = self.distribution.sample(random);
        let sample = self.sheet.sample(place);
        ShapeSample { pdf: sample.pdf * density, ..sample }
    }

    /// The density per area at texture coordinates.
    pub(super) fn pdf(&self, uv: Vec2) -> f32 {
        // Rounding may move a point at the edge out of the unit square.
        let place = self.to_place.transform_point2(uv).clamp(Vec2::ZERO, Vec2::ONE);
        self.sheet.shape.pdf * self.distribution.pdf(place.min(Vec2::splat(1.0 - f32::EPSILON)))
    }
}

/// The weight of every cell of the unit square: the mean of its corners and its centre, plus the
/// minimum density.
fn cell_weights((columns, rows): (u32, u32), value: impl Fn(Vec2) -> f32) -> Vec<f32> {
    let cell = Vec2::new(1.0 / columns as f32, 1.0 / rows as f32);
    let corners: Vec<f32> = (0..=rows)
        .flat_map(|row| (0..=columns).map(move |column| Vec2::new(column as f32, row as f32)))
        .map(|place| value(place * cell))
        .collect();
    let stride = columns as usize + 1;
    let mut weights = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows as usize {
        for column in 0..columns as usize {
            let first = row * stride + column;
            let around = [first, first + 1, first + stride, first + stride + 1];
            let around: f32 = around.iter().map(|corner| corners[*corner]).sum();
            let centre = value(Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * cell);
            weights.push(0.125 * around + 0.5 * centre);
        }
    }
    raise(&mut weights);
    weights
}

/// Adds the minimum density.
fn raise(weights: &mut [f32]) {
    let mean = weights.iter().map(|weight| f64::from(*weight)).sum::<f64>() / weights.len() as f64;
    weights.iter_mut().for_each(|weight| *weight += FLOOR * mean as f32);
}

/// Textured triangles. A triangle is selected by its emitted light, then a point in it.
#[derive(Clone, Debug)]
pub(super) struct Mosaic {
    table: AliasTable,
    /// The density per area on each triangle.
    densities: Vec<f32>,
}

impl Mosaic {
    /// `None` if the mesh has no texture coordinates or emits no light.
    pub(super) fn new(mesh: &Mesh, glow: Glow<'_>) -> Option<Self> {
        if mesh.uvs.is_empty() {
            return None;
        }
        let areas: Vec<f32> = mesh.triangle_areas().collect();
        let mut means: Vec<f32> =
            mesh.indices.iter().map(|triangle| mean_of_triangle(mesh, triangle, glow)).collect();
        raise(&mut means);
        let weights: Vec<f32> = areas.iter().zip(&means).map(|(area, mean)| area * mean).collect();
        let table = AliasTable::new(&weights).ok()?;
        let density = |(index, area): (usize, &f32)| table.pmf(index) / area.max(f32::MIN_POSITIVE);
        let densities = areas.iter().enumerate().map(density).collect();
        Some(Self { table, densities })
    }

    pub(super) fn sample(&self, mesh: &Mesh, random: Vec2) -> ShapeSample {
        let (triangle, rest) = super::choose_triangle(&self.table, random);
        let sample = mesh.light_point(triangle, warp::uniform_triangle::sample(rest));
        ShapeSample { pdf: self.densities[triangle], ..sample }
    }

    /// The density per area on a triangle.
    pub(super) fn pdf(&self, triangle: u32) -> f32 {
        self.densities.get(triangle as usize).copied().unwrap_or(0.0)
    }
}

/// The mean luminance over a triangle, with about one lookup per texel.
fn mean_of_triangle(mesh: &Mesh, triangle: &[u32; 3], glow: Glow<'_>) -> f32 {
    let [a, b, c] = triangle.map(|vertex| mesh.uvs[vertex as usize]);
    let texels = Vec2::new(glow.resolution[0] as f32, glow.resolution[1] as f32);
    let reach = ((b - a).abs().max((c - a).abs()) * texels).max_element();
    let steps = reach.clamp(2.0, MAX_STEPS) as u32;
    let (mut sum, mut count) = (0.0, 0);
    for i in 0..steps {
        for j in 0..steps - i {
            let place = Vec2::new(i as f32 + 1.0 / 3.0, j as f32 + 1.0 / 3.0) / steps as f32;
            sum += (glow.luminance)(a + (b - a) * place.x + (c - a) * place.y);
            count += 1;
        }
    }
    sum / count as f32
}
