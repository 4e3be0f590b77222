//! Closures in lanes equal those of single hits bit by bit, with every instruction set of this
//! machine.

use super::*;
use crate::interaction::SurfaceInteraction;
use crate::scattering::{BsdfSample, Lobe};
use crate::testing::bsdf_cases::PLUGINS;
use crate::testing::material::{TestMaterial, surface};
use etendue_math::lanes::{LaneMask, Lanes, Level, MAX_LANES, Mask as _, Simd, baseline};
use etendue_math::with_lanes;
use etendue_spectrum::Spectrum;
use etendue_testkit::TestRng;
use glam::{Vec2, Vec3};

/// The batched cases of all plugins, by the kind of their closures.
fn materials_by_kind() -> Vec<(LaneKind, Vec<(&'static str, TestMaterial)>)> {
    let all: Vec<_> = PLUGINS
        .iter()
        .flat_map(|(_, cases)| cases.batched)
        .map(|&xml| {
            let material = TestMaterial::read(xml);
            let kind = material.materials().lane_kind(material.root).expect("a kind");
            (kind, xml, material)
        })
        .collect();
    let mut by_kind: Vec<_> = LaneKind::ALL.map(|kind| (kind, Vec::new())).into();
    for (kind, xml, material) in all {
        by_kind[kind.index()].1.push((xml, material));
    }
    by_kind
}

/// Materials that lanes cannot hold.
const OTHERS: &[&str] = &[
    r#"<bsdf type="null"/>"#,
    r#"<bsdf type="roughplastic"><boolean name="sample_visible" value="false"/></bsdf>"#,
    r#"<bsdf type="roughconductor"><boolean name="sample_visible" value="false"/></bsdf>"#,
    r#"<bsdf type="roughdielectric"><boolean name="sample_visible" value="false"/></bsdf>"#,
    r#"<bsdf type="mask"><bsdf type="diffuse"/></bsdf>"#,
    r#"<bsdf type="bumpmap"><texture type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#,
    r#"<bsdf type="twosided"><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf>"#,
    r#"<bsdf type="twosided"><bsdf type="diffuse"/><bsdf type="diffuse"/></bsdf>"#,
    r#"<bsdf type="twosided"><bsdf type="blendbsdf"><bsdf type="diffuse"/><bsdf type="diffuse"/></bsdf></bsdf>"#,
];

fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(best.as_avx2().map(Simd::level));
    levels
}

/// The directions and random numbers of one path per lane.
struct Paths {
    wi: [Vec3; MAX_LANES],
    wo: [Vec3; MAX_LANES],
    lobe: [f32; MAX_LANES],
    direction: [Vec2; MAX_LANES],
}

impl Paths {
    fn random(random: &mut TestRng) -> Self {
        Self {
            wi: std::array::from_fn(|_| direction(random)),
            wo: std::array::from_fn(|_| direction(random)),
            lobe: std::array::from_fn(|_| random.next_f32()),
            direction: std::array::from_fn(|_| random.next_vec2()),
        }
    }
}

/// Arbitrary directions, often along the axes or the surface.
fn direction(random: &mut TestRng) -> Vec3 {
    let any = random.unit_vector();
    match (random.next_f32() * 20.0) as u32 {
        0 => Vec3::Z,
        1 => -Vec3::Z,
        2 => any.with_z(0.0).normalize_or(Vec3::X),
        3 => any.with_z(1e-6).normalize(),
        4 => any.with_z(-1e-20).normalize(),
        5 => (Vec3::Z + any * 1e-4).normalize(),
        _ => any,
    }
}

/// The results of the lanes, one by one.
struct Answers {
    eval: [(Spectrum, f32); MAX_LANES],
    sample: [Option<BsdfSample>; MAX_LANES],
}

#[inline(always)]
fn answer<S: Simd>(simd: S, closures: &ClosureBatch<'_>, paths: &Paths) -> Answers {
    let mut answers =
        Answers { eval: [(Spectrum::ZERO, 0.0); MAX_LANES], sample: [None; MAX_LANES] };
    for first in (0..MAX_LANES).step_by(Lanes::<S>::COUNT) {
        let load = |of: &dyn Fn(usize) -> f32| Lanes::from_fn(simd, |lane| of(first + lane));
        let vector = |of: &[Vec3; MAX_LANES]| {
            Vector3::new(
                load(&|lane| of[lane].x),
                load(&|lane| of[lane].y),
                load(&|lane| of[lane].z),
            )
        };
        let (wi, wo) = (vector(&paths.wi), vector(&paths.wo));
        let lobe = load(&|lane| paths.lobe[lane]);
        let direction = Vector2::new(
            load(&|lane| paths.direction[lane].x),
            load(&|lane| paths.direction[lane].y),
        );
        let (value, pdf) = closures.eval_pdf(simd, first, wi, wo);
        let sample = closures.sample(simd, first, wi, lobe, direction);
        for lane in 0..Lanes::<S>::COUNT {
            let has = |mask: LaneMask<S>| mask.bits() >> lane & 1 == 1;
            let lobe = match (has(sample.smooth), has(sample.null)) {
                (true, _) => Lobe::Smooth,
                (false, true) => Lobe::Null,
                (false, false) => Lobe::Delta,
            };
            answers.eval[first + lane] = (spectrum(value, lane), pdf.lane(lane));
            answers.sample[first + lane] = has(sample.exists).then(|| BsdfSample {
                wo: sample.wo.lane(lane),
                weight: spectrum(sample.weight, lane),
                pdf: sample.pdf.lane(lane),
                eta: sample.eta.lane(lane),
                lobe,
            });
        }
    }
    answers
}

