//! The transmission of a rough clear coat, tabulated once for all materials with the same coat.

use super::fresnel;
use super::microfacet::{Distribution, Microfacets};
use etendue_math::lanes::{
    LaneArray, Lanes, Level, MAX_LANES, Real, Simd, TABLE_ENTRIES, Vector2, Vector3,
};
use etendue_math::with_lanes;
use glam::Vec2;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

/// Table entries over the cosine, from 0 to 1.
const ENTRIES: usize = TABLE_ENTRIES;

// As many entries are computed at once as there are lanes.
const _: () = assert!(ENTRIES.is_multiple_of(MAX_LANES));

/// Quadrature nodes over the normals along each of the two variables, from outside.
const NODES_OUTSIDE: usize = 32;

/// The same from inside, where total internal reflection adds a kink to the integrand. With these
/// counts the table is accurate to about 1e-4.
const NODES_INSIDE: usize = 64;

/// An isotropic rough interface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coat {
    /// The distribution of the normals.
    pub(crate) distribution: Distribution,
    /// The roughness.
    pub(crate) alpha: f32,
    /// The index inside over the index outside.
    pub(crate) eta: f32,
}

/// The tables of a scene. Materials with the same coat share one, so hits on several of these
/// materials can also be looked up together.
#[derive(Debug, Default)]
pub(crate) struct CoatTables(HashMap<(Distribution, [u32; 2]), Arc<CoatTable>>);

impl CoatTables {
    /// The table of a coat.
    pub(crate) fn of(&mut self, coat: Coat) -> Arc<CoatTable> {
        let key = (coat.distribution, [coat.alpha, coat.eta].map(f32::to_bits));
        Arc::clone(self.0.entry(key).or_insert_with(|| Arc::new(CoatTable::new(coat))))
    }
}

/// The transmission of a rough interface, averaged over all directions on the far side.
#[derive(Clone, Debug)]
pub(crate) struct CoatTable {
    /// The fraction that enters from outside at the cosine i / 63.
    entering: [f32; ENTRIES],
    /// The fraction of diffuse light that is reflected from inside.
    pub(crate) internal_diffuse_reflectance: f32,
}

impl CoatTable {
    /// Tabulates an interface.
    fn new(coat: Coat) -> Self {
        Self::at_level(Level::new(), coat)
    }

    /// The result does not depend on the level.
    fn at_level(level: Level, coat: Coat) -> Self {
        /// From outside and from inside. Cached, because computing them takes as long as a table.
        static POINTS: LazyLock<[Vec<(Vec2, f32)>; 2]> =
            LazyLock::new(|| [NODES_OUTSIDE, NODES_INSIDE].map(quadrature_points));
        let points = POINTS.each_ref().map(Vec::as_slice);
        with_lanes!(level, simd => Self::tabulate(simd, coat, points))
    }

    /// `points` are the quadrature points from outside and from inside.
    #[inline(always)]
    fn tabulate<S: Simd>(simd: S, coat: Coat, points: [&[(Vec2, f32)]; 2]) -> Self {
        let [outside, inside] = points;
        let (eta, inverse) = (Lanes::splat(simd, coat.eta), Lanes::splat(simd, 1.0 / coat.eta));
        let alpha = Lanes::splat(simd, coat.alpha);
        let microfacets = Microfacets::isotropic(coat.distribution, alpha);
        let entering = entries(
            simd,
            #[inline(always)]
            |cosine| Quadrature { microfacets, eta, points: outside }.transmitted(cosine),
        );
        let reflected = entries(
            simd,
            #[inline(always)]
            |cosine| Quadrature { microfacets, eta: inverse, points: inside }.reflected(cosine),
        );
        Self { entering, internal_diffuse_reflectance: mean_over_cosines(&reflected) }
    }

    /// A coat that transmits no light.
    pub(crate) const BLACK: Self =
        Self { entering: [0.0; ENTRIES], internal_diffuse_reflectance: 0.0 };
}

/// The tables of as many hits as `R` has lanes.
pub(crate) trait Coats<R: Real>: Copy {
    /// The entry at `index`, an integer from 0 to 63, of each hit's table.
    fn entries(self, index: R) -> R;

    /// The fraction of light that enters from outside at this cosine, linear between the entries.
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
        // The remainder changes nothing; it removes the bounds check.
        self.entering[index as usize % ENTRIES]
    }
}

