//! Training passes: an integrator learns before the picture's first sample.

use etendue_integrators::{Integrator, Training};
use etendue_sampling::SamplerSpec;
use etendue_sampling::hash::mix64;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::EngineError;
use crate::observer::Cancel;
use crate::region::{Region, TILE_SIDES};
use crate::source::{BATCH_SIZE, SampleId};
use crate::workers::Workers;

/// Keeps the random numbers of training apart from those of the picture.
const TRAINING_SEED: u64 = 0x7472_6169_6e69_6e67;

impl Camera {
    /// Trains the integrator. The result renders in its place; `None` if there is nothing to learn.
    ///
    /// The result depends only on the scene, the sensor with its whole film, the integrator, and the
    /// kind and the seed of the sampler. It has the same bits for every part of a picture, for every
    /// number of threads, and for a run that resumes another one: each of them trains first. So
    /// checkpoints and parts need not know of training.
    ///
    /// # Errors
    ///
    /// [`EngineError::Cancelled`] if `cancel` stopped it.
    pub fn train(
        &self,
        workers: &Workers,
        cancel: &Cancel,
    ) -> Result<Option<Box<dyn Integrator>>, EngineError> {
        let Some(mut training) = self.integrator().training() else { return Ok(None) };
        let tiles = self.film_region().tiles(TILE_SIDES[0]);
        for (pass, count) in training.samples_of_passes().to_vec().into_iter().enumerate() {
            let camera = self.with_sampler(training_sampler(self.sampler(), pass, count));
            workers.run(|| {
                tiles.par_iter().with_max_len(1).for_each(|tile| {
                    if !cancel.is_cancelled() {
                        camera.learn_tile(&*training, tile, count);
                    }
                });
            });
            if cancel.is_cancelled() {
                return Err(EngineError::Cancelled);
            }
            training.refine();
        }
        Ok(Some(training.finish()))
    }

    /// Learns from `count` samples of every pixel of a tile.
    fn learn_tile(&self, training: &dyn Training, tile: &Region, count: u32) {
        let mut ids = Vec::with_capacity(BATCH_SIZE);
        for y in tile.y..tile.y + tile.height {
            for x in tile.x..tile.x + tile.width {
                for index in 0..count {
                    ids.push(SampleId { index, y, x });
                    if ids.len() == BATCH_SIZE {
                        self.learn(training, &mut ids);
                    }
                }
            }
        }
        self.learn(training, &mut ids);
    }

    fn learn(&self, training: &dyn Training, ids: &mut Vec<SampleId>) {
        let (mut rays, _) = self.start(ids);
        training.learn(self.scene(), &mut rays);
        ids.clear();
    }
}

/// The random numbers of one training pass.
fn training_sampler(picture: &SamplerSpec, pass: usize, count: u32) -> SamplerSpec {
    let seed = mix64(picture.seed() ^ mix64(TRAINING_SEED.wrapping_add(pass as u64)));
    SamplerSpec::new(picture.kind(), count, seed)
}
