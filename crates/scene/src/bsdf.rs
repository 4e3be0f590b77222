//! Materials, and the closures they resolve to at a hit.
//!
//! A [`Material`] is what the scene file describes, with its textures. At a hit,
//! [`Materials::prepare`](crate::Materials::prepare) reads every texture once and returns a [`Bsdf`]: pure mathematics in the
//! local frame, shared by next-event estimation and path sampling.
//!
//! # Contract of every [`Closure`]
//! - `wi` and `wo` are unit vectors in the local shading frame (z is the normal). Both point away
//!   from the surface. `wi` is where the path comes from, `wo` where it continues.
//! - [`Closure::eval_pdf`] returns f(wi, wo)·|cos θo| and the density of `wo` in solid angle. Delta
//!   lobes contribute zero to both.
//! - [`Closure::sample`] returns `wo` with the weight f·|cos θo| / pdf, or `None` on failure. A
//!   failed sample counts as a sample of weight zero. One random number selects the lobe and two
//!   select the direction. For a delta lobe, `pdf` is the probability of selecting that lobe.
//! - On refraction from an index ηi to ηt, seen along `wi`→`wo`, radiance is scaled by (ηi/ηt)²;
//!   importance is not. [`Transport`] selects which of the two is carried.

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

/// The list of BSDFs. Everything that other files need to know about a BSDF is generated from it,
/// by passing the list to another macro. One line is one plugin: its XML `type`, which is also its
/// module, and the type in that module, which becomes a [`Material`].
///
/// - `batched` plugins resolve to one closure, and closures of several hits can be shaded at once.
///   Their types are [`LaneMaterial`]s. The brackets list their kinds of closures, each with its
///   variant.
/// - `single` plugins resolve to one closure, which is shaded alone. Their types are
///   [`ClosureMaterial`]s.
/// - `wrappers` hold other materials. Their types are [`WrapperMaterial`]s.
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
    /// The closure it resolves to.
    type Closure<'a>: Closure
    where
        Self: 'a;

    /// Whether it has only delta lobes, whatever its textures contain.
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

/// A material whose closures can be shaded several at once. [`ClosureBatch`](crate::ClosureBatch)
/// stores the closures of several hits side by side in columns.
pub(crate) trait LaneMaterial: ClosureMaterial {
    /// Distinguishes its kinds of closures. Within a kind no code branches on parameters.
    type Variant: Copy + PartialEq;

    /// Its scalar closure.
    type Blank: Columns<f32>;

    /// Whether its closures look up the transmission of a rough [coat](Self::coat).
    const HAS_COAT: bool = false;

    /// The variant of its closures; `None` if they must be shaded one by one.
    fn variant(&self) -> Option<Self::Variant>;

    /// An example closure of a variant, with arbitrary numbers. It defines the columns to load.
    fn blank(variant: Self::Variant) -> Self::Blank;

    /// Whether the closure is the same everywhere because no parameter has a texture.
    fn is_uniform(&self) -> bool;

    /// The transmission of its rough coat; see [`HAS_COAT`](Self::HAS_COAT).
    fn coat(&self) -> &CoatTable {
        &CoatTable::BLACK
    }
}

/// A material that holds other materials and resolves to their closures.
pub(crate) trait WrapperMaterial {
    /// Whether light passes through to the other side; `nested` answers this for a material it
    /// holds.
    fn transmits(&self, nested: &dyn Fn(MaterialId) -> bool) -> bool;

    /// Adds the closures of the materials it holds to `bsdf`.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>);
}

/// Generates from the list the enum of materials, the enum of resolved closures, the dispatch of
/// both, and the registry.
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
            /// Whether the material has only delta lobes, whatever its textures contain.
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

            /// The closure of a material that is not a wrapper.
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
            /// Adds the closure of one material to `bsdf` at `placement`.
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

/// Whether a material lets light through to the other side. Materials only hold earlier ones, so
/// the recursion ends.
pub(crate) fn transmits(materials: &[Material], id: MaterialId) -> bool {
    materials[id.index()].transmits(&|nested| transmits(materials, nested))
}

/// The context for resolving a material at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Gather<'a, 'b> {
    /// All materials, so that wrappers can look up the ones they hold.
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

/// The scattering at one hit: a weighted sum of resolved closures, usually just one.
///
/// Directions are in the shading frame of the hit; see the module's contract.
#[derive(Clone, Debug)]
pub struct Bsdf<'a> {
    /// Most materials resolve to one closure, which is stored without an allocation.
    first: Option<Leaf<'a>>,
    /// The remaining closures of blends and masks.
    others: Vec<Leaf<'a>>,
}

impl<'a> Bsdf<'a> {
    /// Scatters nothing.
    #[must_use]
    pub fn black() -> Self {
        Self { first: None, others: Vec::new() }
    }

    /// Adds the null transmission of the uncovered fraction.
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

    /// Samples `wo`. Each closure is selected with its weight as the probability; with the
    /// remaining probability none is. A smooth direction then gets the value and density of all
    /// closures together.
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

    /// The fraction of light that passes straight through as if there were no surface, and the
    /// probability that [`Self::sample`] selects this.
    #[must_use]
    pub fn null_transmission(&self, wi: Vec3) -> (Spectrum, f32) {
        self.leaves().fold((Spectrum::ZERO, 0.0), |(share, pdf), leaf| {
            let (leaf_share, leaf_pdf) =
                leaf.closure.null_transmission(leaf.placement.to_closure(wi));
            let weight = leaf.placement.weight;
            (share + leaf_share * weight, pdf + leaf_pdf * weight)
        })
    }

    /// The approximate total fraction of light that is scattered, for the albedo layer.
    #[must_use]
    pub fn albedo(&self, wi: Vec3) -> Spectrum {
        self.leaves().fold(Spectrum::ZERO, |sum, leaf| {
            let local = leaf.placement.to_closure(wi);
            sum + leaf.closure.albedo(local) * leaf.placement.weight
        })
    }

    /// The shading normal after bump and normal maps, in the shading frame. It belongs to the
    /// surface and is not turned towards the viewer.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        let turned = self.first.as_ref().and_then(|leaf| leaf.placement.turned);
        turned.map_or(Vec3::Z, |frame| frame.n)
    }
}

impl<'a> Gather<'a, '_> {
    /// Resolves a material. All its textures are read here and nowhere else.
    #[inline]
    #[must_use]
    pub(crate) fn prepare(&self, id: MaterialId) -> Bsdf<'a> {
        // Nearly all materials are one closure, possibly two-sided. They skip the general path.
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
