//! `area`: a shape that emits light.

use super::{DirectionSample, LaneEmitter, Light, RaySample, SAMPLING_WEIGHT, SceneView, Target};
use crate::builder::Builder;
use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{LightLanes, TargetLanes};
use crate::manual::{Manual, parameter};
use crate::models::mesh::{Glow, LightPoint, Mesh, Parallelogram, ParallelogramBatch};
use crate::shape::{Geometry, Shape, ShapeSample, area_to_solid_angle_lanes};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use crate::texture::{ColorSource, Texture};
use etendue_document::Parameters;
use etendue_math::lanes::{LaneArray, Lanes, Real, Simd, Vector2, Vector3};
use etendue_math::{Frame, Ray, offset_ray_origin};
use etendue_sampling::warp;
use etendue_spectrum::{Spectrum, SpectrumLanes, SpectrumUse};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Makes the shape that it is nested in a diffuse light: radiance leaves its front, the same \
              in all directions. A picture on a mesh is sampled in proportion to its light.",
    parameters: &[
        parameter(
            "radiance",
            "spectrum or texture",
            "1",
            "Radiance that leaves the surface, W·m⁻²·sr⁻¹.",
        ),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<shape type="sphere"><emitter type="area"><rgb name="radiance" value="5, 4, 3"/></emitter></shape>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[
        r#"<shape type="sphere"><point name="center" x="3" y="1" z="0"/><emitter type="area"/></shape>"#,
        r#"<shape type="sphere"><float name="radius" value="2"/><boolean name="flip_normals" value="true"/><emitter type="area"/></shape>"#,
        r#"<shape type="sphere"><point name="center" x="60" y="-40" z="9"/><float name="radius" value="20"/><emitter type="area"/></shape>"#,
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="150"/><translate x="0.5" z="1.5"/></transform><emitter type="area"/></shape>"#,
        r#"<shape type="disk"><transform name="to_world"><scale x="2" y="1" z="1"/><rotate x="1" angle="190"/><translate z="2"/></transform><emitter type="area"/></shape>"#,
        r#"<shape type="cylinder"><point name="p0" x="0" y="-2" z="0"/><point name="p1" x="0" y="3" z="1"/><float name="radius" value="1.5"/><boolean name="flip_normals" value="true"/><emitter type="area"/></shape>"#,
        r#"<shape type="revsurface"><curve type="bezier"><vec value="0, -1.5, 0"/><vec value="2, -1.5, 0"/><vec value="1.2, 1.5, 0"/><vec value="0, 1.5, 0"/></curve><transform name="to_world"><scale x="1" y="1" z="1.5"/><rotate x="1" angle="60"/></transform><emitter type="area"/></shape>"#,
        r#"<shape type="cube"><transform name="to_world"><scale x="1" y="2" z="1.5"/></transform><boolean name="flip_normals" value="true"/><emitter type="area"/></shape>"#,
        r#"<shape type="rectangle"><transform name="to_world"><scale x="2"/><rotate x="1" angle="150"/><translate x="0.5" z="1.5"/></transform><emitter type="area"><texture name="radiance" type="bitmap"><string name="filename" value="sky.exr"/></texture></emitter></shape>"#,
        r#"<shape type="cube"><boolean name="flip_normals" value="true"/><emitter type="area"><texture name="radiance" type="bitmap"><string name="filename" value="sky.exr"/><transform name="to_uv"><scale value="2"/></transform></texture></emitter></shape>"#,
    ],
    leaving: &[
        r#"<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="170"/><translate z="1"/></transform><emitter type="area"><texture name="radiance" type="bitmap"><string name="filename" value="slide.exr"/></texture></emitter></shape>"#,
        r#"<shape type="sphere"><point name="center" x="0" y="0" z="1"/><emitter type="area"/></shape>"#,
    ],
    extreme: &[
        r#"<shape type="sphere"><float name="radius" value="1e-12"/><emitter type="area"><rgb name="radiance" value="1e30, 0, 0"/></emitter></shape>"#,
        r#"<shape type="rectangle"><transform name="to_world"><scale x="1e-10" y="1e10"/></transform><emitter type="area"/></shape>"#,
    ],
};

/// A shape that emits light.
#[derive(Clone, Debug)]
pub struct Area {
    shape: ShapeId,
    radiance: ColorSource,
}

/// Reads an area emitter for `shape`.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>, shape: ShapeId) -> Area {
    Area { shape, radiance: builder.color(parameters, "radiance", 1.0, SpectrumUse::Emission) }
}

/// The unit direction from `reference` to a point of a light with this shading normal, and whether
/// light comes from there. False on the back of the light and where the points coincide.
#[inline(always)]
fn towards<R: Real>(
    reference: Vector3<R>,
    point: Vector3<R>,
    shading_normal: Vector3<R>,
) -> (Vector3<R>, R::Mask) {
    let (direction, exists) = (point - reference).try_normalize();
    let cosine = direction.dot(shading_normal);
    (direction, exists & !cosine.ge(cosine.zero()))
}

/// The light from a sampled point; see [`Light::sample_direction`] of [`Area`].
#[inline(always)]
pub(crate) fn light_from<R: Real>(
    place: LightPoint<R>,
    radiance: SpectrumLanes<R>,
    reference: Vector3<R>,
) -> LightLanes<R> {
    let LightPoint { point, error, normal, shading_normal, pdf } = place;
    let (pdf, visible) = area_to_solid_angle_lanes(pdf, point - reference, normal);
    let (direction, shines) = towards(reference, point, shading_normal);
    let never = visible & !visible;
    LightLanes {
        direction,
        radiance,
        pdf,
        delta: never,
        exists: visible & shines,
        target: TargetLanes { point, error, normal, afar: never },
    }
}

