//! What a rough clear coat lets through, tabulated once per material.

use super::fresnel;
use super::microfacet::{Distribution, Microfacets, NormalSampling};
use etendue_math::lanes::{Lanes, MAX_LANES, Real, Simd, TABLE_ENTRIES};
use glam::{Vec2, Vec3};
use std::f64::consts::PI;

/// Entries over the cosine, from 0 to 1.
const ENTRIES: usize = TABLE_ENTRIES;

/// Nodes of the quadrature over the normals, along each of its two variables, from outside.
const NODES_OUTSIDE: usize = 32;

/// The same from inside, where total reflection puts a kink into the integrand. With these the
/// table is right to some 1e-4; Beckmann's takes about 20 ms.
const NODES_INSIDE: usize = 64;

/// The transmission of a rough interface, averaged over all directions on the far side.
#[derive(Clone, Debug)]
pub(super) struct CoatTable {
    /// The share that enters from outside at the cosine i / 63.
    entering: [f32; ENTRIES],
    /// The share of diffuse light that is reflected from inside.
    pub(super) thrown_back: f32,
}

impl CoatTable {
    /// Tabulates an interface with the index `eta` inside over outside.
    pub(super) fn new(distribution: Distribution, alpha: f32, eta: f32) -> Self {
        let microfacets =
            Microfacets::new(distribution, NormalSampling::Visible, Vec2::splat(alpha));
        let quadrature = |nodes| Quadrature { microfacets, points: quadrature_points(nodes) };
        let outside = quadrature(NODES_OUTSIDE);
        Self {
            entering: std::array::from_fn(|index| outside.transmitted(cosine(index), eta)),
            thrown_back: quadrature(NODES_INSIDE).thrown_back(eta),
        }
    }

    /// One that lets no light through.
    pub(super) const BLACK: Self = Self { entering: [0.0; ENTRIES], thrown_back: 0.0 };
}

/// The tables of as many hits as `R` has lanes.
pub(super) trait Coats<R: Real>: Copy {
    /// The entry of each hit's table with the given index, a whole number from 0 to 63.
    fn entries(self, index: R) -> R;

    /// The share of light that enters from outside at this cosine, linear between the entries.
    #[inline(always)]
    fn entering(self, cosine: R) -> R {
        let limited = cosine.max(cosine.zero()).min(cosine.like(1.0));
        let position = limited * (ENTRIES - 1) as f32;
        let index = position.floor().min(cosine.like((ENTRIES - 2) as f32));
        let (low, high) = (self.entries(index), self.entries(index + 1.0));
        low + (high - low) * (position - index)
    }
}

impl Coats<f32> for &CoatTable {
    #[inline(always)]
    fn entries(self, index: f32) -> f32 {
        // Never beyond, and known to be so.
        self.entering[index as usize % ENTRIES]
    }
}

/// The table of each lane.
#[derive(Clone, Copy)]
pub(super) struct CoatLanes<'a, S> {
    /// The instructions of the lanes.
    pub(super) simd: S,
    /// The table of all lanes, where they share one.
    pub(super) shared: Option<&'a CoatTable>,
    /// The tables of all lanes that there may be.
    pub(super) tables: &'a [&'a CoatTable; MAX_LANES],
    /// The place of the first lane among them.
    pub(super) first: usize,
}

impl<S: Simd> Coats<Lanes<S>> for CoatLanes<'_, S> {
    #[inline(always)]
    fn entries(self, index: Lanes<S>) -> Lanes<S> {
        let Self { simd, shared, tables, first } = self;
        if let Some(table) = shared {
            return Lanes::of_table(simd, &table.entering, index);
        }
        Lanes::of_tables(
            simd,
            index,
            #[inline(always)]
            |lane| &tables[first + lane].entering,
        )
    }
}

