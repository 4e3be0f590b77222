//! The plugins, the registry, and the frozen scene.
//!
//! A scene has two forms. The [`etendue_document::Document`] says what the user wrote. The
//! [`Scene`] is what rays intersect: immutable, flat vectors addressed by typed ids, `Send + Sync`.
//! [`build_scene`] converts the first into the second through the registry.
//!
//! Families that are used at every hit ([`shape`], [`bsdf`], [`texture`], [`emitter`]) are closed
//! enums of structs. One plugin is one file, named after its XML type. It holds the plugin's
//! parameters, mathematics, [`Manual`] page and test configurations. One line in the list beside
//! the family's folder registers it. The enum, its dispatch and the [`registry`] are generated from
//! that list, and for materials also the kinds of closures that shade several hits at once.
//!
//! From the lowest layer up: `inputs`, `lanes` and [`models`] hold what several plugins share.
//! Above them are the plugin folders, `batch` (several hits at once, whatever their plugins), the
//! [`Scene`], and its [`Builder`].
#![forbid(unsafe_code)]

mod batch;
pub mod bsdf;
mod builder;
mod cache;
pub mod emitter;
pub mod film;
mod ids;
mod inputs;
mod interaction;
mod lanes;
mod manual;
pub mod medium;
pub mod models;
pub mod phase;
mod plugin;
pub mod registry;
pub mod rfilter;
pub mod sampler;
mod scattering;
mod scene;
pub mod sensor;
pub mod shape;
#[cfg(test)]
mod testing;
pub mod texture;
pub mod volume;

pub use etendue_bvh::{Hit, Tier};

pub use batch::{ClosureBatch, LaneKind, Materials};
pub use builder::{
    Assets, BuildOptions, Builder, GatheredScene, Identity, SceneInput, build_scene, gather_scene,
};
pub use cache::AssetCache;
pub use ids::{EmitterId, GroupId, InstanceId, MaterialId, MediumId, ShapeId, TextureId};
pub use interaction::SurfaceInteraction;
pub use lanes::{SurfaceBatch, SurfaceLanes};
pub use manual::{Manual, ParameterManual};
pub use scene::{EmitterChoice, Scene, SceneStatistics, SensorSetup};
