//! STUB
use super::Target;
use crate::interaction::SurfaceLanes;
use crate::scene::Scene;
use etendue_math::lanes::*;
use etendue_spectrum::SpectrumLanes;
use glam::Vec2;
pub struct LightLanes<R: Real> {
    pub direction: Vector3<R>,
    pub radiance: SpectrumLanes<R>,
    pub pdf: R,
    pub delta: R::Mask,
    pub exists: R::Mask,
    pub point: Vector3<R>,
    pub error: Vector3<R>,
    pub normal: Vector3<R>,
    pub afar: R::Mask,
}
impl Scene {
    #[inline(always)]
    pub fn sample_lights<S: Simd>(
        &self,
        simd: S,
        reference: Vector3<Lanes<S>>,
        random: Vector2<Lanes<S>>,
        wanted: LaneMask<S>,
    ) -> LightLanes<Lanes<S>> {
        let mut c = [LaneArray::ZERO; 16];
        let (mut e, mut de, mut af) = (0, 0, 0);
        for l in 0..Lanes::<S>::COUNT {
            if wanted.bits() >> l & 1 == 0 {
                continue;
            }
            let mut r = Vec2::new(random.x.lane(l), random.y.lane(l));
            let Some(ch) = self.choose_emitter(&mut r.x) else { continue };
            let Some(mut s) = self.emitter(ch.emitter).sample_direction(self, reference.lane(l), r)
            else {
                continue;
            };
            s.pdf *= ch.probability;
            e |= 1 << l;
            de |= u32::from(s.delta) << l;
            let (p, er, n) = match s.target {
                Target::Point { point, error, normal } => (point, error, normal),
                _ => {
                    af |= 1 << l;
                    (s.direction, s.direction, s.direction)
                }
            };
            let rgb = s.radiance.rgb();
            for (i, v) in [
                s.direction.x,
                s.direction.y,
                s.direction.z,
                rgb[0],
                rgb[1],
                rgb[2],
                s.pdf,
                p.x,
                p.y,
                p.z,
                er.x,
                er.y,
                er.z,
                n.x,
                n.y,
                n.z,
            ]
            .into_iter()
            .enumerate()
            {
                c[i].0[l] = v;
            }
        }
        let v = |i: usize| {
            Vector3::new(
                Lanes::load(simd, &c[i], 0),
                Lanes::load(simd, &c[i + 1], 0),
                Lanes::load(simd, &c[i + 2], 0),
            )
        };
        LightLanes {
            direction: v(0),
            radiance: SpectrumLanes::load(simd, &[c[3], c[4], c[5]], 0),
            pdf: Lanes::load(simd, &c[6], 0),
            delta: LaneMask::from_bits(simd, de),
            exists: LaneMask::from_bits(simd, e),
            point: v(7),
            error: v(10),
            normal: v(13),
            afar: LaneMask::from_bits(simd, af),
        }
    }
}
impl<R: Real> LightLanes<R> {
    #[inline(always)]
    pub fn shadow_rays(&self, s: &SurfaceLanes<R>) -> (Vector3<R>, Vector3<R>, R) {
        let origin = s.ray_origin(self.direction);
        let target =
            etendue_math::offset_origin_lanes(self.point, self.error, self.normal, -self.direction);
        let path = target - origin;
        let inf = path.x.like(f32::INFINITY);
        let d = Vector3::select(self.afar, self.direction, path);
        (origin, d, R::select(self.afar, inf, inf.like(1.0 - 2e-5)))
    }
}
