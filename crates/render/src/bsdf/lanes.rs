//! Closures of several paths at once.
//!
//! The materials that nearly all surfaces have are written over any [`Real`]: [`LaneClosure`] is their
//! mathematics, which a hit alone uses as well. [`ClosureLanes`] holds the closures of up to
//! [`MAX_LANES`] hits whose materials are of one [`LaneKind`].

use super::coat::{CoatLanes, CoatTable};
use super::conductor::ConductorClosure;
use super::dielectric::DielectricClosure;
use super::diffuse::DiffuseClosure;
use super::microfacet::Distribution;
use super::plastic::PlasticClosure;
use super::roughconductor::RoughConductorClosure;
use super::roughdielectric::RoughDielectricClosure;
use super::roughplastic::RoughPlasticClosure;
use super::thindielectric::ThinDielectricClosure;
use super::{BsdfSample, Lobe, Material, Materials, Transport};
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::texture::Textures;
use etendue_math::Frame;
use etendue_math::lanes::{LaneArray, LaneMask, Lanes, MAX_LANES, Real, Simd, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::{Vec2, Vec3};

/// Directions that closures chose; see [`BsdfSample`]. Lanes that do not exist hold anything.
#[derive(Clone, Copy)]
pub struct SampleLanes<R: Real> {
    /// Where the paths go on, in the local frame.
    pub wo: Vector3<R>,
    /// f(wi, wo)·|cos θo| divided by `pdf`.
    pub weight: SpectrumLanes<R>,
    /// The density in solid angle; where the sample is not smooth, the lobe's probability.
    pub pdf: R,
    /// The index of refraction on the side of `wo` over that on the side of `wi`.
    pub eta: R,
    /// Whether there is a sample at all: where not, it counts as one of weight zero.
    pub exists: R::Mask,
    /// Whether the direction has a density in solid angle; see [`Lobe::is_smooth`].
    pub smooth: R::Mask,
    /// Whether the path goes straight on, as if no surface were there ([`Lobe::Null`]).
    pub straight: R::Mask,
}

impl<R: Real> SampleLanes<R> {
    /// No sample in any lane.
    #[inline(always)]
    #[must_use]
    pub fn none(wi: Vector3<R>) -> Self {
        let (zero, never) = (wi.z.zero(), wi.z.lt(wi.z));
        Self {
            wo: wi,
            weight: SpectrumLanes::grey(zero),
            pdf: zero,
            eta: zero + 1.0,
            exists: never,
            smooth: never,
            straight: never,
        }
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub(super) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            wo: Vector3::select(mask, yes.wo, no.wo),
            weight: SpectrumLanes::select(mask, yes.weight, no.weight),
            pdf: R::select(mask, yes.pdf, no.pdf),
            eta: R::select(mask, yes.eta, no.eta),
            exists: mask & yes.exists | !mask & no.exists,
            smooth: mask & yes.smooth | !mask & no.smooth,
            straight: mask & yes.straight | !mask & no.straight,
        }
    }

    /// As [`none`](Self::none), but smooth should it exist.
    #[inline(always)]
    pub(super) fn smooth(wi: Vector3<R>) -> Self {
        let none = Self::none(wi);
        Self { smooth: !none.smooth, ..none }
    }
}

/// The mathematics of a closure over any [`Real`]; the contract is that of [`super::Closure`].
pub(super) trait LaneClosure<R: Real> {
    /// See [`super::Closure::eval_pdf`].
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        transport: Transport,
    ) -> (SpectrumLanes<R>, R);

    /// See [`super::Closure::sample`].
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        lobe: R,
        direction: Vector2<R>,
        transport: Transport,
    ) -> SampleLanes<R>;
}

/// Passes the numbers of a closure on, one after the other.
pub(super) trait Transfer<R: Real, T: Real> {
    /// What a number becomes.
    fn number(&mut self, number: R) -> T;

    /// What a spectrum becomes.
    #[inline(always)]
    fn spectrum(&mut self, spectrum: SpectrumLanes<R>) -> SpectrumLanes<T> {
        spectrum.convert(
            #[inline(always)]
            |component| self.number(component),
        )
    }
}