/// One table per lane.
#[derive(Clone, Copy)]
pub(crate) struct CoatLanes<'a, S> {
    /// The SIMD instructions of the lanes.
    pub(crate) simd: S,
    /// The table of all lanes, if they share one.
    pub(crate) shared: Option<&'a CoatTable>,
    /// The tables of all lanes of a batch.
    pub(crate) tables: &'a [&'a CoatTable; MAX_LANES],
    /// The index of the first lane in `tables`.
    pub(crate) first: usize,
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

/// The cosine of an entry. At exactly grazing incidence nothing is visible.
fn cosine(index: usize) -> f32 {
    (index as f32 / (ENTRIES - 1) as f32).max(1e-6)
}

/// Evaluates a function at each entry's cosine.
#[inline(always)]
fn entries<S: Simd>(simd: S, function: impl Fn(Lanes<S>) -> Lanes<S>) -> [f32; ENTRIES] {
    let mut table = [0.0; ENTRIES];
    for (block, values) in table.chunks_exact_mut(MAX_LANES).enumerate() {
        let cosines = LaneArray(std::array::from_fn(|lane| cosine(block * MAX_LANES + lane)));
        let mut results = LaneArray::ZERO;
        for first in (0..MAX_LANES).step_by(Lanes::<S>::COUNT) {
            function(Lanes::load(simd, &cosines, first)).store(&mut results, first);
        }
        values.copy_from_slice(&results.0);
    }
    table
}

/// The fraction of diffuse light that is reflected from inside: 2 ∫ R(μ) μ dμ, summed as Mitsuba
/// does. The mean of the entries is not the trapezoidal rule, which would be about 2 % higher. It
/// is kept because all of Mitsuba's images use it.
fn mean_over_cosines(reflected: &[f32; ENTRIES]) -> f32 {
    let at = |(index, share)| cosine(index) * share;
    2.0 * reflected.iter().enumerate().map(at).sum::<f32>() / ENTRIES as f32
}

/// Integrals over the visible normals of an isotropic surface.
struct Quadrature<'a, R> {
    microfacets: Microfacets<R>,
    /// The index on the far side over that on the near side.
    eta: R,
    /// Uniform numbers and their weights, which sum to one.
    points: &'a [(Vec2, f32)],
}

impl<R: Real> Quadrature<'_, R> {
    #[inline(always)]
    fn integrate(&self, cosine: R, integrand: impl Fn(Vector3<R>, Vector3<R>) -> R) -> R {
        let sine = (-(cosine * cosine) + 1.0).safe_sqrt();
        let wi = Vector3::new(sine, cosine.zero(), cosine);
        let mut sum = cosine.zero();
        // No iterator sum: it is not always inlined, and then loses the SIMD instructions.
        for &(uniform, weight) in self.points {
            let uniform = Vector2::new(cosine.like(uniform.x), cosine.like(uniform.y));
            sum = sum + integrand(wi, self.microfacets.sample(wi, uniform)) * weight;
        }
        sum
    }

    /// The fraction of light that the second masking term passes on the way down.
    #[inline(always)]
    fn transmitted(&self, cosine: R) -> R {
        self.integrate(
            cosine,
            #[inline(always)]
            |wi, m| {
                let interface = fresnel::dielectric(wi.dot(m), self.eta);
                let wo = fresnel::refract_lanes(wi, m, &interface);
                let share = (-interface.reflectance + 1.0) * self.masking(wo);
                R::select(wo.z.ge(wo.z.zero()), wo.z.zero(), share)
            },
        )
    }

    /// The same on the way back up.
    #[inline(always)]
    fn reflected(&self, cosine: R) -> R {
        self.integrate(
            cosine,
            #[inline(always)]
            |wi, m| {
                let wo = fresnel::reflect_lanes(wi, m);
                let share = fresnel::dielectric(wi.dot(m), self.eta).reflectance * self.masking(wo);
                R::select(wo.z.le(wo.z.zero()), wo.z.zero(), share)
            },
        )
    }

    #[inline(always)]
    fn masking(&self, wo: Vector3<R>) -> R {
        self.microfacets.masking_over_cosine(wo) * wo.z.abs()
    }
}

