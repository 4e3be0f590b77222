//! Rays per second on the triangles of a folder of OBJ files, beside Embree if its library is given:
//!
//! ```text
//! cargo run --release -p etendue-bvh --example rays -- MODELS [LIBEMBREE4.SO [ROUNDS [PRESET [VARIANTS [KIND]]]]]
//! ```
//!
//! Embree's library is in the wheel `embreex` of the Python package index, beside the `libtbb` that
//! it needs (set `LD_LIBRARY_PATH` to their folder). All hierarchies trace the same rays in turns on one thread; the best
//! round by the thread's processor time counts, and only the ratios mean something. The camera is
//! that of the kitchen of Bitterli's rendering resources.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "a program on the command line"
)]

mod embree;
mod obj;
mod workload;

use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
use etendue_math::Ray;
use obj::Mesh;
use std::error::Error;
use workload::{Kind, Workload};

/// Something that traces rays and counts the hits.
trait Tracer {
    fn name(&self) -> String;
    fn count_closest(&self, rays: &[Ray]) -> usize;
    fn count_any(&self, rays: &[Ray]) -> usize;
}

struct Ours(&'static str, Bvh);

impl Tracer for Ours {
    fn name(&self) -> String {
        format!("etendue {} {:?}", self.0, self.1.tier())
    }

    fn count_closest(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|ray| self.1.intersect(ray, &NoPrimitives).is_some()).count()
    }

    fn count_any(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|ray| self.1.occluded(ray, &NoPrimitives)).count()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [models, ..] = arguments.as_slice() else {
        return Err("usage: rays MODELS [LIBEMBREE4.SO [ROUNDS [PRESET [VARIANTS [KIND]]]]]".into());
    };
    let meshes = obj::read_folder(models)?;
    let triangles: usize = meshes.iter().map(|mesh| mesh.indices.len()).sum();
    println!("{} meshes, {triangles} triangles", meshes.len());
    let preset = arguments.get(3).map_or("balanced", String::as_str);
    let ours: Vec<Ours> =
        presets(preset).into_iter().map(|preset| build(preset, &meshes)).collect();
    let workload = Workload::new(&ours[0].1);
    let mut tracers: Vec<Box<dyn Tracer>> = Vec::new();
    if let Some(library) = arguments.get(1).filter(|library| library.as_str() != "-") {
        let variants = arguments.get(4).map_or(Ok(3), |count| count.parse())?;
        for variant in embree::VARIANTS.into_iter().take(variants) {
            tracers.push(Box::new(embree::Scene::build(library, variant, &meshes)?));
        }
    }
    for ours in ours {
        tracers.push(Box::new(ours));
    }
    let rounds = arguments.get(2).map_or(Ok(5), |rounds| rounds.parse())?;
    let kinds: Vec<Kind> = match arguments.get(5) {
        Some(name) => Kind::ALL.into_iter().filter(|kind| format!("{kind:?}") == *name).collect(),
        None => Kind::ALL.to_vec(),
    };
    report(&tracers, &workload, &kinds, rounds);
    Ok(())
}

fn presets(name: &str) -> Vec<(&'static str, BuildOptions)> {
    let all = [
        ("fast", BuildOptions::FAST),
        ("balanced", BuildOptions::BALANCED),
        ("spatial", BuildOptions::SPATIAL),
    ];
    all.into_iter().filter(|(preset, _)| name == "all" || *preset == name).collect()
}

fn build((name, options): (&'static str, BuildOptions), meshes: &[Mesh]) -> Ours {
    let views: Vec<GeometryView<'_>> = meshes
        .iter()
        .map(|mesh| {
            let (positions, indices) = (&mesh.positions, &mesh.indices);
            GeometryView::Triangles(TriangleMeshView { positions, indices })
        })
        .collect();
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let one_thread = (0..3)
        .map(|_| {
            single.install(|| {
                let start = workload::thread_seconds();
                Bvh::build(&views, &options).expect("the models are valid");
                workload::thread_seconds() - start
            })
        })
        .fold(f64::INFINITY, f64::min);
    let start = std::time::Instant::now();
    let bvh = Bvh::build(&views, &options).expect("the models are valid");
    let wall = start.elapsed().as_secs_f64();
    println!(
        "etendue {name}: build {one_thread:.3} s on one thread (processor time), {wall:.3} s on {} (wall), {:.1} MB",
        rayon::current_num_threads(),
        bvh.memory_bytes() as f64 * 1e-6
    );
    println!("{:?}", bvh.statistics());
    Ours(name, bvh)
}

fn report(tracers: &[Box<dyn Tracer>], workload: &Workload, kinds: &[Kind], rounds: usize) {
    let mut best = vec![[f64::INFINITY; Kind::ALL.len()]; tracers.len()];
    let mut hits = vec![[0; Kind::ALL.len()]; tracers.len()];
    for _ in 0..rounds {
        for (column, kind) in kinds.iter().copied().enumerate() {
            for (row, tracer) in tracers.iter().enumerate() {
                let rays = workload.rays(kind);
                let start = workload::thread_seconds();
                hits[row][column] = if kind.is_any_hit() {
                    tracer.count_any(rays)
                } else {
                    tracer.count_closest(rays)
                };
                let seconds = workload::thread_seconds() - start;
                best[row][column] = best[row][column].min(seconds);
            }
        }
    }
    let header: Vec<String> = kinds.iter().map(|kind| format!("{kind:?}")).collect();
    println!("{:32} {}", "Mrays/s (ratio to the first)", header.join("          "));
    for (row, tracer) in tracers.iter().enumerate() {
        print!("{:32}", tracer.name());
        for (column, kind) in kinds.iter().copied().enumerate() {
            let rate = workload.rays(kind).len() as f64 * 1e-6 / best[row][column];
            print!(" {rate:6.2} ({:4.2})   ", best[0][column] / best[row][column]);
        }
        println!("\n{:32} {:?}", "", hits[row]);
    }
}
