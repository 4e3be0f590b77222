//! Triangulation of polygons.

use glam::{DVec2, DVec3, Vec3};

/// Polygons with more corners than this are always split as a fan: ear clipping takes quadratic
/// time, and a file may contain millions of corners.
const MAX_CORNERS_TO_CLIP: usize = 128;

/// Splits a polygon into triangles.
///
/// A polygon is split as a fan around the first corner, as in Mitsuba and most exporters, if every
/// triangle of the fan has the orientation of the whole polygon. Otherwise it is concave and the
/// fan would extend outside it. Then it is split by ear clipping (Meisters, "Polygons Have Ears",
/// 1975), in the coordinate plane where its area (by Newell's method) is largest. A
/// self-intersecting polygon without ears is split as a fan.
///
/// A polygon of n corners gives n − 2 triangles of the same orientation; fewer than three corners
/// give none.
pub(crate) fn triangulate(
    corners: &[u32],
    position_of: impl Fn(u32) -> Option<Vec3>,
    triangles: &mut Vec<[u32; 3]>,
) {
    if let &[a, b, c] = corners {
        triangles.push([a, b, c]);
    } else if corners.len() > 3 {
        triangulate_many(corners, position_of, triangles);
    }
}

fn triangulate_many(
    corners: &[u32],
    position_of: impl Fn(u32) -> Option<Vec3>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let fan = corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]);
    let place = |corner: u32| position_of(corner).map(Vec3::as_dvec3);
    if corners.len() <= MAX_CORNERS_TO_CLIP && !is_fan_valid(corners, place) {
        // Only concave polygons allocate, and they are rare.
        let places: Option<Vec<DVec3>> = corners.iter().map(|&corner| place(corner)).collect();
        if let Some(ears) = places.and_then(|places| clip_ears(&project(&places))) {
            triangles.extend(ears.into_iter().map(|ear| ear.map(|index| corners[index])));
            return;
        }
    }
    triangles.extend(fan);
}

/// Whether every triangle of the fan has the orientation of the polygon. True if positions are
/// unknown.
fn is_fan_valid(corners: &[u32], place: impl Fn(u32) -> Option<DVec3>) -> bool {
    let Some(apex) = place(corners[0]) else {
        return true;
    };
    let area = |pair: &[u32]| match (place(pair[0]), place(pair[1])) {
        (Some(b), Some(c)) => (b - apex).cross(c - apex),
        _ => DVec3::ZERO,
    };
    let total: DVec3 = corners[1..].windows(2).map(area).sum();
    corners[1..].windows(2).all(|pair| area(pair).dot(total) >= 0.0)
}

/// Projects the corners to the coordinate plane where the area of the polygon is largest, oriented
/// counter-clockwise.
fn project(places: &[DVec3]) -> Vec<DVec2> {
    let apex = places[0];
    let area: DVec3 = places.windows(2).map(|pair| (pair[0] - apex).cross(pair[1] - apex)).sum();
    let (axis, _) = (0..3)
        .map(|axis| (axis, area[axis].abs()))
        .fold((0, f64::NEG_INFINITY), |best, next| if next.1 > best.1 { next } else { best });
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let (first, second) = if area[axis] < 0.0 { (second, first) } else { (first, second) };
    places.iter().map(|place| DVec2::new(place[first], place[second])).collect()
}

/// Clips the ears of a counter-clockwise polygon until a triangle is left. `None` if there is no
/// ear, or if the search takes longer than for any simple polygon.
fn clip_ears(polygon: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..polygon.len()).collect();
    let mut ears = Vec::with_capacity(polygon.len() - 2);
    let mut candidates = 4 * polygon.len();
    let mut place = 0;
    while left.len() > 3 {
        candidates = candidates.checked_sub(1)?;
        let count = left.len();
        let middle = place % count;
        let ear = [left[(middle + count - 1) % count], left[middle], left[(middle + 1) % count]];
        if is_ear(polygon, &left, ear) {
            ears.push(ear);
            left.remove(middle);
        }
        place = middle + 1;
    }
    ears.push([left[0], left[1], left[2]]);
    Some(ears)
}

