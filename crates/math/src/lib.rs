//! Transforms, frames, rays, boxes, intervals, polynomial roots and robust ray offsets.
//!
//! The mathematics that all other crates build on, on top of [`glam`]. Points and directions are
//! `f32` ([`glam::Vec3`]). Where single precision does not suffice (quadrics, roots), functions
//! take `f64`.
#![forbid(unsafe_code)]

mod bounds;
mod float;
mod frame;
pub mod interval;
pub mod lanes;
pub mod polynomial;
mod ray;
mod transform;

pub use bounds::Bounds3;
pub use float::{next_down, next_up, rounding_error_bound, safe_acos, safe_sqrt};
/// The vectors and matrices in this crate's signatures, re-exported so that users name the same version.
pub use glam;

pub use frame::{Frame, coordinate_system};
pub use ray::{Ray, RayLanes, offset_origin_lanes, offset_ray_origin};
pub use transform::Transform;
