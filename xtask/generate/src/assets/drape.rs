//! A square of cloth that falls over a round pedestal.

use etendue::mesh::TriangleMesh;
use glam::{DVec2, DVec3};

use super::noise::value;
use super::patch::{self, round};

/// Threads along each side; the cloth has as many points, and its texture repeats once a unit.
const SIDE: usize = 190;
const WIDTH: f64 = 4.3;
const SPACING: f64 = WIDTH / (SIDE - 1) as f64;

/// The pedestal stands on y = 0, with a rounded edge at its top.
const RADIUS: f64 = 0.78;
const HEIGHT: f64 = 2.1;
const EDGE: f64 = 0.10;

/// Half of the cloth's thickness, which keeps it apart from what it lies on.
const CLEARANCE: f64 = 0.012;

/// The cloth at rest.
pub(super) fn cloth() -> Vec<u8> {
    let mut cloth = Cloth::new();
    for _ in 0..900 {
        cloth.step();
    }
    patch::file(&cloth.mesh())
}

/// Points that keep their distances from each other.
///
/// Position-based dynamics (Müller et al. 2007): points move freely, and are then moved to satisfy
/// the constraints, one after the other. Only additions, multiplications and square roots are
/// used, so that the cloth is the same on every machine.
struct Cloth {
    places: Vec<DVec3>,
    previous: Vec<DVec3>,
    constraints: Vec<Constraint>,
}

struct Constraint {
    points: [usize; 2],
    length: f64,
    /// Which part of the error is corrected each time: low for bending.
    stiffness: f64,
}

impl Cloth {
    fn new() -> Self {
        let place = |index: usize| {
            let [x, z] = [index % SIDE, index / SIDE].map(|at| at as f64 * SPACING - WIDTH / 2.0);
            // Turned a little, and not quite flat, as if let go by hand.
            let wave = value(x * 1.3 + 9.0, z * 1.3 + 9.0, 64, 3) - 0.5;
            let turned = DVec2::new(x, z).rotate(DVec2::new(0.92, 0.392));
            DVec3::new(turned.x + 0.05, HEIGHT + 0.1 + 0.12 * wave, turned.y - 0.04)
        };
        let places: Vec<DVec3> = (0..SIDE * SIDE).map(place).collect();
        Self { previous: places.clone(), places, constraints: constraints() }
    }

    fn step(&mut self) {
        const GRAVITY: DVec3 = DVec3::new(0.0, -0.000_22, 0.0);
        const DAMPING: f64 = 0.985;
        for (place, previous) in self.places.iter_mut().zip(&mut self.previous) {
            let next = *place + (*place - *previous) * DAMPING + GRAVITY;
            *previous = *place;
            *place = next;
        }
        for _ in 0..14 {
            for constraint in &self.constraints {
                let [a, b] = constraint.points;
                let apart = self.places[b] - self.places[a];
                let length = apart.length().max(1e-9);
                let error = apart * ((1.0 - constraint.length / length) * constraint.stiffness);
                self.places[a] += error * 0.5;
                self.places[b] -= error * 0.5;
            }
        }
        for (place, previous) in self.places.iter_mut().zip(&mut self.previous) {
            if let Some(outside) = pushed_out(*place) {
                // Friction: what touches something slows down.
                *previous = previous.lerp(outside, 0.7);
                *place = outside;
            }
        }
    }

    fn mesh(&self) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        let at = |column: usize, row: usize| self.places[row * SIDE + column];
        for row in 0..SIDE {
            for column in 0..SIDE {
                let (left, right) = (column.saturating_sub(1), (column + 1).min(SIDE - 1));
                let (back, front) = (row.saturating_sub(1), (row + 1).min(SIDE - 1));
                let along = at(right, row) - at(left, row);
                let across = at(column, front) - at(column, back);
                mesh.positions.push(round(at(column, row)));
                mesh.normals.push(round(across.cross(along).normalize_or(DVec3::Y)));
                let uv = DVec2::new(column as f64, row as f64) * SPACING;
                mesh.uvs.push(uv.as_vec2());
            }
        }
        for row in 0..SIDE - 1 {
            for column in 0..SIDE - 1 {
                let corner = |x: usize, y: usize| ((row + y) * SIDE + column + x) as u32;
                let [a, b, c, d] = [corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)];
                mesh.indices.extend([[a, b, c], [a, c, d]]);
            }
        }
        mesh
    }
}

/// Threads, diagonals against shear, and every other point along threads against bending.
fn constraints() -> Vec<Constraint> {
    const LINKS: [(usize, usize, f64); 4] = [(1, 0, 1.0), (1, 1, 0.35), (2, 0, 0.16), (5, 0, 0.02)];
    let mut all = Vec::new();
    for (along, across, stiffness) in LINKS {
        let length = SPACING * ((along * along + across * across) as f64).sqrt();
        for row in 0..SIDE {
            for column in 0..SIDE {
                let mut link = |from: [usize; 2], to: [usize; 2]| {
                    if from.iter().chain(&to).all(|at| *at < SIDE) {
                        let points = [from, to].map(|[x, y]| y * SIDE + x);
                        all.push(Constraint { points, length, stiffness });
                    }
                };
                link([column, row], [column + along, row + across]);
                link([column + across, row], [column, row + along]);
            }
        }
    }
    all
}

/// The nearest place outside the pedestal and the floor, if this one is inside.
fn pushed_out(place: DVec3) -> Option<DVec3> {
    if place.y < CLEARANCE {
        return Some(place.with_y(CLEARANCE));
    }
    let from_axis = DVec2::new(place.x, place.z).length();
    let profile = DVec2::new(from_axis - (RADIUS - EDGE), place.y - (HEIGHT - EDGE));
    let outside = profile.max(DVec2::ZERO);
    let distance = outside.length() + profile.max_element().min(0.0) - EDGE - CLEARANCE;
    if distance >= 0.0 {
        return None;
    }
    let direction = match (profile.x > 0.0, profile.y > 0.0) {
        (true, true) => outside.normalize(),
        _ if profile.x > profile.y => DVec2::X,
        _ => DVec2::Y,
    };
    let radial = DVec3::new(place.x, 0.0, place.z).normalize_or(DVec3::X);
    Some(place + (radial * direction.x + DVec3::Y * direction.y) * -distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_stays_inside_the_pedestal() {
        for place in
            [DVec3::new(0.1, 1.0, 0.2), DVec3::new(0.3, 2.05, -0.3), DVec3::new(0.75, 2.08, 0.0)]
        {
            let outside = pushed_out(place).unwrap();
            assert!(
                pushed_out(outside + DVec3::Y * 1e-9)
                    .is_none_or(|again| again.distance(outside) < 1e-6)
            );
        }
        assert_eq!(pushed_out(DVec3::new(2.0, 1.0, 0.0)), None);
    }
}
