//! Materials, and the closures that they become at a hit.
//!
//! A [`Material`] is what the scene file describes, with its textures. At a hit,
//! [`Materials::prepare`] reads every texture once and gives a [`Bsdf`]: pure mathematics in the
//! local frame, shared by next-event estimation and path sampling.
//!
//! # Contract of every [`Closure`]
//! - `wi` and `wo` are unit, in the local shading frame (z is the normal), and both point away from
//!   the surface. `wi` is where the path comes from, `wo` where it goes on.
//! - [`Closure::eval_pdf`] gives f(wi, wo)·|cos θo| and the density of `wo` in solid angle.
//!   Delta lobes contribute zero to both.
//! - [`Closure::sample`] gives `wo` with the weight f·|cos θo| / pdf, or `None` where it fails: a
//!   failed sample counts as one of weight zero. It uses one number to choose among lobes and two
//!   for the direction. For a delta lobe, `pdf` is the probability of having chosen that lobe.
//! - Where light is refracted from an index ηi to ηt, radiance is scaled by (ηi/ηt)², seen along
//!   `wi`→`wo`; importance is not. [`Transport`] says which of the two is carried.

pub mod blendbsdf;
pub mod bumpmap;
pub mod circular;
pub mod conductor;
pub mod dielectric;
pub mod diffuse;
pub mod hair;
pub mod mask;
pub mod measured;
pub mod normalmap;
pub mod null;
pub mod plastic;
pub mod polarizer;
pub mod principled;
pub mod principledthin;
pub mod retarder;
pub mod roughconductor;
pub mod roughdielectric;
pub mod roughdiffuse;
pub mod roughplastic;
pub mod thindielectric;
pub mod twosided;

#[cfg(test)]
mod tests;

pub use crate::lanes::SampleLanes;
pub use crate::models::placement::Placement;
pub use crate::scattering::{BsdfSample, Closure, Lobe, Transport};

use crate::builder::Builder;
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::Columns;
use crate::models::coat::CoatTable;
use crate::models::placement::flip;
use crate::plugin::{Plugin, plugin};
use crate::texture::Textures;
use etendue_document::Parameters;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The list of BSDFs: everything about them that a file other than their own has to know is made
/// from it, by calling another macro with it. One line is one plugin: its XML `type`, which is its
/// module as well, and its type in that module, which becomes a [`Material`].
///
/// - `batched` resolve to one closure, and closures of several hits can be shaded at once: their types
///   are [`LaneMaterial`]s. In brackets are their kinds of closures, each with its variant.
/// - `single` resolve to one closure, which is shaded alone: their types are [`ClosureMaterial`]s.
/// - `wrappers` hold other materials: their types are [`WrapperMaterial`]s.
/// - `aliases` build the type of another plugin.
macro_rules! bsdf_list {
    ($macro:ident) => {
        $macro! {
            batched {
                conductor => Conductor [Conductor: ()];
                dielectric => Dielectric [Dielectric: ()];
                diffuse => Diffuse [Diffuse: ()];
                plastic => Plastic [Plastic: ()];
                roughconductor => RoughConductor
                    [RoughConductorBeckmann: Beckmann, RoughConductorGgx: Ggx];
                roughdielectric => RoughDielectric
                    [RoughDielectricBeckmann: Beckmann, RoughDielectricGgx: Ggx];
                roughplastic => RoughPlastic [RoughPlasticBeckmann: Beckmann, RoughPlasticGgx: Ggx];
                thindielectric => ThinDielectric [ThinDielectric: ()];
            }
            single {
                hair => Hair;
                measured => Measured;
                null => Null;
                principled => Principled;
                principledthin => PrincipledThin;
                roughdiffuse => RoughDiffuse;
            }
            wrappers {
                blendbsdf => BlendBsdf;
                bumpmap => BumpMap;
                mask => Mask;
                normalmap => NormalMap;
                twosided => TwoSided;
            }
            aliases {
                circular => Null;
                polarizer => Null;
                retarder => Null;
            }
        }
    };
}
pub(crate) use bsdf_list;

/// A material that resolves to one closure at a hit.
pub(crate) trait ClosureMaterial {
    /// What it resolves to.
    type Closure<'a>: Closure
    where
        Self: 'a;

    /// Whether it scatters into single directions only, whatever its textures say.
    const IS_DELTA: bool = false;

    /// Whether light passes through to the other side.
    fn transmits(&self) -> bool;

    /// Reads the textures at a hit.
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> Self::Closure<'a>;
}

