//! What lanes know of materials: of which kind their closures are, and their numbers.

use crate::bsdf::{Material, Materials};
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::Transfer;
use crate::models::microfacet::Distribution;
use crate::texture::Textures;
use etendue_math::Frame;
use glam::{Vec2, Vec3};

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
    pub(crate) fn columns(self) -> usize {
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
pub(crate) const COLUMNS: usize = 12;

/// What lanes know of a material, whatever the hit.
#[derive(Clone, Copy, Debug)]
pub struct LaneMaterial {
    kind: Option<LaneKind>,
    /// The material itself, or the one that `twosided` puts on both sides.
    pub(crate) leaf: MaterialId,
    pub(crate) is_two_sided: bool,
    /// The numbers of its closure where they are the same everywhere.
    pub(crate) uniform: Option<[f32; COLUMNS]>,
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
pub(crate) fn transfer(
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
