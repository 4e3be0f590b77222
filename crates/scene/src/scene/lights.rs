//! Light samples for several paths at once.
//!
//! Every lane equals [`Scene::sample_light`] bit by bit. Parallelograms and other meshes of
//! constant radiance, and constant environments, are sampled in lanes; other emitters one lane at a
//! time.

#[cfg(test)]
mod tests;

use crate::batch::{LightBatch, Places};
use crate::emitter::area::{ParallelogramLightBatch, light_from};
use crate::emitter::constant::light_from_everywhere;
use crate::emitter::{DirectionSample, Emitter, LaneEmitter};
use crate::lanes::LightLanes;
use crate::models::mesh::{LightPoint, LightPointBatch};
use crate::scene::{Scene, choose_evenly};
use crate::shape::{Geometry, Shape};
use etendue_math::lanes::{
    LaneArray, LaneMask, Lanes, MAX_LANES, Mask as _, Simd, Vector2, Vector3,
};
use etendue_spectrum::SpectrumLanes;
use glam::{Vec2, Vec3};

impl LaneEmitter {
    /// [`Emitter::sample_direction`], if all lanes sample this emitter and it supports lanes.
    #[inline(always)]
    fn sample_direction<S: Simd>(
        &self,
        simd: S,
        reference: Vector3<Lanes<S>>,
        random: Vector2<Lanes<S>>,
    ) -> Option<LightLanes<Lanes<S>>> {
        match self {
            Self::Parallelogram(light) => {
                Some(light.splat(simd).sample_direction(reference, random))
            }
            Self::ConstantEnvironment(radiance) => {
                Some(light_from_everywhere(SpectrumLanes::splat(simd, *radiance), random))
            }
            Self::Mesh(..) | Self::Single => None,
        }
    }
}

/// What lanes can sample of each emitter of a scene.
#[derive(Debug)]
pub(crate) struct LaneEmitters(Vec<LaneEmitter>);

impl LaneEmitters {
    pub(crate) fn new(emitters: &[Emitter], shapes: &[Shape]) -> Self {
        Self(emitters.iter().map(|emitter| emitter.in_lanes(shapes)).collect())
    }
}

/// Chosen emitters, one per lane.
struct Choices<S: Simd> {
    /// The emitters; arbitrary in lanes that need none.
    emitters: [u32; MAX_LANES],
    /// Their probabilities.
    probability: Lanes<S>,
    /// The rescaled random numbers.
    rest: Lanes<S>,
}

impl Scene {
    /// Samples light from a randomly chosen emitter, seen from `point`. The density includes the
    /// probability of the emitter.
    #[inline(always)]
    #[must_use]
    pub fn sample_light(&self, point: Vec3, mut random: Vec2) -> Option<DirectionSample> {
        let choice = self.choose_emitter(&mut random.x)?;
        let emitter = self.emitter(choice.emitter);
        let mut light = emitter.sample_direction(self, point, random)?;
        light.pdf *= choice.probability;
        Some(light)
    }

    /// [`Self::sample_light`] for the `wanted` lanes; the others get no light.
    #[inline(always)]
    #[must_use]
    pub fn sample_lights<S: Simd>(
        &self,
        simd: S,
        reference: Vector3<Lanes<S>>,
        random: Vector2<Lanes<S>>,
        wanted: LaneMask<S>,
    ) -> LightLanes<Lanes<S>> {
        if let [only] = self.lane_emitters().0.as_slice() {
            let (_, rest) = choose_evenly(random.x, 1);
            let rest = Vector2::new(rest, random.y);
            if let Some(light) = only.sample_direction(simd, reference, rest) {
                return LightLanes { exists: light.exists & wanted, ..light };
            }
        }
        if self.emitters().is_empty() || !wanted.any() {
            return LightBatch::default().load(simd);
        }
        let choices = self.choose_emitters(simd, random.x, wanted);
        let random = Vector2::new(choices.rest, random.y);
        let mut light = self.sample_in_lanes(simd, (reference, random), wanted, &choices.emitters);
        light.pdf = light.pdf * choices.probability;
        light
    }

    /// [`Self::choose_emitter`] for each lane.
    #[inline(always)]
    fn choose_emitters<S: Simd>(
        &self,
        simd: S,
        random: Lanes<S>,
        wanted: LaneMask<S>,
    ) -> Choices<S> {
        let count = self.emitters().len();
        let mut emitters = [0; MAX_LANES];
        if self.emitter_table().is_some() {
            return self.choose_by_weight(simd, random, wanted.bits());
        }
        let (index, rest) = choose_evenly(random, count);
        let mut indices = LaneArray::ZERO;
        index.store(&mut indices, 0);
        for lane in lanes_of(wanted.bits()) {
            emitters[lane] = (indices.0[lane] as u32).min(count as u32 - 1);
        }
        Choices { emitters, probability: Lanes::splat(simd, 1.0 / count as f32), rest }
    }