/// [`LaneClosure::eval_pdf_lanes`] for one path.
#[inline(always)]
pub(super) fn eval_pdf_alone(
    closure: &impl LaneClosure<f32>,
    wi: Vec3,
    wo: Vec3,
    transport: Transport,
) -> (Spectrum, f32) {
    let (value, pdf) = closure.eval_pdf_lanes(wi.into(), wo.into(), transport);
    (value.into(), pdf)
}

/// [`LaneClosure::sample_lanes`] for one path.
#[inline(always)]
pub(super) fn sample_alone(
    closure: &impl LaneClosure<f32>,
    wi: Vec3,
    lobe: f32,
    direction: Vec2,
    transport: Transport,
) -> Option<BsdfSample> {
    let sample = closure.sample_lanes(wi.into(), lobe, direction.into(), transport);
    let lobe = match (sample.smooth, sample.straight) {
        (true, _) => Lobe::Smooth,
        (false, true) => Lobe::Null,
        (false, false) => Lobe::Delta,
    };
    sample.exists.then(|| BsdfSample {
        wo: sample.wo.into(),
        weight: sample.weight.into(),
        pdf: sample.pdf,
        eta: sample.eta,
        lobe,
    })
}

/// The kinds of closures that lanes can hold. Within a kind there are no branches on parameters.
/// Those with microfacets sample their visible normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneKind {
    /// Lambertian reflection.
    Diffuse,
    /// A smooth coating over a diffuse base.
    Plastic,
    /// A rough coating of Beckmann's normals over a diffuse base.
    RoughPlasticBeckmann,
    /// A rough coating of GGX normals over a diffuse base.
    RoughPlasticGgx,
    /// A smooth metal.
    Conductor,
    /// A rough metal of Beckmann's normals.
    RoughConductorBeckmann,
    /// A rough metal of GGX normals.
    RoughConductorGgx,
    /// Smooth glass.
    Dielectric,
    /// A thin pane of glass.
    ThinDielectric,
    /// Frosted glass of Beckmann's normals.
    RoughDielectricBeckmann,
    /// Frosted glass of GGX normals.
    RoughDielectricGgx,
}

impl LaneKind {
    /// All kinds, each at its [`index`](Self::index).
    pub const ALL: [Self; 11] = [
        Self::Diffuse,
        Self::Plastic,
        Self::RoughPlasticBeckmann,
        Self::RoughPlasticGgx,
        Self::Conductor,
        Self::RoughConductorBeckmann,
        Self::RoughConductorGgx,
        Self::Dielectric,
        Self::ThinDielectric,
        Self::RoughDielectricBeckmann,
        Self::RoughDielectricGgx,
    ];

    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// The place among all kinds.
    #[inline(always)]
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Whether any lobe is smooth, so that next-event estimation can find light.
    #[inline(always)]
    #[must_use]
    pub fn has_smooth_lobe(self) -> bool {
        !matches!(self, Self::Conductor | Self::Dielectric | Self::ThinDielectric)
    }

    /// How many numbers a closure consists of.
    #[inline(always)]
    fn columns(self) -> usize {
        match self {
            Self::Diffuse => 3,
            Self::Dielectric | Self::ThinDielectric => 7,
            Self::Conductor | Self::RoughDielectricBeckmann | Self::RoughDielectricGgx => 9,
            Self::Plastic | Self::RoughConductorBeckmann | Self::RoughConductorGgx => 11,
            Self::RoughPlasticBeckmann | Self::RoughPlasticGgx => 12,
        }
    }

    /// The kind of a material's closures; `None` where lanes cannot hold them.
    fn of(material: &Material) -> Option<Self> {
        let by_distribution = |distribution: Option<Distribution>, beckmann: Self, ggx: Self| {
            distribution.map(|distribution| match distribution {
                Distribution::Beckmann => beckmann,
                Distribution::Ggx => ggx,
            })
        };
        match material {
            Material::Diffuse(_) => Some(Self::Diffuse),
            Material::Plastic(_) => Some(Self::Plastic),
            Material::Conductor(_) => Some(Self::Conductor),
            Material::Dielectric(_) => Some(Self::Dielectric),
            Material::ThinDielectric(_) => Some(Self::ThinDielectric),
            Material::RoughPlastic(material) => by_distribution(
                material.visible_distribution(),
                Self::RoughPlasticBeckmann,
                Self::RoughPlasticGgx,
            ),
            Material::RoughConductor(material) => by_distribution(
                material.visible_distribution(),
                Self::RoughConductorBeckmann,
                Self::RoughConductorGgx,
            ),
            Material::RoughDielectric(material) => by_distribution(
                material.visible_distribution(),
                Self::RoughDielectricBeckmann,
                Self::RoughDielectricGgx,
            ),
            _ => None,
        }
    }
}