/// A material whose closures can be shaded several at once: closures of several hits lie side by side
/// in columns, which [`ClosureBatch`](crate::ClosureBatch) computes with.
pub(crate) trait LaneMaterial: ClosureMaterial {
    /// What tells its kinds of closures apart. Within a kind there are no branches on parameters.
    type Variant: Copy + PartialEq;

    /// Its closure over plain numbers.
    type Blank: Columns<f32>;

    /// Whether its closures look up what a rough [coat](Self::coat) lets through.
    const HAS_COAT: bool = false;

    /// The variant of its closures; `None` where they have to be shaded one by one.
    fn variant(&self) -> Option<Self::Variant>;

    /// A closure of a variant, whatever its numbers: it is the shape that columns are loaded into.
    fn blank(variant: Self::Variant) -> Self::Blank;

    /// Whether the closure is the same everywhere, as no parameter has a texture.
    fn is_uniform(&self) -> bool;

    /// What a rough coat lets through; see [`HAS_COAT`](Self::HAS_COAT).
    fn coat(&self) -> &CoatTable {
        &CoatTable::BLACK
    }
}

/// A material made of others, to whose closures it resolves.
pub(crate) trait WrapperMaterial {
    /// Whether light passes through to the other side; `nested` says so of a material that it holds.
    fn transmits(&self, nested: &dyn Fn(MaterialId) -> bool) -> bool;

    /// Adds the closures of what it holds to `bsdf`.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>);
}

/// Makes the enum of materials, the enum of resolved closures, the dispatch of both, and the
/// registry from the list.
macro_rules! materials {
    (
        batched { $($batched_module:ident => $batched:ident $kinds:tt;)* }
        single { $($single_module:ident => $single:ident;)* }
        wrappers $wrappers:tt
        aliases $aliases:tt
    ) => {
        materials! {
            closures { $($batched_module => $batched;)* $($single_module => $single;)* }
            wrappers $wrappers
            aliases $aliases
        }
    };
    (
        closures { $($module:ident => $name:ident;)* }
        wrappers { $($wrapper_module:ident => $wrapper:ident;)* }
        aliases { $($alias_module:ident => $alias:ident;)* }
    ) => {
        /// A material as the scene describes it.
        #[derive(Clone, Debug)]
        pub enum Material {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($module::$name),)*
            $(#[doc = concat!("See [`", stringify!($wrapper_module), "`].")]
            $wrapper($wrapper_module::$wrapper),)*
        }

        /// Every BSDF.
        pub static BSDFS: &[Plugin<BuildMaterial>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |builder, parameters| {
                $module::build(builder, parameters).map(Material::$name)
            }),)*
            $(plugin(stringify!($wrapper_module), &$wrapper_module::MANUAL, |builder, parameters| {
                $wrapper_module::build(builder, parameters).map(Material::$wrapper)
            }),)*
            $(plugin(stringify!($alias_module), &$alias_module::MANUAL, |builder, parameters| {
                $alias_module::build(builder, parameters).map(Material::$alias)
            }),)*
        ];

        impl Material {
            /// Whether the material scatters into single directions only, whatever its textures say.
            #[inline]
            #[must_use]
            pub fn is_delta(&self) -> bool {
                match self {
                    $(Self::$name(_) => <$module::$name as ClosureMaterial>::IS_DELTA,)*
                    $(Self::$wrapper(_) => false,)*
                }
            }

            /// Whether light passes through to the other side.
            fn transmits(&self, nested: &dyn Fn(MaterialId) -> bool) -> bool {
                match self {
                    $(Self::$name(material) => material.transmits(),)*
                    $(Self::$wrapper(material) => material.transmits(nested),)*
                }
            }

            /// The closure of a material that is no wrapper.
            #[inline(always)]
            fn resolve<'a>(
                &'a self,
                textures: Textures<'a>,
                surface: &SurfaceInteraction,
            ) -> Option<AnyClosure<'a>> {
                match self {
                    $(Self::$name(material) => {
                        Some(AnyClosure::$name(material.resolve(textures, surface)))
                    })*
                    $(Self::$wrapper(_) => None,)*
                }
            }
        }

        /// A resolved scattering function of any kind.
        #[derive(Clone, Copy, Debug)]
        enum AnyClosure<'a> {
            $($name(<$module::$name as ClosureMaterial>::Closure<'a>),)*
        }

        impl Closure for AnyClosure<'_> {
            #[inline]
            fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
                match self { $(Self::$name(closure) => closure.eval_pdf(wi, wo, transport),)* }
            }

            #[inline]
            fn sample(
                &self,
                wi: Vec3,
                lobe: f32,
                direction: Vec2,
                transport: Transport,
            ) -> Option<BsdfSample> {
                match self { $(Self::$name(closure) => closure.sample(wi, lobe, direction, transport),)* }
            }

            fn null_transmission(&self, wi: Vec3) -> (Spectrum, f32) {
                match self { $(Self::$name(closure) => closure.null_transmission(wi),)* }
            }

            #[inline]
            fn has_smooth_lobe(&self) -> bool {
                match self { $(Self::$name(closure) => closure.has_smooth_lobe(),)* }
            }

            fn albedo(&self, wi: Vec3) -> Spectrum {
                match self { $(Self::$name(closure) => closure.albedo(wi),)* }
            }
        }

        impl<'a> Gather<'a, '_> {
            /// Adds the closures of one material, placed as `placement` says, to `bsdf`.
            pub fn add(&self, id: MaterialId, placement: Placement, bsdf: &mut Bsdf<'a>) {
                match &self.materials[id.index()] {
                    $(Material::$name(material) => {
                        let closure = material.resolve(self.textures, self.surface);
                        bsdf.push(Leaf { closure: AnyClosure::$name(closure), placement });
                    })*
                    $(Material::$wrapper(material) => material.gather(self, placement, bsdf),)*
                }
            }
        }
    };
}

