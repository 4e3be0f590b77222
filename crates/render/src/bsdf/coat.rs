//! What a rough clear coat lets through, tabulated once per material.

use super::fresnel;
use super::microfacet::{Distribution, Microfacets, NormalSampling};
use glam::{Vec2, Vec3};
use std::f64::consts::PI;

/// Entries over the cosine, from 0 to 1.
const ENTRIES: usize = 64;

/// Nodes of the quadrature over the normals, along each of its two variables.
const NODES: usize = 32;

/// The transmission of a rough interface, averaged over all directions on the far side.
#[derive(Clone, Debug)]
pub struct CoatTable {
    /// The share that enters from outside at the cosine i / 63.
    entering: [f32; ENTRIES],
    /// The share of diffuse light that is reflected from inside.
    pub thrown_back: f32,
}

impl CoatTable {
    /// Tabulates an interface with the index `eta` inside over outside.
    #[must_use]
    pub fn new(distribution: Distribution, alpha: f32, eta: f32) -> Self {
        let microfacets =
            Microfacets::new(distribution, NormalSampling::Visible, Vec2::splat(alpha));
        let quadrature = Quadrature { microfacets, points: quadrature_points() };
        let cosine = |index: usize| (index as f32 / (ENTRIES - 1) as f32).max(1e-6);
        let entering = std::array::from_fn(|index| quadrature.transmitted(cosine(index), eta));
        let inside = |index| {
            let cosine = cosine(index);
            2.0 * cosine * quadrature.reflected(cosine, 1.0 / eta)
        };
        // Mitsuba's figure: the mean of the entries, not the trapezoidal rule through them, which
        // would be about 2 % higher. Kept, as all its pictures hold it.
        let thrown_back = (0..ENTRIES).map(inside).sum::<f32>() / ENTRIES as f32;
        Self { entering, thrown_back }
    }

    /// The share of light that enters from outside at this cosine, linear between the entries.
    #[inline]
    #[must_use]
    pub fn entering(&self, cosine: f32) -> f32 {
        let position = cosine.clamp(0.0, 1.0) * (ENTRIES - 1) as f32;
        let index = (position as usize).min(ENTRIES - 2);
        let (low, high) = (self.entering[index], self.entering[index + 1]);
        low + (high - low) * (position - index as f32)
    }
}

/// Integrals over the visible normals of an isotropic surface.
struct Quadrature {
    microfacets: Microfacets,
    /// Uniform numbers with their weights, which sum to one.
    points: Vec<(Vec2, f32)>,
}

impl Quadrature {
    fn integrate(&self, cosine: f32, integrand: impl Fn(Vec3, Vec3) -> f32) -> f32 {
        let wi = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
        let value = |&(uniform, weight): &(Vec2, f32)| {
            weight * integrand(wi, self.microfacets.sample(wi, uniform))
        };
        self.points.iter().map(value).sum()
    }

    /// The share of light that a second masking does not stop on its way down.
    fn transmitted(&self, cosine: f32, eta: f32) -> f32 {
        self.integrate(cosine, |wi, m| {
            let interface = fresnel::dielectric(wi.dot(m), eta);
            let wo = fresnel::refract(wi, m, &interface);
            if wo.z >= 0.0 {
                return 0.0;
            }
            (1.0 - interface.reflectance) * self.masking(wo)
        })
    }

    /// The same on its way back up.
    fn reflected(&self, cosine: f32, eta: f32) -> f32 {
        self.integrate(cosine, |wi, m| {
            let wo = fresnel::reflect(wi, m);
            if wo.z <= 0.0 {
                return 0.0;
            }
            fresnel::dielectric(wi.dot(m), eta).reflectance * self.masking(wo)
        })
    }

    fn masking(&self, wo: Vec3) -> f32 {
        self.microfacets.masking_over_cosine(wo) * wo.z.abs()
    }
}

/// The product of two Gauss–Legendre rules on the unit square.
fn quadrature_points() -> Vec<(Vec2, f32)> {
    let rule = gauss_legendre(NODES);
    let columns = rule.iter().flat_map(|&x| rule.iter().map(move |&y| (x, y)));
    columns
        .map(|((x, weight_x), (y, weight_y))| {
            (Vec2::new(x as f32, y as f32), (weight_x * weight_y) as f32)
        })
        .collect()
}

/// Nodes and weights of the Gauss–Legendre rule on [0, 1], by Newton's iteration on the Legendre
/// polynomial (Press et al., *Numerical Recipes*, 3rd edition, section 4.6).
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let order = count as f64;
    let node = |index: usize| {
        let mut x = (PI * (index as f64 + 0.75) / (order + 0.5)).cos();
        let mut slope = 1.0;
        // Four steps reach the last digit from this guess; the others are for safety.
        for _ in 0..8 {
            let (value, derivative) = legendre(count, x);
            slope = derivative;
            x -= value / derivative;
        }
        (0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

/// The Legendre polynomial of the given degree and its derivative, within (−1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, degree as f64 * (x * current - previous) / (x * x - 1.0))
}
