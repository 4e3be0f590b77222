//! A material on its own: sampled and evaluated without a camera, a light or a ray.
#![allow(clippy::disallowed_macros, reason = "an example prints")]

use std::error::Error;
use std::path::PathBuf;

use etendue::document::MemoryResources;
use etendue::math::Ray;
use etendue::math::glam::{UVec2, Vec3};
use etendue::sampling::{SamplerKind, SamplerSpec};
use etendue::scene::bsdf::Transport;
use etendue::{SceneOptions, load_text};

/// A square in the plane z = 0 that faces +z.
const SCENE: &str = r#"
    <scene version="3.0.0">
        <shape type="rectangle">
            <bsdf type="roughconductor">
                <float name="alpha" value="0.3"/>
                <string name="material" value="Au"/>
            </bsdf>
        </shape>
    </scene>"#;

fn main() -> Result<(), Box<dyn Error>> {
    let nothing = MemoryResources::default();
    let loaded = load_text(SCENE, PathBuf::new(), &nothing, &SceneOptions::default());
    let scene = loaded.scene.ok_or_else(|| loaded.diagnostics.to_string())?.scene;

    // A surface point seen from above at 45°. Textures are looked up here, once.
    let ray = Ray::new(Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, -1.0).normalize());
    let surface = scene.intersect(&ray).ok_or("the ray meets the square")?;
    let bsdf = scene.prepare_bsdf(&surface);

    // Directions are unit vectors in the local frame and point away from the surface.
    let wi = surface.wi;
    let mirrored = Vec3::new(-wi.x, -wi.y, wi.z);
    let (value, pdf) = bsdf.eval_pdf(wi, mirrored, Transport::Radiance);
    println!("f·cos in the direction of a mirror: {:?}, density {pdf:.3}", value.rgb());

    // The mean sample weight is the fraction of light that is reflected.
    const COUNT: u32 = 4096;
    let sampler = SamplerSpec::new(SamplerKind::Sobol, COUNT, 0);
    let mut sum = [0.0_f64; 3];
    for index in 0..COUNT {
        let mut numbers = sampler.start(UVec2::ZERO, index);
        let (lobe, direction) = (numbers.next_1d(), numbers.next_2d());
        // A failed sample has weight zero.
        let Some(sample) = bsdf.sample(wi, lobe, direction, Transport::Radiance) else { continue };
        for (sum, weight) in sum.iter_mut().zip(sample.weight.rgb()) {
            *sum += f64::from(weight);
        }
    }
    println!("albedo: {:.3?}", sum.map(|sum| sum / f64::from(COUNT)));
    Ok(())
}
