//! A physically based path tracer: the library.
//!
//! [`render_file`] shows the whole process on one page: read a scene, render it, and return the
//! picture with its layers, metadata and [`Statistics`].
//!
//! ```
//! use etendue::{RenderOptions, SceneOptions, render_text};
//!
//! let scene = r#"
//!     <scene version="3.0.0">
//!         <integrator type="path"/>
//!         <sensor type="perspective">
//!             <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
//!             <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film>
//!         </sensor>
//!         <emitter type="constant"/>
//!         <shape type="sphere"><bsdf type="diffuse"/></shape>
//!     </scene>"#;
//! let options = RenderOptions { samples_per_pixel: Some(64), ..RenderOptions::default() };
//! let rendering = render_text(scene, &SceneOptions::default(), &options)?;
//!
//! let red = rendering.picture.channel("R").unwrap();
//! assert_eq!(red.data.len(), 16 * 16);
//! // Under a white sky, a grey sphere is as bright as it is grey.
//! assert!((red.data[8 * 16 + 8] - 0.5).abs() < 0.1);
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! [`render_node`] does the same for a scene built in code from [`document::Node`]s, whose meshes
//! and pictures may be arrays in memory: see `examples/scene_from_code.rs`.
//!
//! # In steps
//!
//! The command line runs the same steps one by one, with progress and a way to stop:
//!
//! 1. [`Workers::new`] starts the threads; everything below runs on them.
//! 2. [`load`] reads a scene file through [`Resources`] (such as [`Files`]); [`load_document`]
//!    takes a [`Document`](document::Document) built in code. [`Loaded::diagnostics`] holds every
//!    error and warning with its position. [`LoadedScene::edited`] builds the scene of a changed
//!    document and shares what has not changed.
//! 3. [`RenderJob::new`] chooses a camera and a budget.
//! 4. [`RenderJob::render`] renders, tells an [`Observer`], obeys a [`Cancel`], and returns a
//!    [`Rendering`].
//! 5. Or, to save progress: [`RenderJob::train`], [`RenderJob::new_film`] or [`SumsFile::read`],
//!    [`RenderJob::render_into`], [`SumsFile::write`] from another thread meanwhile, and
//!    [`RenderJob::develop`]. [`merge::merge`] combines parts of a picture that were rendered apart.
//! 6. [`image::encode`] makes a file's bytes of its picture.
//!
//! # Parts
//!
//! Every part is a separate crate that can be used alone. All are re-exported here: [`document`]
//! and [`mitsuba`] (scenes as text), [`scene`] (the frozen scene and its plugins), [`integrators`],
//! [`engine`], [`image`] (bitmaps, codecs, metrics), [`mesh`], [`bvh`], [`sampling`], [`spectrum`],
//! [`math`].
#![forbid(unsafe_code)]

mod development;
mod diagnostic_report;
pub mod durable;
mod edit;
mod error;
pub mod files;
mod format;
mod lenient;
mod load;
mod loaded_scene;
pub mod merge;
mod options;
mod render_job;
mod rendering;
pub mod sums_file;

pub use etendue_bvh as bvh;
pub use etendue_document as document;
pub use etendue_engine as engine;
pub use etendue_image as image;
pub use etendue_integrators as integrators;
pub use etendue_math as math;
pub use etendue_mesh as mesh;
pub use etendue_mitsuba as mitsuba;
pub use etendue_sampling as sampling;
pub use etendue_scene as scene;
pub use etendue_spectrum as spectrum;

pub use development::scene_name;
pub use diagnostic_report::DiagnosticReport;
pub use error::Error;
pub use etendue_document::{ExcerptStyle, Resources, render_diagnostic};
pub use etendue_engine::{
    Cancel, Defect, DefectiveSample, Defects, EngineError, FilmFile, FilmFileError, FilmRecord,
    FilmSums, FinishedPass, Observer, Progress, Region, SampleId, SamplesPerPixel, Silent,
    Statistics, Workers,
};
pub use files::Files;
pub use format::{FORMATS, Format};
pub use load::{LoadTimes, Loaded, load, load_document, load_node, load_text};
pub use loaded_scene::LoadedScene;
pub use options::{DEFAULT_MEMORY_LIMIT, RenderOptions, SampleChoice, SceneOptions, SensorChoice};
pub use render_job::{RenderJob, render_file, render_node, render_text};
pub use rendering::Rendering;
pub use sums_file::SumsFile;

/// Compiles the README's example as a documentation test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