bsdf_list!(materials);

/// Builds a material.
pub type BuildMaterial = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Material>;

/// Whether a material lets light through to the other side. Materials hold only earlier ones, so the
/// recursion ends.
pub(crate) fn transmits(materials: &[Material], id: MaterialId) -> bool {
    materials[id.index()].transmits(&|nested| transmits(materials, nested))
}

/// What is known while a material is resolved at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Gather<'a, 'b> {
    /// All materials, for wrappers to find what they hold.
    pub materials: &'a [Material],
    /// All textures.
    pub textures: Textures<'a>,
    /// The hit.
    pub surface: &'b SurfaceInteraction,
}

#[derive(Clone, Copy, Debug)]
struct Leaf<'a> {
    closure: AnyClosure<'a>,
    placement: Placement,
}

impl Leaf<'_> {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        if self.placement.turned.is_some() {
            return self.eval_pdf_turned(wi, wo, transport);
        }
        let (wi, wo) = if self.placement.flipped { (flip(wi), flip(wo)) } else { (wi, wo) };
        self.closure.eval_pdf(wi, wo, transport)
    }

    #[inline(never)]
    fn eval_pdf_turned(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        let (local_wi, local_wo) = (self.placement.to_closure(wi), self.placement.to_closure(wo));
        if !self.placement.agrees(wo, local_wo) {
            return (Spectrum::ZERO, 0.0);
        }
        let (value, pdf) = self.closure.eval_pdf(local_wi, local_wo, transport);
        (value * self.placement.shadow(wo), pdf)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        if self.placement.turned.is_some() {
            return self.sample_turned(wi, lobe, direction, transport);
        }
        if !self.placement.flipped {
            return self.closure.sample(wi, lobe, direction, transport);
        }
        let mut sample = self.closure.sample(flip(wi), lobe, direction, transport)?;
        sample.wo.z = -sample.wo.z;
        Some(sample)
    }

    #[inline(never)]
    fn sample_turned(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let sample =
            self.closure.sample(self.placement.to_closure(wi), lobe, direction, transport)?;
        let wo = self.placement.to_shading(sample.wo);
        if sample.lobe == Lobe::Null {
            return Some(BsdfSample { wo, ..sample });
        }
        let weight = sample.weight * self.placement.shadow(wo);
        self.placement.agrees(wo, sample.wo).then_some(BsdfSample { wo, weight, ..sample })
    }
}

/// The scattering at one hit: a weighted sum of resolved closures, nearly always a single one.
///
/// Directions are in the shading frame of the hit; see the module's contract.
#[derive(Clone, Debug)]
pub struct Bsdf<'a> {
    /// Most materials resolve to one closure, which needs no memory of its own.
    first: Option<Leaf<'a>>,
    /// The others, of blends and masks.
    others: Vec<Leaf<'a>>,
}

impl<'a> Bsdf<'a> {
    /// Scatters nothing.
    #[must_use]
    pub fn black() -> Self {
        Self { first: None, others: Vec::new() }
    }

    /// Adds the straight-through lobe of what is not covered.
    pub fn push_null(&mut self, placement: Placement) {
        self.push(Leaf { closure: AnyClosure::Null(null::NullClosure::CLEAR), placement });
    }

    fn push(&mut self, leaf: Leaf<'a>) {
        if leaf.placement.weight <= 0.0 {
            return;
        }
        if self.first.is_none() {
            self.first = Some(leaf);
        } else {
            self.others.push(leaf);
        }
    }