fn spectrum<S: Simd>(spectra: SpectrumLanes<Lanes<S>>, lane: usize) -> Spectrum {
    spectra.convert(|component| component.lane(lane)).into()
}

/// The materials of one kind as in a scene, and their hits.
struct Lane<'a> {
    material: &'a TestMaterial,
    surface: SurfaceInteraction,
}

fn fill<'a>(closures: &mut ClosureBatch<'a>, lanes: &[Lane<'a>]) {
    for (lane, Lane { material, surface }) in lanes.iter().enumerate() {
        let (materials, id) = (material.materials(), material.root);
        if materials.is_uniform(id) {
            closures.set_uniform(lane, materials, id);
        } else {
            closures.set(lane, materials, id, Textures(&material.textures), surface);
        }
    }
}

#[test]
fn lanes_give_the_bits_of_hits_alone() {
    let mut random = TestRng::new(11);
    for (kind, materials) in materials_by_kind() {
        for round in 0..500 {
            let paths = Paths::random(&mut random);
            let lanes = paths.wi.map(|wi| {
                let index = (random.next_f32() * materials.len() as f32) as usize;
                // Sometimes all lanes share one material, which may take a fast path.
                let index = if round % 4 == 0 { round / 4 % materials.len() } else { index };
                let material = &materials[index].1;
                let uv = random.next_vec2() * 3.0;
                Lane { material, surface: SurfaceInteraction { uv, ..surface(wi) } }
            });
            let mut closures = ClosureBatch::new(kind);
            fill(&mut closures, &lanes);
            for level in levels() {
                let answers = with_lanes!(level, simd => answer(simd, &closures, &paths));
                for (index, lane) in lanes.iter().enumerate() {
                    assert_alone(&answers, index, lane, &paths, kind);
                }
            }
        }
    }
}

/// Asserts that a lane equals its single hit.
#[track_caller]
fn assert_alone(answers: &Answers, index: usize, lane: &Lane<'_>, paths: &Paths, kind: LaneKind) {
    let bsdf = lane.material.bsdf_at(&lane.surface);
    let (wi, wo) = (paths.wi[index], paths.wo[index]);
    let eval = bsdf.eval_pdf(wi, wo, Transport::Radiance);
    let (lobe, direction) = (paths.lobe[index], paths.direction[index]);
    let sample = bsdf.sample(wi, lobe, direction, Transport::Radiance);
    let bits = |(value, pdf): (Spectrum, f32)| (value.rgb().map(f32::to_bits), pdf.to_bits());
    let sample_bits = |sample: Option<BsdfSample>| {
        sample.map(|sample| {
            let wo = sample.wo.to_array().map(f32::to_bits);
            (wo, bits((sample.weight, sample.pdf)), sample.eta.to_bits(), sample.lobe)
        })
    };
    let (in_lanes, sampled) = (answers.eval[index], answers.sample[index]);
    assert_eq!(bits(in_lanes), bits(eval), "{kind:?} {wi} {wo}: {in_lanes:?} {eval:?}");
    assert_eq!(sample_bits(sampled), sample_bits(sample), "{kind:?} {wi}: {sampled:?} {sample:?}");
}

#[test]
fn every_kind_has_its_cases() {
    for (kind, materials) in materials_by_kind() {
        let has = |what: &dyn Fn(Materials<'_>, MaterialId) -> bool| {
            materials.iter().any(|(_, material)| what(material.materials(), material.root))
        };
        assert!(has(&|materials, id| materials.is_uniform(id)), "{kind:?} without textures");
        assert!(has(&|materials, id| !materials.is_uniform(id)), "{kind:?} with a texture");
        let is_two_sided = has(&|materials, id| materials.is_two_sided(id));
        let transmits = has(&|materials, id| bsdf::transmits(materials.materials, id));
        assert!(is_two_sided || transmits, "{kind:?} inside `twosided`");
        for (xml, material) in &materials {
            let (materials, id) = (material.materials(), material.root);
            assert_eq!(materials.is_two_sided(id), xml.contains("twosided"), "{xml}");
            assert_eq!(materials.is_uniform(id), !xml.contains("texture"), "{xml}");
        }
        assert_eq!(LaneKind::ALL[kind.index()], kind);
    }
}

#[test]
fn what_lanes_cannot_hold_has_no_kind() {
    for xml in OTHERS {
        let material = TestMaterial::read(xml);
        assert_eq!(material.materials().lane_kind(material.root), None, "{xml}");
    }
}
