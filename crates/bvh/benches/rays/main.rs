//! Measures rays per second on the triangles of a scene, and those of Embree if its library is
//! given:
//!
//! ```text
//! cargo bench -p etendue-bvh --bench rays -- [TRIANGLES] [--embree LIBEMBREE4.SO] [--rounds COUNT]
//!     [--preset NAME] [--kind NAME] [--json] [--batch COUNT]
//! ```
//!
//! `cargo xtask bench rays` writes the file of triangles, fetches Embree, and calls this. Without a
//! file, the rays meet generated hills. All hierarchies trace the same rays in turns on one thread;
//! the best round by the thread's processor time counts, and only the ratios mean something.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "a program on the command line"
)]

mod clock;
mod embree;
mod options;
mod report;
#[path = "../shared/terrain.rs"]
#[allow(dead_code, reason = "the benchmark `scale` uses the rest")]
mod terrain;
mod triangles;
mod workload;

use clock::{thread_seconds, timed};
use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, Tier, TriangleMeshView};
use etendue_math::Ray;
use options::Options;
use report::{Measured, Trace};
use std::error::Error;
use triangles::Mesh;
use workload::Workload;

/// Traces rays and counts the hits.
trait Tracer {
    fn name(&self) -> String;
    fn bytes(&self) -> usize;
    fn count_closest(&self, rays: &[Ray]) -> usize;
    fn count_any(&self, rays: &[Ray]) -> usize;
}

/// Our hierarchy, one ray at a time.
struct Ours(Bvh);

/// Our hierarchy, in batches of this many rays, as in the renderer.
struct Batches(Bvh, usize);

impl Tracer for Batches {
    fn name(&self) -> String {
        format!("{} by {}", tier_name(self.0.tier()), self.1)
    }

    fn bytes(&self) -> usize {
        self.0.memory_bytes()
    }

    fn count_closest(&self, rays: &[Ray]) -> usize {
        let (mut count, mut hits) = (0, Vec::with_capacity(self.1));
        for batch in rays.chunks(self.1) {
            hits.clear();
            self.0.intersect_many(batch, &NoPrimitives, &mut hits);
            count += hits.iter().flatten().count();
        }
        count
    }

    fn count_any(&self, rays: &[Ray]) -> usize {
        let (mut count, mut occluded) = (0, Vec::with_capacity(self.1));
        for batch in rays.chunks(self.1) {
            occluded.clear();
            self.0.occluded_many(batch, &NoPrimitives, &mut occluded);
            count += occluded.iter().filter(|&&occluded| occluded).count();
        }
        count
    }
}

impl Tracer for Ours {
    fn name(&self) -> String {
        tier_name(self.0.tier())
    }

    fn bytes(&self) -> usize {
        self.0.memory_bytes()
    }

    fn count_closest(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|ray| self.0.intersect(ray, &NoPrimitives).is_some()).count()
    }

    fn count_any(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|ray| self.0.occluded(ray, &NoPrimitives)).count()
    }
}

fn tier_name(tier: Tier) -> String {
    format!("etendue {tier:?}").to_lowercase()
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse(std::env::args().skip(1))?;
    let (camera, meshes) = match &options.triangles {
        Some(path) => triangles::read(path)?,
        None => triangles::generated(),
    };
    let (mut measured, tracers) = build_all(&options, &meshes)?;
    let ours = Ours(build(&meshes, &options.preset));
    let workload = Workload::new(&camera, &meshes, &ours.0);
    let mut all: Vec<Box<dyn Tracer>> = vec![Box::new(ours)];
    all.extend(tracers);
    // Finally, for comparison, batches of rays and the more common tier.
    let mut tiers = vec![Tier::detect()];
    if all[0].name() != tier_name(Tier::Avx2) && Tier::Avx2.is_available() {
        all.push(Box::new(Ours(build(&meshes, &options.preset).with_tier(Tier::Avx2))));
        tiers.push(Tier::Avx2);
    }
    if let Some(count) = options.batch {
        for tier in tiers {
            let bvh = build(&meshes, &options.preset).with_tier(tier);
            all.push(Box::new(Batches(bvh, count)));
        }
    }
    measured.resize_with(all.len(), Measured::default);
    trace_all(&options, &workload, &all, &mut measured);
    let triangle_count = meshes.iter().map(|mesh| mesh.indices.len()).sum();
    if options.json {
        println!("{}", report::json(triangle_count, &workload, &options.kinds, &measured));
    } else {
        report::print(triangle_count, &workload, &options.kinds, &measured);
    }
    Ok(())
}

fn build(meshes: &[Mesh], preset: &BuildOptions) -> Bvh {
    let views: Vec<GeometryView<'_>> = meshes
        .iter()
        .map(|mesh| {
            let (positions, indices) = (&mesh.positions, &mesh.indices);
            GeometryView::Triangles(TriangleMeshView { positions, indices })
        })
        .collect();
    Bvh::build(&views, preset).expect("a scene that has been built before is valid")
}

/// Times the builds in turns, on one thread and two, and keeps a scene of every peer. Our own row
/// comes first, and has no tracer yet.
#[expect(clippy::type_complexity, reason = "two lists with one row per tracer")]
fn build_all(
    options: &Options,
    meshes: &[Mesh],
) -> Result<(Vec<Measured>, Vec<Box<dyn Tracer>>), Box<dyn Error>> {
    let variants = if options.embree.is_some() { embree::VARIANTS.as_slice() } else { &[] };
    let mut measured: Vec<Measured> = (0..=variants.len()).map(|_| Measured::default()).collect();
    let mut tracers: Vec<Box<dyn Tracer>> = Vec::new();
    for round in 0..options.rounds.min(5) {
        for threads in [2, 1] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            let (took, _) = pool.install(|| timed(|| build(meshes, &options.preset)));
            measured[0].took_to_build(threads, took);
            for (row, variant) in variants.iter().enumerate() {
                let library = options.embree.as_deref().unwrap_or_default();
                let (took, scene) = embree::Scene::build(library, variant, meshes, threads)?;
                measured[row + 1].took_to_build(threads, took);
                if round == 0 && threads == 1 {
                    tracers.push(Box::new(scene));
                }
            }
        }
    }
    Ok((measured, tracers))
}

/// Traces every kind of ray, in turns.
fn trace_all(
    options: &Options,
    workload: &Workload,
    tracers: &[Box<dyn Tracer>],
    measured: &mut [Measured],
) {
    for (tracer, measured) in tracers.iter().zip(&mut *measured) {
        (measured.name, measured.bytes) = (tracer.name(), tracer.bytes());
    }
    for _ in 0..options.rounds {
        for &kind in &options.kinds {
            for (tracer, measured) in tracers.iter().zip(&mut *measured) {
                let rays = workload.rays(kind);
                let start = thread_seconds();
                let hits = if kind.is_any_hit() {
                    tracer.count_any(rays)
                } else {
                    tracer.count_closest(rays)
                };
                measured.traced(Trace { kind, hits, seconds: thread_seconds() - start });
            }
        }
    }
}