    #[inline(always)]
    fn choose_by_weight<S: Simd>(&self, simd: S, random: Lanes<S>, wanted: u32) -> Choices<S> {
        let mut emitters = [0; MAX_LANES];
        let (mut numbers, mut probabilities) = (LaneArray::ZERO, LaneArray::ZERO);
        random.store(&mut numbers, 0);
        for lane in lanes_of(wanted) {
            if let Some(choice) = self.choose_emitter(&mut numbers.0[lane]) {
                emitters[lane] = choice.emitter.0;
                probabilities.0[lane] = choice.probability;
            }
        }
        let (rest, probability) =
            (Lanes::load(simd, &numbers, 0), Lanes::load(simd, &probabilities, 0));
        Choices { emitters, probability, rest }
    }

    /// Light from the chosen emitters, in lanes where they support it and otherwise one by one.
    #[inline(always)]
    fn sample_in_lanes<S: Simd>(
        &self,
        simd: S,
        (reference, random): (Vector3<Lanes<S>>, Vector2<Lanes<S>>),
        wanted: LaneMask<S>,
        emitters: &[u32; MAX_LANES],
    ) -> LightLanes<Lanes<S>> {
        let mut batch = ParallelogramLightBatch::default();
        let (mut parallelograms, mut environments, mut meshes) = (0, 0, 0);
        for lane in lanes_of(wanted.bits()) {
            match &self.lane_emitters().0[emitters[lane] as usize] {
                LaneEmitter::Parallelogram(light) => {
                    batch.set(lane, light);
                    parallelograms |= 1 << lane;
                }
                LaneEmitter::ConstantEnvironment(radiance) => {
                    batch.set_radiance(lane, *radiance);
                    environments |= 1 << lane;
                }
                LaneEmitter::Mesh(_, radiance) => {
                    batch.set_radiance(lane, *radiance);
                    meshes |= 1 << lane;
                }
                LaneEmitter::Single => {}
            }
        }
        let lights = batch.load(simd);
        let mut place = lights.shape.light_point(random);
        if meshes != 0 {
            let points = self.points_of_meshes(simd, meshes, emitters, random);
            place = LightPoint::select(LaneMask::from_bits(simd, meshes), points, place);
        }
        let mut light = light_from(place, lights.radiance, reference);
        light.exists = light.exists & LaneMask::from_bits(simd, parallelograms | meshes);
        if environments != 0 {
            let everywhere = light_from_everywhere(light.radiance, random);
            let environments = LaneMask::from_bits(simd, environments);
            light = LightLanes::select(environments, everywhere, light);
        }
        let others = wanted.bits() & !(parallelograms | meshes | environments);
        if others == 0 {
            return light;
        }
        let mut places = Places::default();
        reference.store(&mut places.reference, 0);
        random.store(&mut places.random, 0);
        let mut lights = LightBatch::default();
        lights.store(&light);
        self.sample_others(others, emitters, &places, &mut lights);
        lights.load(simd)
    }

    /// Points on the emitting meshes of the lanes `meshes`.
    #[inline(always)]
    fn points_of_meshes<S: Simd>(
        &self,
        simd: S,
        meshes: u32,
        emitters: &[u32; MAX_LANES],
        random: Vector2<Lanes<S>>,
    ) -> LightPoint<Lanes<S>> {
        let mut batch = LightPointBatch::default();
        let mut numbers = [LaneArray::ZERO; 2];
        random.store(&mut numbers, 0);
        for lane in lanes_of(meshes) {
            if let LaneEmitter::Mesh(shape, _) = self.lane_emitters().0[emitters[lane] as usize]
                && let Geometry::Mesh(mesh) = &self.shape(shape).geometry
            {
                let random = numbers.each_ref().map(|column| column.0[lane]);
                batch.set(lane, mesh, random.into());
            }
        }
        batch.points(simd)
    }

    /// Light from the emitters of the lanes `others`, one by one.
    fn sample_others(
        &self,
        others: u32,
        emitters: &[u32; MAX_LANES],
        places: &Places,
        lights: &mut LightBatch,
    ) {
        for lane in lanes_of(others) {
            let emitter = &self.emitters()[emitters[lane] as usize];
            let (reference, random) = places.lane(lane);
            if let Some(light) = emitter.sample_direction(self, reference, random) {
                lights.set(lane, &light);
            }
        }
    }
}

/// The lanes whose bits are set, in order.
#[inline(always)]
fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < u32::BITS).then_some(lane as usize)
    })
}
