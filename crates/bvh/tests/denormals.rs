//! Builds and traversals operate on no denormal floats. Some processors take 150 cycles for such an
//! operation, and integers in a register of floats are denormal: a build that added them along with
//! the floats was six times slower there. The processor records such operations in a flag, also
//! where they are fast.
#![cfg(target_arch = "x86_64")]

mod common;

use common::{ClosedMesh, PRESETS, Random, TIERS};
use etendue_bvh::{Bvh, GeometryView, NoPrimitives, Tier, TriangleMeshView};
use etendue_math::{Bounds3, Ray};
use glam::{Affine3A, Vec3};
use std::arch::asm;
use std::hint::black_box;
use std::sync::Arc;

/// The bit of MXCSR that an operation on a denormal float sets.
const DENORMAL_OPERAND: u32 = 1 << 1;

/// Runs `work`, and returns whether it operated on a denormal float on this thread.
fn touches_denormals<T>(work: impl FnOnce() -> T) -> (T, bool) {
    let mut status = 0_u32;
    // SAFETY: both instructions access these four bytes; only the flags are cleared, so rounding and
    // exceptions stay as Rust expects them.
    unsafe {
        asm!("stmxcsr [{}]", in(reg) &raw mut status, options(nostack));
        status &= !0x3f;
        asm!("ldmxcsr [{}]", in(reg) &raw const status, options(nostack));
    }
    let result = black_box(work());
    // SAFETY: as above.
    unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut status, options(nostack)) };
    (result, status & DENORMAL_OPERAND != 0)
}

/// Runs `work` on one thread, so that nothing happens on others.
fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts");
    pool.install(work)
}

fn view(mesh: &ClosedMesh) -> GeometryView<'_> {
    let (positions, indices) = (&mesh.positions, &mesh.indices);
    GeometryView::Triangles(TriangleMeshView { positions, indices })
}

fn rays(random: &mut Random) -> Vec<Ray> {
    let eye = Vec3::new(9.0, 8.0, 7.0);
    let coherent: Vec<Ray> = (0..256).map(|_| Ray::new(eye, random.point() * 0.3 - eye)).collect();
    coherent.into_iter().chain((0..256).map(|_| random.ray(6.0))).collect()
}

#[test]
fn the_flag_is_set_by_a_denormal_operand() {
    let sum = |a: f32, b: f32| touches_denormals(|| black_box(a) + black_box(b));
    assert_eq!(sum(1.0, 2.0), (3.0, false));
    assert!(sum(1.0, f32::from_bits(1)).1);
}

#[test]
fn builds_and_traversals_touch_no_denormal_floats() {
    let mut random = Random::new(91);
    let mesh = ClosedMesh::new(&mut random, 6, 0.4, 3.0, Vec3::new(0.5, 0.0, -1.0));
    let boxes: Vec<Bounds3> = (0..500)
        .map(|_| {
            let center = random.point() * 8.0;
            Bounds3::new(center - random.unit(), center + random.unit())
        })
        .collect();
    for preset in PRESETS {
        let (group, touched) = alone(|| touches_denormals(|| Bvh::build(&[view(&mesh)], &preset)));
        assert!(!touched, "triangles, {preset:?}");
        let group = Arc::new(group.expect("valid"));
        let to_world = Affine3A::from_translation(Vec3::new(5.0, 1.0, 2.0));
        let instance = GeometryView::Instance { group: group.clone(), to_world };
        let everything = [view(&mesh), GeometryView::User(&boxes), instance];
        let (built, touched) =
            alone(|| touches_denormals(|| Bvh::build(&everything, &preset).expect("valid")));
        assert!(!touched, "everything, {preset:?}");
        let rays = rays(&mut random);
        for tier in TIERS {
            trace(&built.clone().with_tier(tier), &rays, tier);
            trace(&Bvh::clone(&group).with_tier(tier), &rays, tier);
        }
    }
}

/// Traces rays alone and together.
fn trace(bvh: &Bvh, rays: &[Ray], tier: Tier) {
    let singly =
        |ray: &Ray| (bvh.intersect(ray, &NoPrimitives).is_some(), bvh.occluded(ray, &NoPrimitives));
    let (_, touched) = touches_denormals(|| rays.iter().map(singly).collect::<Vec<_>>());
    assert!(!touched, "single rays, {tier:?}");
    let (hits, touched) = touches_denormals(|| {
        let (mut hits, mut occluded) = (Vec::new(), Vec::new());
        bvh.intersect_many(rays, &NoPrimitives, &mut hits);
        bvh.occluded_many(rays, &NoPrimitives, &mut occluded);
        hits
    });
    assert!(!touched, "many rays, {tier:?}");
    assert!(hits.iter().any(Option::is_some), "{tier:?}");
}
