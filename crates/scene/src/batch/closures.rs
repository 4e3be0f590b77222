//! The closures of several hits, one to a lane.

use super::materials::{COLUMNS, LaneKind, LaneMaterial, transfer};
use crate::bsdf::conductor::ConductorClosure;
use crate::bsdf::dielectric::DielectricClosure;
use crate::bsdf::diffuse::DiffuseClosure;
use crate::bsdf::plastic::PlasticClosure;
use crate::bsdf::roughconductor::RoughConductorClosure;
use crate::bsdf::roughdielectric::RoughDielectricClosure;
use crate::bsdf::roughplastic::RoughPlasticClosure;
use crate::bsdf::thindielectric::ThinDielectricClosure;
use crate::bsdf::{Material, Materials, Transport};
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{LaneClosure as _, SampleLanes, Transfer};
use crate::models::coat::{CoatLanes, CoatTable};
use crate::models::microfacet::Distribution;
use crate::texture::Textures;
use etendue_math::lanes::{LaneArray, LaneMask, Lanes, MAX_LANES, Real, Simd, Vector2, Vector3};
use etendue_spectrum::SpectrumLanes;

/// The closures of up to [`MAX_LANES`] hits, all of one kind. Directions are in the shading frames of
/// the hits; what `twosided` does is done here. Light is carried as [`Transport::Radiance`].
///
/// Lanes that were never set hold closures all of whose numbers are zero.
#[derive(Clone, Debug)]
pub struct ClosureLanes<'a> {
    kind: LaneKind,
    /// A bit for each lane whose material is the same from both sides.
    two_sided: u32,
    columns: [LaneArray; COLUMNS],
    /// What rough coats let through.
    coats: [&'a CoatTable; MAX_LANES],
    /// The coat of all lanes since the last restart, if they share one.
    shared_coat: SharedCoat<'a>,
}

/// Whether lanes share a coat.
#[derive(Clone, Copy, Debug)]
enum SharedCoat<'a> {
    /// No lane has been set.
    Unset,
    /// All have this one.
    One(&'a CoatTable),
    /// They do not.
    Many,
}

/// A closure in as many lanes as the machine has, loaded from the columns of `$lanes`.
macro_rules! with_closure {
    ($lanes:expr, $simd:expr, $first:expr, $closure:ident => $work:expr) => {{
        let (columns, coats) = (&$lanes.columns, &$lanes.coats);
        let mut numbers = FromLanes { columns, simd: $simd, first: $first, count: 0 };
        let shared = match $lanes.shared_coat {
            SharedCoat::One(coat) => Some(coat),
            SharedCoat::Unset | SharedCoat::Many => None,
        };
        let coats = CoatLanes { simd: $simd, shared, tables: coats, first: $first };
        with_closure!(@match $lanes.kind, numbers, $closure => $work,
            Diffuse: DiffuseClosure::default(), ();
            Plastic: PlasticClosure::default(), ();
            RoughPlasticBeckmann: RoughPlasticClosure::black(Distribution::Beckmann), (coats);
            RoughPlasticGgx: RoughPlasticClosure::black(Distribution::Ggx), (coats);
            Conductor: ConductorClosure::default(), ();
            RoughConductorBeckmann: RoughConductorClosure::black(Distribution::Beckmann), ();
            RoughConductorGgx: RoughConductorClosure::black(Distribution::Ggx), ();
            Dielectric: DielectricClosure::default(), ();
            ThinDielectric: ThinDielectricClosure::default(), ();
            RoughDielectricBeckmann: RoughDielectricClosure::black(Distribution::Beckmann), ();
            RoughDielectricGgx: RoughDielectricClosure::black(Distribution::Ggx), ();
        )
    }};
    (@match $kind:expr, $numbers:ident, $closure:ident => $work:expr,
        $($name:ident: $blank:expr, ($($coats:ident)?);)*) => {
        match $kind {
            $(LaneKind::$name => {
                let $closure = $blank.transfer(&mut $numbers $(, $coats)?);
                $work
            })*
        }
    };
}

impl<'a> ClosureLanes<'a> {
    /// No closures yet.
    #[must_use]
    pub fn new(kind: LaneKind) -> Self {
        let columns = [LaneArray::ZERO; COLUMNS];
        let coats = [&CoatTable::BLACK; MAX_LANES];
        Self { kind, two_sided: 0, columns, coats, shared_coat: SharedCoat::Unset }
    }

    /// Begins anew with another kind. Lanes that are not set from now on hold anything.
    #[inline(always)]
    pub fn restart(&mut self, kind: LaneKind) {
        self.kind = kind;
        self.two_sided = 0;
        self.shared_coat = SharedCoat::Unset;
    }

