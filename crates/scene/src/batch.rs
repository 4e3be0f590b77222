//! Several hits at once, whatever their plugins: closures and lights side by side in columns.

mod closures;
mod light_batch;
mod materials;

pub use closures::ClosureBatch;
pub(crate) use light_batch::{LightBatch, Places};
pub(crate) use materials::BatchMaterial;
pub use materials::{LaneKind, Materials};
