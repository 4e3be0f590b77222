//! Light in memory, for work done lane by lane.

use crate::emitter::{DirectionSample, Target};
use crate::lanes::{LightLanes, TargetLanes};
use etendue_math::lanes::{LaneArray, LaneMask, Lanes, Mask as _, Simd, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::{Vec2, Vec3};

/// The points that light is sampled for, and their random numbers.
#[derive(Default)]
pub(crate) struct Places {
    pub(crate) reference: [LaneArray; 3],
    pub(crate) random: [LaneArray; 2],
}

impl Places {
    pub(crate) fn lane(&self, lane: usize) -> (Vec3, Vec2) {
        (
            Vector3::take(&self.reference, lane).into(),
            self.random.each_ref().map(|column| column.0[lane]).into(),
        )
    }
}

/// [`LightLanes`] in memory, initially without light.
#[derive(Default)]
pub(crate) struct LightBatch {
    direction: [LaneArray; 3],
    radiance: [LaneArray; Spectrum::LANES],
    pdf: LaneArray,
    point: [LaneArray; 3],
    error: [LaneArray; 3],
    normal: [LaneArray; 3],
    /// A bit for each lane; so are the other masks.
    delta: u32,
    exists: u32,
    afar: u32,
}

impl LightBatch {
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, light: &LightLanes<Lanes<S>>) {
        light.direction.store(&mut self.direction, 0);
        light.radiance.store(&mut self.radiance, 0);
        light.pdf.store(&mut self.pdf, 0);
        light.target.point.store(&mut self.point, 0);
        light.target.error.store(&mut self.error, 0);
        light.target.normal.store(&mut self.normal, 0);
        self.delta = light.delta.bits();
        self.exists = light.exists.bits();
        self.afar = light.target.afar.bits();
    }

    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S) -> LightLanes<Lanes<S>> {
        LightLanes {
            direction: Vector3::load(simd, &self.direction, 0),
            radiance: SpectrumLanes::load(simd, &self.radiance, 0),
            pdf: Lanes::load(simd, &self.pdf, 0),
            delta: LaneMask::from_bits(simd, self.delta),
            exists: LaneMask::from_bits(simd, self.exists),
            target: TargetLanes {
                point: Vector3::load(simd, &self.point, 0),
                error: Vector3::load(simd, &self.error, 0),
                normal: Vector3::load(simd, &self.normal, 0),
                afar: LaneMask::from_bits(simd, self.afar),
            },
        }
    }

    /// Stores light in a lane that has none yet.
    pub(crate) fn set(&mut self, lane: usize, light: &DirectionSample) {
        Vector3::from(light.direction).put(&mut self.direction, lane);
        SpectrumLanes::from(light.radiance).put(&mut self.radiance, lane);
        self.pdf.0[lane] = light.pdf;
        let bit = 1 << lane;
        self.exists |= bit;
        if light.delta {
            self.delta |= bit;
        }
        match light.target {
            Target::Afar => self.afar |= bit,
            Target::Point { point, error, normal } => {
                Vector3::from(point).put(&mut self.point, lane);
                Vector3::from(error).put(&mut self.error, lane);
                Vector3::from(normal).put(&mut self.normal, lane);
            }
        }
    }
}
