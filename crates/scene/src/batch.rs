//! Several hits at once, of any plugins: closures and lights in columns.

mod closures;
mod light_batch;
mod materials;

pub use closures::ClosureBatch;
pub(crate) use light_batch::{LightBatch, Places};
pub(crate) use materials::BatchMaterial;
pub use materials::{LaneKind, Materials};
