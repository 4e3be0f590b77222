//! What plugins compute for several paths at once: values over any
//! [`Real`](etendue_math::lanes::Real), one for each lane.

mod closure;
mod light;
mod surface;

pub use closure::SampleLanes;
pub(crate) use closure::{HitClosure, LaneClosure, Transfer};
pub(crate) use light::shadow_segment;
pub use light::{LightLanes, TargetLanes};
pub use surface::{SurfaceBatch, SurfaceLanes};