    /// Resolves a material of this kind at a hit into a lane.
    #[inline]
    pub fn set(
        &mut self,
        lane: usize,
        materials: Materials<'a>,
        id: MaterialId,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) {
        let leaf = self.place(lane, materials, id).leaf;
        let mut numbers = ToLane { columns: &mut self.columns, lane, count: 0 };
        transfer(&materials.materials[leaf.index()], textures, surface, &mut numbers);
    }

    /// Puts a material of this kind that [is the same everywhere](Materials::is_uniform) into a lane.
    #[inline]
    pub fn set_uniform(&mut self, lane: usize, materials: Materials<'a>, id: MaterialId) {
        let Some(numbers) = &self.place(lane, materials, id).uniform else { return };
        let columns = &mut self.columns[..self.kind.columns()];
        for (column, &number) in columns.iter_mut().zip(numbers) {
            column.0[lane] = number;
        }
    }

    /// What of a lane does not depend on textures.
    #[inline(always)]
    fn place(&mut self, lane: usize, materials: Materials<'a>, id: MaterialId) -> &'a LaneMaterial {
        let material = &materials.lanes[id.index()];
        self.two_sided |= u32::from(material.is_two_sided) << lane;
        let is_coated =
            matches!(self.kind, LaneKind::RoughPlasticBeckmann | LaneKind::RoughPlasticGgx);
        if is_coated
            && let Material::RoughPlastic(coated) = &materials.materials[material.leaf.index()]
        {
            self.coats[lane] = coated.coat();
            self.shared_coat = match self.shared_coat {
                SharedCoat::Unset => SharedCoat::One(coated.coat()),
                SharedCoat::One(coat) if std::ptr::eq(coat, coated.coat()) => self.shared_coat,
                SharedCoat::One(_) | SharedCoat::Many => SharedCoat::Many,
            };
        }
        material
    }

    /// f(wi, wo)·|cos θo| and the densities of `wo` in solid angle, in the lanes from `first` on.
    #[inline(always)]
    #[must_use]
    pub fn eval_pdf<S: Simd>(
        &self,
        simd: S,
        first: usize,
        wi: Vector3<Lanes<S>>,
        wo: Vector3<Lanes<S>>,
    ) -> (SpectrumLanes<Lanes<S>>, Lanes<S>) {
        let side = self.side(simd, first, wi);
        let (wi, wo) = (turned(wi, side), turned(wo, side));
        with_closure!(self, simd, first, closure => {
            closure.eval_pdf_lanes(wi, wo, Transport::Radiance)
        })
    }

    /// Chooses `wo` given `wi`, in the lanes from `first` on. `lobe` and `direction` are uniform in
    /// [0, 1).
    #[inline(always)]
    #[must_use]
    pub fn sample<S: Simd>(
        &self,
        simd: S,
        first: usize,
        wi: Vector3<Lanes<S>>,
        lobe: Lanes<S>,
        direction: Vector2<Lanes<S>>,
    ) -> SampleLanes<Lanes<S>> {
        let side = self.side(simd, first, wi);
        let wi = turned(wi, side);
        let sample = with_closure!(self, simd, first, closure => {
            closure.sample_lanes(wi, lobe, direction, Transport::Radiance)
        });
        SampleLanes { wo: turned(sample.wo, side), ..sample }
    }

    /// −1 in lanes that look at the back of a material that is the same from both sides, else 1.
    #[inline(always)]
    fn side<S: Simd>(&self, simd: S, first: usize, wi: Vector3<Lanes<S>>) -> Lanes<S> {
        let one = Lanes::splat(simd, 1.0);
        let is_back = LaneMask::from_bits(simd, self.two_sided >> first) & wi.z.below(0.0);
        Lanes::select(is_back, -one, one)
    }
}

/// A direction seen from the other side where `side` is −1.
#[inline(always)]
fn turned<R: Real>(v: Vector3<R>, side: R) -> Vector3<R> {
    Vector3::new(v.x, v.y, v.z * side)
}

/// The numbers of a closure on their way into a lane.
struct ToLane<'a> {
    columns: &'a mut [LaneArray; COLUMNS],
    lane: usize,
    count: usize,
}

impl Transfer<f32, f32> for ToLane<'_> {
    #[inline(always)]
    fn number(&mut self, number: f32) -> f32 {
        self.columns[self.count].0[self.lane] = number;
        self.count += 1;
        number
    }
}

/// The numbers of closures on their way out of the lanes from `first` on.
struct FromLanes<'a, S> {
    columns: &'a [LaneArray; COLUMNS],
    simd: S,
    first: usize,
    count: usize,
}

impl<S: Simd> Transfer<f32, Lanes<S>> for FromLanes<'_, S> {
    #[inline(always)]
    fn number(&mut self, _number: f32) -> Lanes<S> {
        let column = &self.columns[self.count];
        self.count += 1;
        Lanes::load(self.simd, column, self.first)
    }
}
