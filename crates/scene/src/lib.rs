//! The plugins, the registry, and the frozen scene.
//!
//! A scene has two forms here. The [`etendue_document::Document`] says what the user wrote; the
//! [`Scene`] is what rays meet: immutable, flat vectors addressed by typed ids, `Send + Sync`.
//! [`build_scene`] turns the one into the other by walking the registry.
//!
//! Families that are used at every hit ([`shape`], [`bsdf`], [`texture`], [`emitter`]) are closed
//! enums of structs. One plugin is one file, named as its XML type, with its parameters, its
//! mathematics, its [`Manual`] page and the cases that tests try. One line in the list beside the
//! family's folder makes it known: the enum, its dispatch and the [`registry`] come from that list, and
//! for materials the kinds of closures that several hits are shaded with at once.
//!
//! From below to above: `inputs`, `lanes` and [`models`] hold what several plugins share; then come the
//! plugin folders, `batch` (several hits at once, whatever their plugins), the [`Scene`], and its
//! [`Builder`].
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
