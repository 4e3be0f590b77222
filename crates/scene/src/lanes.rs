//! The computations of plugins for several paths at once: values over any
//! [`Real`](etendue_math::lanes::Real), one per lane.

mod closure;
mod light;
mod surface;

pub use closure::SampleLanes;
pub(crate) use closure::{Columns, HitClosure, LaneClosure, Transfer, columns, count};
pub use light::{LightLanes, TargetLanes};
pub(crate) use light::{SHADOW_RAY_LENGTH, shadow_segment};
pub use surface::{SurfaceBatch, SurfaceLanes};
