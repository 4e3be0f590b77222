//! Signed distance grids: hits compared with Mitsuba's.

use etendue_document::{Diagnostics, MemoryResources};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use glam::Vec3;

fn scene(normals: &str) -> Scene {
    let diagnostics = Diagnostics::new();
    let resources =
        MemoryResources::default().with("d.vol", include_bytes!("data/distance.vol").to_vec());
    let text = format!(
        r#"<scene version="3.0.0"><shape type="sdfgrid"><string name="filename" value="d.vol"/><string name="normals" value="{normals}"/><transform name="to_world"><scale x="2" y="1" z="1.5"/><translate x="-1" y="-0.5"/></transform></shape></scene>"#
    );
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
        .unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

/// `mitsuba_distances.txt` holds the results of `scalar_rgb` in version 3.9.1. Each line is a ray:
/// the kind of normals, origin and direction, then t and the geometric and shading normals, or
/// `miss`. The grid is a noisy ball of 6×6×6 values; with unequal sides, that version loses most
/// of the surface.
#[test]
fn rays_hit_where_they_do_in_mitsuba() {
    let scenes = ["smooth", "analytic"].map(|normals| (normals, scene(normals)));
    let (mut hits, mut differing) = (0, Vec::new());
    for line in include_str!("data/mitsuba_distances.txt").lines() {
        let (normals, rest) = line.split_once(' ').expect("a name and numbers");
        let numbers: Vec<f32> = rest.split(' ').filter_map(|word| word.parse().ok()).collect();
        let (_, scene) = scenes.iter().find(|(name, _)| *name == normals).expect("one of the two");
        let vec3 = |start: usize| Vec3::from_slice(&numbers[start..start + 3]);
        let found = scene.intersect(&Ray::new(vec3(0), vec3(3)));
        if numbers.len() == 6 {
            differing.extend(found.map(|found| (line, Some(found))));
            continue;
        }
        hits += 1;
        let is_close = found.is_some_and(|found| {
            (found.t - numbers[6]).abs() < 1e-3
                && found.shading.n.dot(vec3(10)) > 0.999
                && (normals == "smooth" || found.normal.dot(vec3(7)) > 0.999)
        });
        if !is_close {
            differing.push((line, found));
        }
    }
    assert!(hits > 60 && differing.len() <= 1, "of {hits}: {differing:#?}");
}
