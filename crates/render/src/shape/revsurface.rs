//! `revsurface`: a profile turned about the y axis.

use super::mesh::{Mesh, MeshOptions};
use super::profile::{self, Segment};
use crate::builder::read_transform;
use crate::manual::{Manual, parameter};
use etendue_document::{Class, Fault, Parameters};
use etendue_mesh::TriangleMesh;
use glam::{DVec2, Vec2, Vec3};
use std::f64::consts::TAU;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A surface of revolution: a profile in the (x, y) plane turned about the y axis. The profile \
              is a nested `<curve type=\"Bspline\">` (uniform, cubic) or `<curve type=\"bezier\">` (3n + 1 \
              points) of `<vec>`s, whose z is ignored; x may have either sign. Seen along the profile, the \
              front is on the left.",
    parameters: &[
        parameter("curve", "curve", "", "The profile."),
        parameter("flip_normals", "boolean", "false", "Turn front and back around."),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="revsurface"><curve type="bezier"><vec value="1, 0, 0"/><vec value="0.5, 0.5, 0"/><vec value="0.5, 1, 0"/><vec value="1, 2, 0"/></curve></shape>"#,
};

/// How far a facet may lie from the surface, relative to the profile's size.
const TOLERANCE: f64 = 2e-5;
/// Steps around the axis: the sagitta of a facet is π²/2/steps² of the radius.
const STEPS_AROUND: u32 = 512;
/// More control points than anybody draws.
const MAX_SEGMENTS: usize = 10_000;
/// Steps along one segment at most.
const MAX_STEPS_ALONG: f64 = 64.0;

/// Reads a surface of revolution as a fine mesh with exact normals at its vertices.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<Mesh> {
    let flip_normals = parameters.boolean("flip_normals", false);
    let segments = read_profile(parameters);
    let to_world = read_transform(parameters, "to_world")?;
    let mesh = tessellate(&segments?);
    Mesh::new(mesh, &MeshOptions::placement(to_world, flip_normals)).ok()
}

fn read_profile(parameters: &Parameters<'_>) -> Option<Vec<Segment>> {
    let Some(curve) = parameters.unnamed_child(Class::Curve) else {
        parameters.error(
            Fault::MissingParameter,
            "curve",
            "a surface of revolution needs a `<curve>`",
        );
        return None;
    };
    let curve = parameters.document().parameters(curve.node, parameters.diagnostics());
    let points: Vec<DVec2> = curve.points("points").iter().map(|p| p.truncate()).collect();
    let segments = match curve.plugin().to_ascii_lowercase().as_str() {
        "bspline" => Some(profile::from_b_spline(&points)).filter(|segments| !segments.is_empty()),
        "bezier" => profile::from_bezier(&points),
        other => {
            let message = format!("unknown curve type `{other}`: there are `Bspline` and `bezier`");
            curve.error(Fault::UnknownPlugin, "points", message);
            return None;
        }
    };
    let finite = points.iter().all(|p| p.is_finite() && p.abs().max_element() < 1e18);
    let usable = segments.filter(|segments| segments.len() <= MAX_SEGMENTS && finite);
    if usable.is_none() {
        let message = format!(
            "{} finite points do not make a profile: a B-spline takes 4 or more, a Bézier chain 3n + 1",
            points.len()
        );
        curve.error(Fault::BadValue, "points", message);
    }
    curve.finish();
    usable
}

/// A ring of vertices: a point of the profile with its tangent and its v coordinate.
struct Ring {
    point: DVec2,
    tangent: DVec2,
    v: f64,
}

fn tessellate(segments: &[Segment]) -> TriangleMesh {
    let rings = rings(segments);
    let mut mesh = TriangleMesh { name: "revsurface".to_owned(), ..TriangleMesh::default() };
    for ring in &rings {
        // One vertex more than steps: the seam has two coordinates at the same position.
        for step in 0..=STEPS_AROUND {
            let u = f64::from(step) / f64::from(STEPS_AROUND);
            let (sin, cos) =
                (TAU * f64::from(step % STEPS_AROUND) / f64::from(STEPS_AROUND)).sin_cos();
            let turned = |p: DVec2| Vec3::new((p.x * cos) as f32, p.y as f32, (p.x * sin) as f32);
            mesh.positions.push(turned(ring.point));
            mesh.normals.push(turned(DVec2::new(-ring.tangent.y, ring.tangent.x)));
            mesh.uvs.push(Vec2::new(u as f32, ring.v as f32));
        }
    }
    for ring in 1..rings.len() as u32 {
        for step in 0..STEPS_AROUND {
            let (below, above) =
                ((ring - 1) * (STEPS_AROUND + 1) + step, ring * (STEPS_AROUND + 1) + step);
            mesh.indices.push([above, below + 1, below]);
            mesh.indices.push([above, above + 1, below + 1]);
        }
    }
    mesh
}

/// Points along the profile, closer where it bends.
fn rings(segments: &[Segment]) -> Vec<Ring> {
    let size = segments.iter().flatten().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let count = segments.len() as f64;
    let mut rings = Vec::new();
    for (index, segment) in segments.iter().enumerate() {
        // The chord of a step h lies at most h²/8·max|p''| from the curve, and |p''| ≤ 6 times the
        // largest second difference of the control points (Farin, Curves and Surfaces for CAGD, 4.5).
        let [a, b, c, d] = *segment;
        let bend = (a - b * 2.0 + c).length().max((b - c * 2.0 + d).length());
        let steps = (0.75 * bend / (TOLERANCE * size)).sqrt().ceil().clamp(1.0, MAX_STEPS_ALONG);
        let last = index + 1 == segments.len();
        for step in 0..steps as usize + usize::from(last) {
            let s = step as f64 / steps;
            let v = (index as f64 + s) / count;
            rings.push(Ring {
                point: profile::point(segment, s),
                tangent: profile::tangent(segment, s),
                v,
            });
        }
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_profile_is_a_cylinder() {
        let line = |y: f64| DVec2::new(2.0, y);
        let mesh = tessellate(&[[line(0.0), line(1.0), line(2.0), line(3.0)]]);
        let area = mesh.surface_area();
        assert!((area / (TAU * 2.0 * 3.0) - 1.0).abs() < 1e-4, "{area}");
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            // Upwards along the profile, the left is towards the axis.
            let inwards = -Vec3::new(position.x, 0.0, position.z) / 2.0;
            assert!((*normal - inwards).length() < 1e-6);
        }
    }

    #[test]
    fn facets_face_where_the_normals_point() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let mesh = tessellate(&[[p(-1.0, 0.0), p(-2.0, 1.0), p(-0.5, 2.0), p(-1.0, 3.0)]]);
        for triangle in &mesh.indices {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(mesh.normals[triangle[0] as usize]) > 0.0, "{triangle:?}");
        }
    }
}