/// The cosine of an entry. Exactly along the surface there would be nothing to see.
fn cosine(index: usize) -> f32 {
    (index as f32 / (ENTRIES - 1) as f32).max(1e-6)
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
            weight * integrand(wi, self.microfacets.sample(wi, uniform).into())
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

    /// The share of diffuse light that comes back from inside: 2 ∫ R(μ) μ dμ, as Mitsuba sums it.
    /// The mean of the entries is not the trapezoidal rule through them, which would be about 2 %
    /// higher; it is kept, as all its pictures hold it.
    fn thrown_back(&self, eta: f32) -> f32 {
        let at = |index| cosine(index) * self.reflected(cosine(index), 1.0 / eta);
        2.0 * (0..ENTRIES).map(at).sum::<f32>() / ENTRIES as f32
    }

    fn masking(&self, wo: Vec3) -> f32 {
        self.microfacets.masking_over_cosine(wo) * wo.z.abs()
    }
}

/// The product of two Gauss–Legendre rules. The second number chooses the side of the plane of
/// incidence, to which everything is symmetric: one half of its range does.
fn quadrature_points(nodes: usize) -> Vec<(Vec2, f32)> {
    let (rule, half) = (gauss_legendre(nodes), gauss_legendre(nodes / 2));
    let product = rule.iter().flat_map(|&x| half.iter().map(move |&y| (x, y)));
    product
        .map(|((x, weight_x), (y, weight_y))| {
            (Vec2::new(x as f32, 0.5 * y as f32), (weight_x * weight_y) as f32)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quadrature_integrates_polynomials() {
        let rule = gauss_legendre(5);
        for power in 0..10 {
            let integral: f64 = rule.iter().map(|&(x, weight)| weight * x.powi(power)).sum();
            assert!((integral - 1.0 / f64::from(power + 1)).abs() < 1e-14, "{power}");
        }
        let total: f32 = quadrature_points(NODES_INSIDE).iter().map(|&(_, weight)| weight).sum();
        assert!((total - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_nearly_smooth_coat_lets_through_what_fresnel_says() {
        let eta = 1.5;
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            let table = CoatTable::new(distribution, 1e-3, eta);
            for index in [20, 40, 63] {
                let cosine = index as f32 / 63.0;
                let expected = 1.0 - fresnel::dielectric(cosine, eta).reflectance;
                assert!((table.entering(cosine) - expected).abs() < 1e-3, "{distribution:?}");
            }
            // The mean over 64 entries in the place of the integral: 63 intervals.
            let expected = fresnel::diffuse_reflectance(1.0 / eta) * 63.0 / 64.0;
            assert!((table.thrown_back - expected).abs() < 2e-3, "{}", table.thrown_back);
        }
    }

    #[test]
    fn the_table_is_linear_between_its_entries_and_holds_its_ends() {
        let table = CoatTable::new(Distribution::Ggx, 0.3, 1.5);
        assert_eq!(table.entering(1.0), table.entering[63]);
        assert_eq!(table.entering(0.0), table.entering[0]);
        let middle = 0.5 * (table.entering[10] + table.entering[11]);
        assert!((table.entering(10.5 / 63.0) - middle).abs() < 1e-6);
        assert!(table.entering.iter().all(|share| (0.0..=1.0).contains(share)));
    }

    #[test]
    fn twice_the_nodes_change_little() {
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            let microfacets =
                Microfacets::new(distribution, NormalSampling::Visible, Vec2::splat(0.3));
            let quadrature = |nodes| Quadrature { microfacets, points: quadrature_points(nodes) };
            for cosine in [0.02, 0.2, 0.7, 1.0] {
                let outside = [NODES_OUTSIDE, 2 * NODES_OUTSIDE]
                    .map(|nodes| quadrature(nodes).transmitted(cosine, 1.5));
                assert!((outside[0] - outside[1]).abs() < 3e-4, "{outside:?}");
            }
            let inside =
                [NODES_INSIDE, 2 * NODES_INSIDE].map(|nodes| quadrature(nodes).thrown_back(1.5));
            assert!((inside[0] - inside[1]).abs() < 3e-4, "{inside:?}");
        }
    }
}