/// The most numbers that a closure consists of.
const COLUMNS: usize = 12;

/// What lanes know of a material, whatever the hit.
#[derive(Clone, Copy, Debug)]
pub struct LaneMaterial {
    kind: Option<LaneKind>,
    /// The material itself, or the one that `twosided` puts on both sides.
    leaf: MaterialId,
    is_two_sided: bool,
    /// The numbers of its closure where they are the same everywhere.
    uniform: Option<[f32; COLUMNS]>,
}

impl LaneMaterial {
    /// Looks at all materials of a scene.
    pub(crate) fn of_all(materials: &[Material]) -> Vec<Self> {
        let ids = 0..materials.len() as u32;
        ids.map(|index| Self::of(materials, MaterialId(index))).collect()
    }

    fn of(materials: &[Material], id: MaterialId) -> Self {
        let (leaf, is_two_sided) = match &materials[id.index()] {
            Material::TwoSided(sides) => (sides.both().unwrap_or(id), true),
            _ => (id, false),
        };
        let material = &materials[leaf.index()];
        let kind = LaneKind::of(material);
        let uniform = (kind.is_some() && is_uniform(material)).then(|| {
            // No texture is read, so any place will do.
            let anywhere = SurfaceInteraction::at_uv(Vec2::ZERO, Frame::from_normal(Vec3::Z));
            let mut numbers = Numbers { numbers: [0.0; COLUMNS], count: 0 };
            transfer(material, Textures(&[]), &anywhere, &mut numbers);
            numbers.numbers
        });
        Self { kind, leaf, is_two_sided, uniform }
    }
}

/// Whether a material that lanes can hold reads no textures.
fn is_uniform(material: &Material) -> bool {
    match material {
        Material::Diffuse(material) => material.is_uniform(),
        Material::Plastic(material) => material.is_uniform(),
        Material::RoughPlastic(material) => material.is_uniform(),
        Material::Conductor(material) => material.is_uniform(),
        Material::RoughConductor(material) => material.is_uniform(),
        Material::Dielectric(material) => material.is_uniform(),
        Material::ThinDielectric(material) => material.is_uniform(),
        Material::RoughDielectric(material) => material.is_uniform(),
        _ => false,
    }
}

/// Resolves a material at a hit and shows the numbers of its closure.
#[inline(always)]
fn transfer(
    material: &Material,
    textures: Textures<'_>,
    surface: &SurfaceInteraction,
    numbers: &mut impl Transfer<f32, f32>,
) {
    macro_rules! transfer {
        ($($kind:ident $(with $coat:expr)?),*) => {
            match material {
                $(Material::$kind(material) => {
                    material.resolve(textures, surface).transfer(numbers $(, $coat)?);
                })*
                _ => {}
            }
        };
    }
    transfer!(
        Diffuse,
        Plastic,
        RoughPlastic with (),
        Conductor,
        RoughConductor,
        Dielectric,
        ThinDielectric,
        RoughDielectric
    );
}

/// The numbers of a closure, one after the other.
struct Numbers {
    numbers: [f32; COLUMNS],
    count: usize,
}

impl Transfer<f32, f32> for Numbers {
    fn number(&mut self, number: f32) -> f32 {
        self.numbers[self.count] = number;
        self.count += 1;
        number
    }
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

impl Materials<'_> {
    /// The kind of closure that a material is, or has on both its sides; `None` where lanes cannot
    /// hold it.
    #[inline(always)]
    #[must_use]
    pub fn lane_kind(&self, id: MaterialId) -> Option<LaneKind> {
        self.lanes[id.index()].kind
    }

    /// Whether a material that lanes can hold is the same from both sides.
    #[inline(always)]
    #[must_use]
    pub fn is_two_sided(&self, id: MaterialId) -> bool {
        self.lanes[id.index()].is_two_sided
    }

    /// Whether a material that lanes can hold is the same everywhere: it has no textures.
    #[inline(always)]
    #[must_use]
    pub fn is_uniform(&self, id: MaterialId) -> bool {
        self.lanes[id.index()].uniform.is_some()
    }
}

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

#[cfg(test)]
mod tests;