/// A parallelogram of constant radiance, or one per lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ParallelogramLight<R> {
    pub(crate) shape: Parallelogram<R>,
    pub(crate) radiance: SpectrumLanes<R>,
}

impl<R: Real> ParallelogramLight<R> {
    /// See [`Light::sample_direction`] of [`Area`].
    #[inline(always)]
    pub(crate) fn sample_direction(
        &self,
        reference: Vector3<R>,
        random: Vector2<R>,
    ) -> LightLanes<R> {
        light_from(self.shape.light_point(random), self.radiance, reference)
    }
}

impl ParallelogramLight<f32> {
    /// The same parallelogram in all lanes.
    #[inline(always)]
    pub(crate) fn splat<S: Simd>(&self, simd: S) -> ParallelogramLight<Lanes<S>> {
        ParallelogramLight {
            shape: self.shape.splat(simd),
            radiance: SpectrumLanes::splat(simd, self.radiance.into()),
        }
    }
}

/// One parallelogram light per lane, in columns.
#[derive(Debug, Default)]
pub(crate) struct ParallelogramLightBatch {
    shape: ParallelogramBatch,
    radiance: [LaneArray; Spectrum::LANES],
}

impl ParallelogramLightBatch {
    /// Sets the light of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, light: &ParallelogramLight<f32>) {
        self.shape.set(lane, &light.shape);
        self.set_radiance(lane, light.radiance.into());
    }

    /// Sets the radiance of a lane that has no parallelogram.
    #[inline(always)]
    pub(crate) fn set_radiance(&mut self, lane: usize, radiance: Spectrum) {
        SpectrumLanes::from(radiance).put(&mut self.radiance, lane);
    }

    /// The lights of the first lanes.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S) -> ParallelogramLight<Lanes<S>> {
        ParallelogramLight {
            shape: self.shape.load(simd),
            radiance: SpectrumLanes::load(simd, &self.radiance, 0),
        }
    }
}

impl Area {
    /// Makes points on the light's mesh follow its texture, if the radiance has one.
    pub(crate) fn let_follow(&self, mesh: &mut Mesh, textures: &[Texture]) {
        let ColorSource::Texture(id) = self.radiance else { return };
        if let Texture::Bitmap(picture) = &textures[id.index()] {
            let luminance = |uv: Vec2| picture.eval(uv).luminance();
            mesh.follow(Glow { luminance: &luminance, resolution: picture.resolution() });
        }
    }
}

impl Light for Area {
    fn is_black(&self) -> bool {
        self.radiance.is_black()
    }

    #[inline(always)]
    fn sample_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample> {
        let sample = scene.shape(self.shape).sample_direction(reference, random)?;
        let (point, shading_normal) = (sample.point.into(), sample.shading_normal.into());
        let (direction, shines) = towards(reference.into(), point, shading_normal);
        if !shines {
            return None;
        }
        let direction = Vec3::from(direction);
        let radiance = match self.radiance {
            ColorSource::Constant(radiance) => radiance,
            ColorSource::Texture(_) => {
                let surface = sample.interaction(self.shape, -direction);
                self.radiance.eval(scene.textures(), &surface)
            }
        };
        Some(DirectionSample {
            direction,
            radiance,
            pdf: sample.pdf,
            delta: false,
            target: Target::Point {
                point: sample.point,
                error: sample.error,
                normal: sample.normal,
            },
        })
    }

    #[inline]
    fn pdf_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        _direction: Vec3,
        surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        surface.map_or(0.0, |surface| scene.shape(self.shape).pdf_direction(reference, surface))
    }

    /// Zero on the back.
    #[inline]
    fn surface_radiance(&self, scene: &impl SceneView, surface: &SurfaceInteraction) -> Spectrum {
        if surface.wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        self.radiance.eval(scene.textures(), surface)
    }

    fn sample_ray(
        &self,
        scene: &impl SceneView,
        place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        let sample = scene.shape(self.shape).sample_area(place)?;
        let local = warp::cosine_hemisphere::sample(direction);
        let direction = Frame::from_normal(sample.front()).to_world(local);
        ray_from_shape(scene, (self.shape, &sample), self.radiance, (direction, PI))
    }

    fn in_lanes(&self, shapes: &[Shape]) -> LaneEmitter {
        let ColorSource::Constant(radiance) = self.radiance else { return LaneEmitter::Single };
        let Geometry::Mesh(mesh) = &shapes[self.shape.index()].geometry else {
            return LaneEmitter::Single;
        };
        match mesh.parallelogram() {
            Some(flat) => LaneEmitter::Parallelogram(ParallelogramLight {
                shape: *flat,
                radiance: radiance.into(),
            }),
            None if mesh.chooses_triangles() => LaneEmitter::Mesh(self.shape, radiance),
            None => LaneEmitter::Single,
        }
    }
}

/// Light that leaves a point sampled by area on a shape. The density of its direction is the cosine
/// divided by `factor`; for a single direction, it is 1 / `factor`.
pub(super) fn ray_from_shape(
    scene: &impl SceneView,
    (shape, sample): (ShapeId, &ShapeSample),
    color: ColorSource,
    (direction, factor): (Vec3, f32),
) -> Option<RaySample> {
    if direction.dot(sample.shading_normal) <= 0.0 || sample.pdf <= 0.0 {
        return None;
    }
    let color = color.eval(scene.textures(), &sample.interaction(shape, direction));
    let origin = offset_ray_origin(sample.point, sample.error, sample.normal, direction);
    let power = color * (factor / sample.pdf);
    (!color.is_black()).then_some(RaySample { ray: Ray::new(origin, direction), power })
}
