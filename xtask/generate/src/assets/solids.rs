//! Signed distances to simple solids and ways to join them, as collected by Inigo Quilez
//! ("Distance functions").

use glam::{DVec2, DVec3};

/// A box around the origin with rounded edges.
pub(super) fn rounded_box(place: DVec3, half_size: DVec3, radius: f64) -> f64 {
    let outside = place.abs() - half_size + radius;
    outside.max(DVec3::ZERO).length() + outside.max_element().min(0.0) - radius
}

/// A plane figure, given by its distance, extruded by `half_height` to both sides, with rounded
/// edges. `height` is the place along the extrusion.
pub(super) fn extrude(figure: f64, height: f64, half_height: f64, radius: f64) -> f64 {
    let outside = DVec2::new(figure, height.abs() - half_height) + radius;
    outside.max(DVec2::ZERO).length() + outside.max_element().min(0.0) - radius
}

/// The union of two solids, rounded where they meet.
pub(super) fn smooth_union(a: f64, b: f64, width: f64) -> f64 {
    let overlap = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - overlap * overlap * width * 0.25
}

/// The first solid without the second, rounded where they meet.
pub(super) fn smooth_difference(a: f64, b: f64, width: f64) -> f64 {
    -smooth_union(-a, b, width)
}

/// A polygon; its inside is negative.
pub(super) fn polygon(place: DVec2, corners: &[DVec2]) -> f64 {
    let mut squared = f64::INFINITY;
    let mut is_inside = false;
    let mut previous = corners[corners.len() - 1];
    for &corner in corners {
        let (edge, to_place) = (previous - corner, place - corner);
        let along = (to_place.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        squared = squared.min((to_place - edge * along).length_squared());
        let crosses = (corner.y > place.y) != (previous.y > place.y);
        if crosses && (to_place.perp_dot(edge) < 0.0) == (edge.y < 0.0) {
            is_inside = !is_inside;
        }
        previous = corner;
    }
    if is_inside { -squared.sqrt() } else { squared.sqrt() }
}

/// A polygon with its corners cut twice (Chaikin's algorithm).
pub(super) fn rounded_corners(corners: &[DVec2]) -> Vec<DVec2> {
    let mut rounded = corners.to_vec();
    for _ in 0..2 {
        let next = |index: usize| rounded[(index + 1) % rounded.len()];
        rounded = (0..rounded.len())
            .flat_map(|index| {
                let (here, there) = (rounded[index], next(index));
                [here.lerp(there, 0.25), here.lerp(there, 0.75)]
            })
            .collect();
    }
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_square_are_those_to_its_nearest_edge() {
        let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(DVec2::from);
        assert_eq!(polygon(DVec2::new(0.25, 0.0), &square), -0.75);
        assert_eq!(polygon(DVec2::new(3.0, 0.5), &square), 2.0);
        assert_eq!(polygon(DVec2::new(4.0, 5.0), &square), 5.0);
        assert_eq!(rounded_box(DVec3::new(3.0, 0.0, 0.0), DVec3::ONE, 0.2), 2.0);
        assert!((extrude(-0.5, 1.5, 1.0, 0.1) - 0.5).abs() < 1e-12);
    }
}