/// The product of two Gauss–Legendre rules. The second number selects the side of the plane of
/// incidence. The integrand is symmetric about that plane, so half of its range suffices.
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
        // Four steps converge from this guess; the fifth is a safety margin.
        for _ in 0..5 {
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
    use etendue_math::lanes::baseline;

    fn table(distribution: Distribution, alpha: f32, eta: f32) -> CoatTable {
        CoatTable::new(Coat { distribution, alpha, eta })
    }

    /// The computation of the tables, with other numbers of nodes and one cosine at a time.
    fn quadrature(
        distribution: Distribution,
        eta: f32,
        points: &[(Vec2, f32)],
    ) -> Quadrature<'_, f32> {
        Quadrature { microfacets: Microfacets::isotropic(distribution, 0.3), eta, points }
    }

    fn internal_diffuse_reflectance(distribution: Distribution, nodes: usize) -> f32 {
        let points = quadrature_points(nodes);
        let inside = quadrature(distribution, 1.0 / 1.5, &points);
        mean_over_cosines(&std::array::from_fn(|index| inside.reflected(cosine(index))))
    }

    #[test]
    fn materials_with_the_same_coat_share_its_table() {
        let mut tables = CoatTables::default();
        let mut of = |distribution, eta| tables.of(Coat { distribution, alpha: 0.3, eta });
        let table = of(Distribution::Ggx, 1.5);
        let others = [of(Distribution::Ggx, 1.6), of(Distribution::Beckmann, 1.5)];
        assert!(Arc::ptr_eq(&table, &of(Distribution::Ggx, 1.5)));
        assert!(
            others
                .iter()
                .all(|other| other.internal_diffuse_reflectance
                    != table.internal_diffuse_reflectance)
        );
    }

    #[test]
    fn lanes_tabulate_what_single_numbers_do() {
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            let points = quadrature_points(NODES_OUTSIDE);
            let outside = quadrature(distribution, 1.5, &points);
            let entering = std::array::from_fn(|index| outside.transmitted(cosine(index)));
            for level in [baseline(), Level::new()] {
                let table = CoatTable::at_level(level, Coat { distribution, alpha: 0.3, eta: 1.5 });
                assert_eq!(table.entering, entering, "{distribution:?}, {level:?}");
                assert_eq!(
                    table.internal_diffuse_reflectance,
                    internal_diffuse_reflectance(distribution, NODES_INSIDE)
                );
            }
        }
    }

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
            let table = table(distribution, 1e-3, eta);
            for index in [20, 40, 63] {
                let cosine = index as f32 / 63.0;
                let expected = 1.0 - fresnel::dielectric(cosine, eta).reflectance;
                assert!((table.entering(cosine) - expected).abs() < 1e-3, "{distribution:?}");
            }
            // The mean over 64 entries approximates the integral over 63 intervals.
            let expected = fresnel::diffuse_reflectance(1.0 / eta) * 63.0 / 64.0;
            assert!(
                (table.internal_diffuse_reflectance - expected).abs() < 2e-3,
                "{}",
                table.internal_diffuse_reflectance
            );
        }
    }

    #[test]
    fn the_table_is_linear_between_its_entries_and_holds_its_ends() {
        let table = table(Distribution::Ggx, 0.3, 1.5);
        assert_eq!(table.entering(1.0), table.entering[63]);
        assert_eq!(table.entering(0.0), table.entering[0]);
        let middle = 0.5 * (table.entering[10] + table.entering[11]);
        assert!((table.entering(10.5 / 63.0) - middle).abs() < 1e-6);
        assert!(table.entering.iter().all(|share| (0.0..=1.0).contains(share)));
    }

    #[test]
    fn twice_the_nodes_change_little() {
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            for cosine in [0.02, 0.2, 0.7, 1.0] {
                let outside = [NODES_OUTSIDE, 2 * NODES_OUTSIDE].map(|nodes| {
                    quadrature(distribution, 1.5, &quadrature_points(nodes)).transmitted(cosine)
                });
                assert!((outside[0] - outside[1]).abs() < 3e-4, "{outside:?}");
            }
            let inside = [NODES_INSIDE, 2 * NODES_INSIDE]
                .map(|nodes| internal_diffuse_reflectance(distribution, nodes));
            assert!((inside[0] - inside[1]).abs() < 3e-4, "{inside:?}");
        }
    }
}
