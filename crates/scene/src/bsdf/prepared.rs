//! From a material and a hit to a resolved [`Bsdf`].

use super::{
    BsdfSample, Closure, LaneMaterial, Lobe, Transport, blendbsdf, bumpmap, conductor, dielectric,
    diffuse, hair, mask, measured, normalmap, null, plastic, principled, principledthin,
    roughconductor, roughdielectric, roughdiffuse, roughplastic, thindielectric, twosided,
};
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::models::coat::CoatTable;
use crate::texture::Textures;
use etendue_math::Frame;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// Declares the closed family of materials: the enum of descriptions, the enum of resolved
/// closures, and the dispatch of both. Wrappers hold other materials and resolve to their closures.
macro_rules! materials {
    (
        closures { $($(#[$closure_doc:meta])* $name:ident: $material:ty => $closure:ty,)* }
        wrappers { $($(#[$wrapper_doc:meta])* $wrapper:ident: $wrapper_material:ty,)* }
    ) => {
        /// A material as the scene describes it.
        #[derive(Clone, Debug)]
        pub enum Material {
            $($(#[$closure_doc])* $name($material),)*
            $($(#[$wrapper_doc])* $wrapper($wrapper_material),)*
        }

        /// A resolved scattering function of any kind.
        #[derive(Clone, Copy, Debug)]
        enum AnyClosure<'a> {
            $($name($closure),)*
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

        impl<'a> Materials<'a> {
            /// Adds the closures of one material, placed as `placement` says, to `bsdf`.
            pub fn gather(&self, id: MaterialId, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
                match &self.materials[id.index()] {
                    $(Material::$name(material) => {
                        let closure = material.resolve(gather.textures, gather.surface);
                        bsdf.push(Leaf { closure: AnyClosure::$name(closure), placement });
                    })*
                    $(Material::$wrapper(material) => material.gather(gather, placement, bsdf),)*
                }
            }

            /// The closure of a material that is no wrapper.
            #[inline(always)]
            fn resolve(
                &self,
                id: MaterialId,
                textures: Textures<'a>,
                surface: &SurfaceInteraction,
            ) -> Option<AnyClosure<'a>> {
                match &self.materials[id.index()] {
                    $(Material::$name(material) => {
                        Some(AnyClosure::$name(material.resolve(textures, surface)))
                    })*
                    $(Material::$wrapper(_) => None,)*
                }
            }
        }
    };
}

materials! {
    closures {
        /// Lambertian reflection.
        Diffuse: diffuse::Diffuse => diffuse::DiffuseClosure,
        /// Oren–Nayar reflection.
        RoughDiffuse: roughdiffuse::RoughDiffuse => roughdiffuse::RoughDiffuseClosure,
        /// A smooth metal.
        Conductor: conductor::Conductor => conductor::ConductorClosure,
        /// A rough metal.
        RoughConductor: roughconductor::RoughConductor => roughconductor::RoughConductorClosure,
        /// Smooth glass.
        Dielectric: dielectric::Dielectric => dielectric::DielectricClosure,
        /// Frosted glass.
        RoughDielectric: roughdielectric::RoughDielectric => roughdielectric::RoughDielectricClosure,
        /// A thin pane of glass.
        ThinDielectric: thindielectric::ThinDielectric => thindielectric::ThinDielectricClosure,
        /// A smooth coating over a diffuse base.
        Plastic: plastic::Plastic => plastic::PlasticClosure,
        /// A rough coating over a diffuse base.
        RoughPlastic: roughplastic::RoughPlastic => roughplastic::RoughPlasticClosure<&'a CoatTable>,
        /// Disney's material.
        Principled: principled::Principled => principled::PrincipledClosure<'a>,
        /// Disney's material for sheets.
        PrincipledThin: principledthin::PrincipledThin => principledthin::PrincipledThinClosure<'a>,
        /// Hair and fur.
        Hair: hair::Hair => hair::HairClosure<'a>,
        /// A material measured in the laboratory.
        Measured: measured::Measured => measured::MeasuredClosure<'a>,
        /// No surface at all, or one that filters what goes straight through.
        Null: null::Null => null::NullClosure,
    }
    wrappers {
        /// Another material on either side.
        TwoSided: twosided::TwoSided,
        /// A material with an opacity.
        Mask: mask::Mask,
        /// A material on a surface perturbed by a height map.
        BumpMap: bumpmap::BumpMap,
        /// A material on a surface whose normals come from a picture.
        NormalMap: normalmap::NormalMap,
        /// A mixture of two materials.
        Blend: blendbsdf::BlendBsdf,
    }
}

impl Material {
    /// Whether the material scatters into single directions only, whatever its textures say.
    #[inline]
    #[must_use]
    pub fn is_delta(&self) -> bool {
        matches!(
            self,
            Self::Conductor(_) | Self::Dielectric(_) | Self::ThinDielectric(_) | Self::Null(_)
        )
    }
}

/// All materials of a scene, addressed by [`MaterialId`].
#[derive(Clone, Copy, Debug)]
pub struct Materials<'a> {
    /// The materials.
    pub materials: &'a [Material],
    /// What lanes know of each.
    pub lanes: &'a [LaneMaterial],
}

/// What is known while a material is resolved at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Gather<'a, 'b> {
    /// All materials, for wrappers to find what they hold.
    pub materials: Materials<'a>,
    /// All textures.
    pub textures: Textures<'a>,
    /// The hit.
    pub surface: &'b SurfaceInteraction,
}

/// How a closure stands in the shading frame of its hit, and with what weight.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Its share of the whole; the shares of all closures of a hit sum to at most one.
    pub weight: f32,
    /// The rows of the matrix that takes shading coordinates to the closure's, where a bump or
    /// normal map has turned it; applied before `flipped`. It may hold a reflection.
    turned: Option<Frame>,
    /// Whether the closure lies face down: its z axis is the negative one.
    flipped: bool,
    /// How strongly light fades out towards the horizon of the shading frame, where a bump or
    /// normal map has turned the closure: a squared roughness. Zero where it does not.
    shadowing: f32,
}

impl Placement {
    /// The closure is all there is, and its frame is the shading frame.
    pub const PLAIN: Self = Self { weight: 1.0, turned: None, flipped: false, shadowing: 0.0 };

    /// The same place with a share of the weight.
    #[must_use]
    pub fn scaled(self, share: f32) -> Self {
        Self { weight: self.weight * share, ..self }
    }

    /// The same place face down.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { flipped: !self.flipped, ..self }
    }

    /// The place turned into `frame`, given in this place's coordinates.
    #[must_use]
    pub fn turned(self, frame: Frame) -> Self {
        // Rows of the product: local axes of `frame`, taken back to shading coordinates.
        let back = |axis: Vec3| {
            let axis = if self.flipped { flip(axis) } else { axis };
            self.turned.map_or(axis, |turned| turned.to_world(axis))
        };
        let turned = Frame { s: back(frame.s), t: back(frame.t), n: back(frame.n) };
        Self { turned: Some(turned), flipped: false, ..self }
    }

    /// The place with light fading out towards the horizon, as bumps of the normal `normal`, which
    /// is in this place's coordinates before it was turned, would shadow it.
    ///
    /// Estevez et al., "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem",
    /// *Ray Tracing Gems*, 2019, chapter 12.
    #[must_use]
    pub fn shadowed(self, normal: Vec3) -> Self {
        let cos2 = normal.z * normal.z;
        let tan2 = normal.truncate().length_squared() / cos2.max(f32::MIN_POSITIVE);
        // Of a map on a map the steeper one counts; they are rare, and their product is rarer seen.
        Self { shadowing: self.shadowing.max((0.125 * tan2).min(1.0)), ..self }
    }

    /// The factor by which bumps shadow the shading direction `wo`.
    #[inline]
    fn shadow(&self, wo: Vec3) -> f32 {
        if self.shadowing == 0.0 {
            return 1.0;
        }
        let tan2 = wo.truncate().length_squared() / (wo.z * wo.z);
        2.0 / (1.0 + (1.0 + self.shadowing * tan2).sqrt())
    }

    /// The frame that bump and normal maps have turned this place into, in shading coordinates.
    /// Lying face down does not change it: a map means the same on both sides of a surface.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.turned.unwrap_or(Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z })
    }

    /// Shading to the closure's coordinates.
    #[inline]
    #[must_use]
    pub fn to_closure(&self, v: Vec3) -> Vec3 {
        let v = self.turned.map_or(v, |turned| turned.to_local(v));
        if self.flipped { flip(v) } else { v }
    }

    /// The closure's to shading coordinates.
    #[inline]
    fn to_shading(self, v: Vec3) -> Vec3 {
        let v = if self.flipped { flip(v) } else { v };
        self.turned.map_or(v, |turned| turned.to_world(v))
    }

    /// Whether a direction lies on the same side of the turned surface as of the unturned one.
    /// Where it does not, light would pass through the surface: such directions are cut off.
    #[inline]
    fn agrees(&self, shading: Vec3, closure: Vec3) -> bool {
        let Some(turned) = self.turned else { return true };
        // A reflection in the matrix, or lying face down, swaps the sides.
        let reflected = turned.s.cross(turned.t).dot(turned.n) < 0.0;
        let side = if reflected != self.flipped { -1.0 } else { 1.0 };
        shading.z * closure.z * side > 0.0
    }
}

#[inline]
fn flip(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, -v.z)
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

impl<'a> Materials<'a> {
    /// Resolves a material at a hit: every texture is read here, and nowhere else.
    #[inline]
    #[must_use]
    pub fn prepare(
        &self,
        id: MaterialId,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> Bsdf<'a> {
        // Nearly all materials are one closure, perhaps on two sides: they need not be gathered.
        let (simple, placement) = match &self.materials[id.index()] {
            Material::TwoSided(sides) => sides.side(Placement::PLAIN, surface.wi),
            _ => (id, Placement::PLAIN),
        };
        if let Some(closure) = self.resolve(simple, textures, surface) {
            return Bsdf { first: Some(Leaf { closure, placement }), others: Vec::new() };
        }
        self.prepare_wrapped(id, Gather { materials: *self, textures, surface })
    }

    fn prepare_wrapped(&self, id: MaterialId, gather: Gather<'a, '_>) -> Bsdf<'a> {
        let mut bsdf = Bsdf::black();
        self.gather(id, &gather, Placement::PLAIN, &mut bsdf);
        bsdf
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted() -> Frame {
        Frame::from_normal(Vec3::new(0.3, -0.2, 0.9).normalize())
    }

    #[test]
    fn a_placement_takes_directions_there_and_back() {
        let v = Vec3::new(0.1, 0.5, -0.7).normalize();
        let places = [
            Placement::PLAIN,
            Placement::PLAIN.flipped(),
            Placement::PLAIN.turned(tilted()).flipped(),
            Placement::PLAIN.flipped().turned(tilted()),
            Placement::PLAIN.turned(tilted()).flipped().turned(tilted()),
        ];
        for place in places {
            assert!((place.to_shading(place.to_closure(v)) - v).length() < 1e-6, "{place:?}");
        }
    }

    #[test]
    fn turning_follows_what_was_done_before() {
        let v = Vec3::new(0.1, 0.5, -0.7).normalize();
        let place = Placement::PLAIN.flipped().turned(tilted());
        assert!((place.to_closure(v) - tilted().to_local(flip(v))).length() < 1e-6);
        let place = Placement::PLAIN.turned(tilted()).flipped();
        assert!((place.to_closure(v) - flip(tilted().to_local(v))).length() < 1e-6);
    }

    #[test]
    fn sides_agree_for_steep_directions_however_the_closure_lies() {
        for place in [
            Placement::PLAIN.turned(tilted()),
            Placement::PLAIN.flipped().turned(tilted()),
            Placement::PLAIN.turned(tilted()).flipped(),
        ] {
            for v in [Vec3::Z, -Vec3::Z] {
                assert!(place.agrees(v, place.to_closure(v)), "{place:?} {v}");
            }
        }
    }

    #[test]
    fn closures_stay_small() {
        assert!(size_of::<AnyClosure<'_>>() <= 80, "{}", size_of::<AnyClosure<'_>>());
    }

    #[test]
    fn bumps_shadow_grazing_light_most() {
        let place = Placement::PLAIN.shadowed(Vec3::new(0.6, 0.0, 0.8));
        let factor = |z: f32| place.shadow(Vec3::new((1.0 - z * z).sqrt(), 0.0, z));
        assert_eq!(factor(1.0), 1.0);
        assert_eq!(factor(0.0), 0.0);
        assert!(factor(0.5) < factor(0.8));
        assert_eq!(Placement::PLAIN.shadow(Vec3::X), 1.0);
    }
}