    #[inline]
    fn leaves(&self) -> impl Iterator<Item = &Leaf<'a>> {
        self.first.iter().chain(&self.others)
    }

    /// Whether any lobe is smooth, so that next-event estimation can find light.
    #[inline]
    #[must_use]
    pub fn has_smooth_lobe(&self) -> bool {
        self.leaves().any(|leaf| leaf.closure.has_smooth_lobe())
    }

    /// f(wi, wo)·|cos θo| and the density of `wo` in solid angle.
    #[inline]
    #[must_use]
    pub fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        let Some(first) = &self.first else { return (Spectrum::ZERO, 0.0) };
        let (value, pdf) = first.eval_pdf(wi, wo, transport);
        let weight = first.placement.weight;
        self.others.iter().fold((value * weight, pdf * weight), |(value, pdf), leaf| {
            let (leaf_value, leaf_pdf) = leaf.eval_pdf(wi, wo, transport);
            let weight = leaf.placement.weight;
            (value + leaf_value * weight, pdf + leaf_pdf * weight)
        })
    }

    /// Chooses `wo`. A closure is chosen with its weight as the probability, and none with what is
    /// left; a smooth direction then gets the value and density of all closures together.
    #[inline]
    #[must_use]
    pub fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let first = self.first.as_ref()?;
        if first.placement.weight == 1.0 {
            return first.sample(wi, lobe, direction, transport);
        }
        self.sample_mixture(wi, lobe, direction, transport)
    }

    fn sample_mixture(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let mut remaining = lobe;
        let chosen = self.leaves().find(|leaf| {
            let here = remaining < leaf.placement.weight;
            if !here {
                remaining -= leaf.placement.weight;
            }
            here
        })?;
        let probability = chosen.placement.weight;
        let reused = (remaining / probability).min(1.0 - f32::EPSILON);
        let sample = chosen.sample(wi, reused, direction, transport)?;
        if !sample.lobe.is_smooth() {
            return Some(BsdfSample { pdf: sample.pdf * probability, ..sample });
        }
        let (value, pdf) = self.eval_pdf(wi, sample.wo, transport);
        (pdf > 0.0).then(|| BsdfSample { weight: value / pdf, pdf, ..sample })
    }

    /// The share of light that goes straight on, as if no surface were there, and the probability
    /// with which [`Self::sample`] lets it.
    #[must_use]
    pub fn null_transmission(&self, wi: Vec3) -> (Spectrum, f32) {
        self.leaves().fold((Spectrum::ZERO, 0.0), |(share, pdf), leaf| {
            let (leaf_share, leaf_pdf) =
                leaf.closure.null_transmission(leaf.placement.to_closure(wi));
            let weight = leaf.placement.weight;
            (share + leaf_share * weight, pdf + leaf_pdf * weight)
        })
    }

    /// The share of light that is scattered in all, roughly: for the albedo layer.
    #[must_use]
    pub fn albedo(&self, wi: Vec3) -> Spectrum {
        self.leaves().fold(Spectrum::ZERO, |sum, leaf| {
            let local = leaf.placement.to_closure(wi);
            sum + leaf.closure.albedo(local) * leaf.placement.weight
        })
    }

    /// The shading normal after bump and normal maps, in the shading frame: that of the surface, not
    /// turned towards the viewer.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        let turned = self.first.as_ref().and_then(|leaf| leaf.placement.turned);
        turned.map_or(Vec3::Z, |frame| frame.n)
    }
}

impl<'a> Gather<'a, '_> {
    /// Resolves a material: every texture is read here, and nowhere else.
    #[inline]
    #[must_use]
    pub(crate) fn prepare(&self, id: MaterialId) -> Bsdf<'a> {
        // Nearly all materials are one closure, perhaps on two sides: they need not be gathered.
        let (simple, placement) = match &self.materials[id.index()] {
            Material::TwoSided(sides) => sides.side(Placement::PLAIN, self.surface.wi),
            _ => (id, Placement::PLAIN),
        };
        let closure = self.materials[simple.index()].resolve(self.textures, self.surface);
        if let Some(closure) = closure {
            return Bsdf { first: Some(Leaf { closure, placement }), others: Vec::new() };
        }
        self.prepare_wrapped(id)
    }

    fn prepare_wrapped(&self, id: MaterialId) -> Bsdf<'a> {
        let mut bsdf = Bsdf::black();
        self.add(id, Placement::PLAIN, &mut bsdf);
        bsdf
    }
}
