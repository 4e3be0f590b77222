//! Tests that run on every material, over the configurations in its file.

mod energy;
mod hostile;
mod mitsuba;
mod statistics;

use glam::{Vec2, Vec3};

/// Incident directions on both sides: along the normal, at 45° and at 85°.
fn incident() -> impl Iterator<Item = Vec3> {
    let at = |degrees: f32, side: f32| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        (Vec2::from_angle(0.7) * sine).extend(side * cosine)
    };
    [1.0, -1.0].into_iter().flat_map(move |side| [0.0, 45.0, 85.0].map(|angle| at(angle, side)))
}

#[test]
fn closures_stay_small() {
    assert!(size_of::<super::AnyClosure<'_>>() <= 80, "{}", size_of::<super::AnyClosure<'_>>());
}
