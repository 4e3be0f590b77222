//! The closures of several hits, one per lane.

#[cfg(test)]
mod tests;

use super::materials::{BatchMaterial, COLUMNS, LaneKind, Materials, coat, transfer};
use crate::bsdf::{self, LaneMaterial, bsdf_list};
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{Columns as _, LaneClosure as _, SampleLanes, Transfer};
use crate::models::coat::{CoatLanes, CoatTable};
use crate::models::microfacet::Distribution::{Beckmann, Ggx};
use crate::scattering::Transport;
use crate::texture::Textures;
use etendue_math::lanes::{LaneArray, LaneMask, Lanes, MAX_LANES, Real, Simd, Vector2, Vector3};
use etendue_spectrum::SpectrumLanes;

/// The closures of up to [`MAX_LANES`] hits, all of one kind. Directions are in the shading frames
/// of the hits. `twosided` is applied here. The closures carry [`Transport::Radiance`].
///
/// In lanes that were never set, all numbers of the closures are zero.
#[derive(Clone, Debug)]
pub struct ClosureBatch<'a> {
    kind: LaneKind,
    /// A bit for each lane with a two-sided material.
    two_sided: u32,
    columns: [LaneArray; COLUMNS],
    /// The tables of rough coats.
    coats: [&'a CoatTable; MAX_LANES],
    /// The coat of all lanes set since the last restart, if they share one.
    shared_coat: SharedCoat<'a>,
}

/// Whether lanes share a coat.
#[derive(Clone, Copy, Debug)]
enum SharedCoat<'a> {
    /// No lane has been set.
    Unset,
    /// All lanes have this one.
    One(&'a CoatTable),
    /// The lanes have different ones.
    Many,
}

/// Generates `with_closure!` from the list of BSDFs. It evaluates `$work` with the closure of the
/// kind of `$lanes`, loaded into as many lanes as the machine has. The kinds of one BSDF share the
/// code of `$work`: with a copy for each of them, this crate's users took 16 s longer to compile and
/// rendered no faster.
macro_rules! closure_dispatch {
    (
        batched { $($module:ident => $name:ident [$($kind:ident: $variant:expr),*];)* }
        single $single:tt
        wrappers $wrappers:tt
        aliases $aliases:tt
    ) => {
        macro_rules! with_closure {
            ($lanes:expr, $simd:expr, $first:expr, $closure:ident => $work:expr) => {{
                let mut numbers = FromLanes { lanes: $lanes, simd: $simd, first: $first, count: 0 };
                match $lanes.kind {
                    $($(LaneKind::$kind)|* => {
                        let variant = variant_of($lanes.kind, [$((LaneKind::$kind, $variant)),*]);
                        let blank = <bsdf::$module::$name as LaneMaterial>::blank(variant);
                        let $closure = blank.transfer(&mut numbers);
                        $work
                    })*
                }
            }};
        }
    };
}

bsdf_list!(closure_dispatch);

/// The variant of a kind, one of `choices`.
#[inline(always)]
fn variant_of<V: Copy, const N: usize>(kind: LaneKind, choices: [(LaneKind, V); N]) -> V {
    let mut variant = choices[0].1;
    for (of_kind, of_variant) in choices {
        variant = if kind == of_kind { of_variant } else { variant };
    }
    variant
}

impl<'a> ClosureBatch<'a> {
    /// No closures yet.
    #[must_use]
    pub fn new(kind: LaneKind) -> Self {
        let columns = [LaneArray::ZERO; COLUMNS];
        let coats = [&CoatTable::BLACK; MAX_LANES];
        Self { kind, two_sided: 0, columns, coats, shared_coat: SharedCoat::Unset }
    }

    /// Starts again with another kind. Lanes not set afterwards hold arbitrary values.
    #[inline(always)]
    pub fn restart(&mut self, kind: LaneKind) {
        self.kind = kind;
        self.two_sided = 0;
        self.shared_coat = SharedCoat::Unset;
    }

    /// Resolves a material of this kind at a hit and stores it in a lane.
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

    /// Stores a material of this kind that [is uniform](Materials::is_uniform) in a lane.
    #[inline]
    pub fn set_uniform(&mut self, lane: usize, materials: Materials<'a>, id: MaterialId) {
        let Some(numbers) = &self.place(lane, materials, id).uniform else { return };
        let columns = &mut self.columns[..self.kind.columns()];
        for (column, &number) in columns.iter_mut().zip(numbers) {
            column.0[lane] = number;
        }
    }

    /// Sets the state of a lane that does not depend on textures.
    #[inline(always)]
    fn place(
        &mut self,
        lane: usize,
        materials: Materials<'a>,
        id: MaterialId,
    ) -> &'a BatchMaterial {
        let material = &materials.batch[id.index()];
        self.two_sided |= u32::from(material.is_two_sided) << lane;
        if self.kind.has_coat() {
            let coat = coat(&materials.materials[material.leaf.index()]);
            self.coats[lane] = coat;
            self.shared_coat = match self.shared_coat {
                SharedCoat::Unset => SharedCoat::One(coat),
                SharedCoat::One(shared) if std::ptr::eq(shared, coat) => self.shared_coat,
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

    /// Samples `wo` given `wi`, in the lanes from `first` on. `lobe` and `direction` are uniform in
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

    /// −1 in lanes that see the back of a two-sided material, else 1.
    #[inline(always)]
    fn side<S: Simd>(&self, simd: S, first: usize, wi: Vector3<Lanes<S>>) -> Lanes<S> {
        let one = Lanes::splat(simd, 1.0);
        let is_back = LaneMask::from_bits(simd, self.two_sided >> first) & wi.z.below(0.0);
        Lanes::select(is_back, -one, one)
    }
}

/// Mirrors a direction to the other side where `side` is −1.
#[inline(always)]
fn turned<R: Real>(v: Vector3<R>, side: R) -> Vector3<R> {
    Vector3::new(v.x, v.y, v.z * side)
}

/// Stores the numbers of a closure in a lane.
struct ToLane<'a> {
    columns: &'a mut [LaneArray; COLUMNS],
    lane: usize,
    count: usize,
}

impl Transfer<f32, f32> for ToLane<'_> {
    type Coat = ();

    #[inline(always)]
    fn coat(&self) {}

    #[inline(always)]
    fn number(&mut self, number: f32) -> f32 {
        self.columns[self.count].0[self.lane] = number;
        self.count += 1;
        number
    }
}

/// Loads the numbers of closures from the lanes from `first` on.
struct FromLanes<'a, S> {
    lanes: &'a ClosureBatch<'a>,
    simd: S,
    first: usize,
    count: usize,
}

impl<'a, S: Simd> Transfer<f32, Lanes<S>> for FromLanes<'a, S> {
    type Coat = CoatLanes<'a, S>;

    #[inline(always)]
    fn number(&mut self, _number: f32) -> Lanes<S> {
        let column = &self.lanes.columns[self.count];
        self.count += 1;
        Lanes::load(self.simd, column, self.first)
    }

    #[inline(always)]
    fn coat(&self) -> CoatLanes<'a, S> {
        let shared = match self.lanes.shared_coat {
            SharedCoat::One(coat) => Some(coat),
            SharedCoat::Unset | SharedCoat::Many => None,
        };
        CoatLanes { simd: self.simd, shared, tables: &self.lanes.coats, first: self.first }
    }
}
