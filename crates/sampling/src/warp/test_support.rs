//! The round trip that every warp is put through.

use etendue_testkit::TestRng;
use glam::Vec2;

/// Asserts that `invert` undoes `sample` to within `tolerance`.
pub(super) fn assert_round_trip<T: Copy>(
    sample: impl Fn(Vec2) -> T,
    invert: impl Fn(T) -> Vec2,
    tolerance: f32,
) {
    let mut random = TestRng::new(11);
    for _ in 0..20_000 {
        let point = random.next_vec2();
        let back = invert(sample(point));
        assert!(back.distance(point) <= tolerance, "{point} came back as {back}");
        assert!(back.cmpge(Vec2::ZERO).all() && back.cmplt(Vec2::ONE).all(), "{back}");
    }
}
