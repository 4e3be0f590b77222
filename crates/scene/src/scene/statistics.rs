//! Statistics of a scene.

use super::Scene;
use crate::medium::Medium;
use crate::shape::Geometry;
use crate::texture::Texture;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Statistics of a scene, for display.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneStatistics {
    /// Shapes, including instances. Shapes within groups count once.
    pub shapes: usize,
    /// Triangles. Those within groups count once.
    pub triangles: usize,
    /// Instances of shape groups.
    pub instances: usize,
    /// Materials.
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Emitters by kind.
    pub emitters: BTreeMap<&'static str, usize>,
    /// Bytes used by meshes.
    pub mesh_bytes: usize,
    /// Bytes used by their trees and by instances.
    pub tree_bytes: usize,
    /// Bytes used by textures, without the volumes that they show.
    pub texture_bytes: usize,
    /// Participating media.
    pub media: usize,
    /// Bytes used by the grids of media, phase functions and textures, each counted once, and by
    /// the bounds of media.
    pub volume_bytes: usize,
}

impl Scene {
    /// The statistics of the scene.
    #[must_use]
    pub fn statistics(&self) -> SceneStatistics {
        let mut statistics = SceneStatistics {
            shapes: self.shapes.len() + self.instances.len(),
            instances: self.instances.len(),
            materials: self.materials.len(),
            textures: self.textures.len(),
            tree_bytes: self.bvh.memory_bytes()
                + self.groups.iter().map(|group| group.bvh.memory_bytes()).sum::<usize>()
                + size_of_val(self.instances.as_slice()),
            texture_bytes: self.texture_bytes(),
            media: self.media.len(),
            volume_bytes: self.volume_bytes(),
            ..SceneStatistics::default()
        };
        for shape in &self.shapes {
            if let Geometry::Mesh(mesh) = &shape.geometry {
                statistics.triangles += mesh.triangles().len();
            }
            statistics.mesh_bytes += shape.geometry.memory_bytes();
        }
        for emitter in &self.emitters {
            *statistics.emitters.entry(emitter.kind()).or_default() += 1;
        }
        statistics
    }

    /// Whether light may be negative in some channel, because a picture has colours beyond the
    /// primaries of BT.709.
    #[must_use]
    pub fn is_out_of_gamut(&self) -> bool {
        let mut texels = self.textures.iter().filter_map(Texture::texels);
        texels.any(|texels| texels.are_out_of_gamut())
            || self.emitters.iter().any(|emitter| emitter.is_out_of_gamut())
    }

    fn texture_bytes(&self) -> usize {
        let texels = distinct(self.textures.iter().filter_map(Texture::texels).collect());
        self.textures.iter().map(Texture::memory_bytes).sum::<usize>()
            + texels.iter().map(|texels| texels.memory_bytes()).sum::<usize>()
    }

    fn volume_bytes(&self) -> usize {
        let mut grids = Vec::new();
        self.media.iter().for_each(|medium| medium.collect_grids(&mut grids));
        self.textures.iter().for_each(|texture| texture.collect_grids(&mut grids));
        self.media.iter().map(Medium::memory_bytes).sum::<usize>()
            + distinct(grids).iter().map(|grid| grid.memory_bytes()).sum::<usize>()
    }
}

/// Removes duplicates of shared grids.
fn distinct<T>(mut shared: Vec<&Arc<T>>) -> Vec<&Arc<T>> {
    shared.sort_by_key(|one| Arc::as_ptr(one));
    shared.dedup_by_key(|one| Arc::as_ptr(one));
    shared
}
