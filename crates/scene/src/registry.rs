//! Every plugin. Each family has one list beside its folder, and its table is generated from that
//! list. Building, the manual and the tests iterate over the tables; nothing is listed twice.

pub use crate::bsdf::BSDFS;
pub use crate::emitter::{EMITTERS, SHAPE_EMITTERS};
pub use crate::film::FILMS;
pub use crate::medium::MEDIA;
pub use crate::phase::PHASES;
pub use crate::plugin::{Plugin, find, instead, report_unknown};
pub use crate::sensor::{SENSORS, SHAPE_SENSORS};
pub use crate::shape::{COMPOSITE_SHAPES, SHAPES};
pub use crate::texture::TEXTURES;
pub use crate::volume::VOLUMES;

use crate::manual::Manual;
use crate::rfilter;
use crate::sampler;
use etendue_document::Class;

/// Every plugin of this crate: class, name and manual page. Plugins of one table are sorted by
/// name.
pub fn plugins() -> Vec<(Class, &'static str, &'static Manual)> {
    fn pages<F>(
        class: Class,
        table: &'static [Plugin<F>],
    ) -> Vec<(Class, &'static str, &'static Manual)> {
        let mut pages: Vec<_> =
            table.iter().map(|plugin| (class, plugin.name, plugin.manual)).collect();
        pages.sort_unstable_by_key(|(_, name, _)| *name);
        pages
    }
    let mut all = pages(Class::Shape, SHAPES);
    all.extend(pages(Class::Shape, COMPOSITE_SHAPES));
    all.extend(pages(Class::Bsdf, BSDFS));
    all.extend(pages(Class::Texture, TEXTURES));
    all.extend(pages(Class::Emitter, EMITTERS));
    all.extend(pages(Class::Emitter, SHAPE_EMITTERS));
    all.extend(pages(Class::Medium, MEDIA));
    all.extend(pages(Class::Phase, PHASES));
    all.extend(pages(Class::Volume, VOLUMES));
    all.extend(pages(Class::Sensor, SENSORS));
    all.extend(pages(Class::Sensor, SHAPE_SENSORS));
    all.extend(pages(Class::Film, FILMS));
    all.extend(pages(Class::ReconstructionFilter, rfilter::FILTERS));
    all.extend(pages(Class::Sampler, sampler::SAMPLERS));
    all
}
