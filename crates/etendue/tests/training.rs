//! Jobs train an integrator that learns, before they render with it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use etendue::document::MemoryResources;
use etendue::integrators::{CameraRay, Integrator, Radiance, Start, Training, Watch};
use etendue::sampling::Sampler;
use etendue::scene::Scene;
use etendue::spectrum::Spectrum;
use etendue::{
    Cancel, LoadedScene, RenderJob, RenderOptions, SceneOptions, Silent, Workers, load_text,
};

const SCENE: &str = r#"<scene version="3.0.0"><sensor type="perspective">
    <film type="hdrfilm"><integer name="width" value="5"/><integer name="height" value="3"/></film>
    <sampler type="independent"><integer name="sample_count" value="2"/></sampler>
    </sensor></scene>"#;

/// Learns how many camera samples training takes, and shows that number.
struct Counter {
    learned: Option<f32>,
}

/// The samples that were counted so far.
#[derive(Default)]
struct Counting(AtomicU32);

impl Integrator for Counter {
    fn sample(
        &self,
        _: &Scene,
        _: &Start,
        _: &mut Sampler,
        _: &mut [f32],
        _: &Watch<'_>,
    ) -> Radiance {
        let color = Spectrum::splat(self.learned.unwrap_or(0.0));
        Radiance { color, ..Radiance::NONE }
    }

    fn training(&self) -> Option<Box<dyn Training>> {
        self.learned.is_none().then(|| Box::<Counting>::default() as Box<dyn Training>)
    }
}

impl Training for Counting {
    fn samples_of_passes(&self) -> &[u32] {
        &[1, 4]
    }

    fn learn(&self, _: &Scene, rays: &mut [CameraRay]) {
        self.0.fetch_add(rays.len() as u32, Ordering::Relaxed);
    }

    fn refine(&mut self) {}

    fn finish(self: Box<Self>) -> Box<dyn Integrator> {
        Box::new(Counter { learned: Some(self.0.into_inner() as f32) })
    }
}

fn scene() -> LoadedScene {
    let loaded =
        load_text(SCENE, PathBuf::new(), &MemoryResources::default(), &SceneOptions::default());
    let mut scene = loaded.scene.expect("a scene without mistakes");
    scene.integrator = Arc::new(Counter { learned: None });
    scene
}

#[test]
fn what_is_learned_renders_the_picture() {
    let workers = Workers::new(None).unwrap();
    let job = RenderJob::new(&scene(), &RenderOptions::default()).unwrap();
    let rendering = job.render(&workers, &Silent, &Cancel::new()).unwrap();
    // Five samples for each of 5 x 3 pixels.
    assert!(rendering.picture.channels[0].data.iter().all(|&value| value == 75.0));
}

#[test]
fn a_cancelled_training_is_an_error() {
    let workers = Workers::new(None).unwrap();
    let job = RenderJob::new(&scene(), &RenderOptions::default()).unwrap();
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(job.render(&workers, &Silent, &cancel).is_err());
}
