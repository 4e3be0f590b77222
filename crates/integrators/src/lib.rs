//! Light transport algorithms, each an [`Integrator`].
//!
//! An integrator handles one camera ray at a time, or many at once. Besides light it may fill
//! additional channels ([`Integrator::channels`]), trace particles from the emitters
//! ([`ParticleIntegrator`]), and train before it renders ([`Training`]). Each of these traits
//! states its contract. A [`Watch`] bounds the work.
#![forbid(unsafe_code)]

mod aov;
mod depth;
mod direct;
mod estimator;
mod integrator;
mod media;
mod moment;
mod nested;
mod options;
mod parameters;
mod particles;
mod path;
mod ptracer;
mod registry;
mod volpath;
mod volpathmis;
mod watch;

pub use aov::Aov;
pub use depth::Depth;
pub use direct::Direct;
pub use integrator::{CameraRay, ChannelKind, Integrator, Radiance, Start, Training};
pub use moment::Moment;
pub use nested::Nested;
pub use options::IntegratorOptions;
pub use particles::{ParticleIntegrator, Splat, SplatSink, SplatTarget};
pub use path::Path;
pub use ptracer::ParticleTracer;
pub use registry::{INTEGRATORS, build_integrator, plugins};
pub use volpath::VolumePath;
pub use watch::{MAX_COLLISIONS, MAX_EDGES, Watch};
