//! Several hits at once, whatever their plugins: closures and lights side by side in columns.

mod closures;
mod light_batch;
mod lights;
mod materials;

pub use closures::ClosureLanes;
pub(crate) use lights::LaneEmitters;
pub use materials::{LaneKind, LaneMaterial};
