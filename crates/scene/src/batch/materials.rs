//! What batches know about materials: the kind of their closures, and their numbers.

use crate::bsdf::{self, Bsdf, ClosureMaterial, Gather, LaneMaterial, Material, bsdf_list};
use crate::ids::MaterialId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{Columns, Transfer};
use crate::models::coat::CoatTable;
use crate::models::microfacet::Distribution::{Beckmann, Ggx};
use crate::texture::Textures;
use etendue_math::Frame;
use glam::{Vec2, Vec3};

/// Generates [`LaneKind`], and everything that depends on the kind of a closure, from the list of
/// BSDFs.
macro_rules! lane_kinds {
    (
        batched { $($module:ident => $name:ident [$($kind:ident: $variant:expr),*];)* }
        single { $($_single_module:ident => $single:ident;)* }
        wrappers { $($_wrapper_module:ident => $wrapper:ident;)* }
        aliases $aliases:tt
    ) => {
        /// The kinds of closures that lanes can hold. Within a kind there are no branches on
        /// parameters. Those with microfacets sample visible normals.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum LaneKind {
            $($(
                #[doc = concat!("Closures of [`", stringify!($module), "`](bsdf::", stringify!($module), ").")]
                $kind,
            )*)*
        }

        impl LaneKind {
            /// The number of kinds.
            pub const COUNT: usize = [$($(Self::$kind),*),*].len();

            /// All kinds; each is at its [`index`](Self::index).
            pub const ALL: [Self; Self::COUNT] = [$($(Self::$kind),*),*];

            /// Whether any lobe is smooth, so that next-event estimation can find light.
            #[inline(always)]
            #[must_use]
            pub fn has_smooth_lobe(self) -> bool {
                match self {
                    $($(Self::$kind)|* => !<bsdf::$module::$name as ClosureMaterial>::IS_DELTA,)*
                }
            }

            /// How many numbers a closure has.
            #[inline(always)]
            pub(super) const fn columns(self) -> usize {
                match self {
                    $($(Self::$kind)|* => columns_of::<bsdf::$module::$name>(),)*
                }
            }

            /// Whether closures use the tables of a rough coat.
            #[inline(always)]
            pub(super) fn has_coat(self) -> bool {
                match self {
                    $($(Self::$kind)|* => <bsdf::$module::$name as LaneMaterial>::HAS_COAT,)*
                }
            }

            /// The kind of a material's closures; `None` if lanes cannot hold them.
            fn of(material: &Material) -> Option<Self> {
                match material {
                    $(Material::$name(material) => {
                        let variant = material.variant()?;
                        [$((Self::$kind, $variant)),*]
                            .into_iter()
                            .find_map(|(kind, of_kind)| (of_kind == variant).then_some(kind))
                    })*
                    $(Material::$single(_) => None,)*
                    $(Material::$wrapper(_) => None,)*
                }
            }
        }

        /// Whether a material that lanes can hold has no textures.
        fn is_uniform(material: &Material) -> bool {
            match material {
                $(Material::$name(material) => material.is_uniform(),)*
                $(Material::$single(_) => false,)*
                $(Material::$wrapper(_) => false,)*
            }
        }

        /// The tables of a material that lanes can hold, if it is a rough coat.
        #[inline(always)]
        pub(super) fn coat(material: &Material) -> &CoatTable {
            match material {
                $(Material::$name(material) => LaneMaterial::coat(material),)*
                $(Material::$single(_) => &CoatTable::BLACK,)*
                $(Material::$wrapper(_) => &CoatTable::BLACK,)*
            }
        }

        /// Resolves a material that lanes can hold at a hit, and passes on the numbers of its
        /// closure.
        #[inline(always)]
        pub(super) fn transfer(
            material: &Material,
            textures: Textures<'_>,
            surface: &SurfaceInteraction,
            numbers: &mut impl Transfer<f32, f32, Coat = ()>,
        ) {
            match material {
                $(Material::$name(material) => {
                    material.resolve(textures, surface).transfer(numbers);
                })*
                $(Material::$single(_) => {})*
                $(Material::$wrapper(_) => {})*
            }
        }
    };
}

bsdf_list!(lane_kinds);

impl LaneKind {
    /// The index among all kinds.
    #[inline(always)]
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}

/// How many numbers a closure of a material has.
const fn columns_of<M: LaneMaterial>() -> usize {
    <M::Blank as Columns<f32>>::COUNT
}

/// The most numbers that a closure has.
pub(super) const COLUMNS: usize = {
    let (mut most, mut index) = (0, 0);
    while index < LaneKind::COUNT {
        let columns = LaneKind::ALL[index].columns();
        most = if columns > most { columns } else { most };
        index += 1;
    }
    most
};

/// What batches know about a material, independent of the hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BatchMaterial {
    kind: Option<LaneKind>,
    /// The material, or the one inside `twosided`.
    pub(crate) leaf: MaterialId,
    pub(crate) is_two_sided: bool,
    /// The numbers of its closure, if they are the same everywhere.
    pub(crate) uniform: Option<[f32; COLUMNS]>,
}

impl BatchMaterial {
    /// Analyses all materials of a scene.
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
            // No texture is read, so any point will do.
            let anywhere = SurfaceInteraction::at_uv(Vec2::ZERO, Frame::from_normal(Vec3::Z));
            let mut numbers = Numbers { numbers: [0.0; COLUMNS], count: 0 };
            transfer(material, Textures(&[]), &anywhere, &mut numbers);
            numbers.numbers
        });
        Self { kind, leaf, is_two_sided, uniform }
    }
}

/// The numbers of a closure, one after the other.
struct Numbers {
    numbers: [f32; COLUMNS],
    count: usize,
}

impl Transfer<f32, f32> for Numbers {
    type Coat = ();

    fn coat(&self) {}

    fn number(&mut self, number: f32) -> f32 {
        self.numbers[self.count] = number;
        self.count += 1;
        number
    }
}

/// All materials of a scene, addressed by [`MaterialId`].
#[derive(Clone, Copy, Debug)]
pub struct Materials<'a> {
    /// The materials.
    pub materials: &'a [Material],
    /// What batches know about each of them.
    pub(crate) batch: &'a [BatchMaterial],
}

impl<'a> Materials<'a> {
    /// Resolves a material at a hit. Textures are read only here.
    #[inline]
    #[must_use]
    pub fn prepare(
        &self,
        id: MaterialId,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> Bsdf<'a> {
        Gather { materials: self.materials, textures, surface }.prepare(id)
    }

    /// The kind of a material's closure; for `twosided`, that of the material inside. `None` if
    /// lanes cannot hold it.
    #[inline(always)]
    #[must_use]
    pub fn lane_kind(&self, id: MaterialId) -> Option<LaneKind> {
        self.batch[id.index()].kind
    }

    /// Whether a material that lanes can hold is two-sided.
    #[inline(always)]
    #[must_use]
    pub fn is_two_sided(&self, id: MaterialId) -> bool {
        self.batch[id.index()].is_two_sided
    }

    /// Whether a material that lanes can hold is uniform, that is, has no textures.
    #[inline(always)]
    #[must_use]
    pub fn is_uniform(&self, id: MaterialId) -> bool {
        self.batch[id.index()].uniform.is_some()
    }
}