/// Whether the triangle `ear` of consecutive corners has no negative area and contains no other
/// corner.
fn is_ear(polygon: &[DVec2], left: &[usize], ear: [usize; 3]) -> bool {
    let [a, b, c] = ear.map(|index| polygon[index]);
    let side = |from: DVec2, to: DVec2, point: DVec2| (to - from).perp_dot(point - from);
    let area = side(a, b, c);
    let contains = |point: DVec2| {
        side(a, b, point) >= 0.0 && side(b, c, point) >= 0.0 && side(c, a, point) >= 0.0
    };
    // A corner at the same position as a corner of the ear does not obstruct it: holes are written
    // with two copies of a bridge.
    let obstructs = |point: DVec2| ![a, b, c].contains(&point) && contains(point);
    area == 0.0 || (area > 0.0 && !left.iter().any(|&index| obstructs(polygon[index])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn split(places: &[Vec3]) -> Vec<[u32; 3]> {
        let corners: Vec<u32> = (0..places.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&corners, |corner| places.get(corner as usize).copied(), &mut triangles);
        triangles
    }

    fn areas(places: &[Vec3]) -> Vec<Vec3> {
        let area = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a);
        split(places).into_iter().map(|face| area(face.map(|i| places[i as usize]))).collect()
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        assert_eq!(split(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(split(&square[..3]), [[0, 1, 2]]);
        assert_eq!(split(&square[..2]), [] as [[u32; 3]; 0]);
        let mut triangles = Vec::new();
        triangulate(&[5, 6, 7, 8], |_| None, &mut triangles);
        assert_eq!(triangles, [[5, 6, 7], [5, 7, 8]]);
    }

    #[test]
    fn a_concave_quadrilateral_is_covered_once_from_any_first_corner() {
        // Area 1/2 · (3·2 − 3·1) = 1.5, in any of three planes and both orientations.
        let arrow = [(0.0, 2.0), (-1.5, -1.0), (0.0, 0.0), (1.5, -1.0)];
        for start in 0..4 {
            for axis in 0..3 {
                let place = |corner: usize| {
                    let (x, y) = arrow[(corner + start) % 4];
                    let mut place = [0.25_f32; 3];
                    (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (x, y);
                    Vec3::from_array(place)
                };
                let mut places: Vec<Vec3> = (0..4).map(place).collect();
                for sign in [1.0, -1.0] {
                    for area in areas(&places) {
                        assert!(area[axis] * sign > 0.0, "{start} {axis} {area}");
                    }
                    let total: Vec3 = areas(&places).into_iter().sum();
                    assert_eq!(total[axis] * sign, 3.0);
                    places.reverse();
                }
            }
        }
    }

    #[test]
    fn a_square_with_a_bridged_hole_keeps_its_hole() {
        let outline =
            [(0, 0), (6, 0), (6, 6), (0, 6), (0, 0), (2, 2), (2, 4), (4, 4), (4, 2), (2, 2)];
        let places = outline.map(|(x, y)| Vec3::new(x as f32, y as f32, 1.0));
        let areas = areas(&places);
        assert_eq!(areas.len(), 8);
        assert!(areas.iter().all(|area| area.z >= 0.0));
        assert_eq!(areas.iter().map(|area| area.z).sum::<f32>(), 32.0);
    }

    #[test]
    fn self_intersecting_and_degenerate_polygons_give_n_minus_two_triangles() {
        let bow = [Vec3::ZERO, Vec3::ONE, Vec3::X, Vec3::Y, Vec3::new(0.3, -2.0, 0.0)];
        assert_eq!(split(&bow).len(), 3);
        assert_eq!(split(&[Vec3::ONE; 9]).len(), 7);
        let spiral: Vec<Vec3> = (0..2000)
            .map(|i| {
                let turn = i as f32 * 2.4;
                Vec3::new(turn.cos(), turn.sin(), 0.0) * i as f32
            })
            .collect();
        assert_eq!(split(&spiral).len(), 1998);
        assert_eq!(split(&spiral[..MAX_CORNERS_TO_CLIP]).len(), MAX_CORNERS_TO_CLIP - 2);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The triangles of a star-shaped polygon cover it once: their areas have the same sign and
        /// add up to that of the shoelace formula.
        #[test]
        fn stars_are_covered_once(radii in prop::collection::vec(0.1_f32..1.0, 5..40)) {
            let step = std::f32::consts::TAU / radii.len() as f32;
            let place = |(corner, radius): (usize, &f32)| {
                let (sin, cos) = (corner as f32 * step).sin_cos();
                Vec3::new(cos * radius, 0.5, sin * radius)
            };
            let places: Vec<Vec3> = radii.iter().enumerate().map(place).collect();
            let shoelace: f32 = (0..places.len())
                .map(|i| places[i].cross(places[(i + 1) % places.len()]).y * 0.5)
                .sum();
            let areas = areas(&places);
            prop_assert_eq!(areas.len(), places.len() - 2);
            prop_assert!(areas.iter().all(|area| area.y <= 1e-7));
            let sum: f32 = areas.iter().map(|area| area.y).sum();
            prop_assert!((sum - shoelace).abs() < 1e-5, "{} {}", sum, shoelace);
        }
    }
}
