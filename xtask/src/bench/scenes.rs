//! The scenes of the benchmark.

/// A scene, its render size and its sample counts.
pub(super) struct Scene {
    pub(super) name: &'static str,
    /// Below the folder `testcases`; Mitsuba's copy is `mitsuba3/NAME.xml`.
    pub(super) path: &'static str,
    /// Width and height in pixels.
    pub(super) size: [u32; 2],
    /// Two sample counts per pixel; the difference of their times is measured.
    pub(super) counts: [u32; 2],
}

/// All scenes. The times of the two sample counts differ by about two seconds on two threads.
pub(super) const SCENES: [Scene; 4] = [
    Scene { name: "cornellbox1", path: "cornellbox1.xml", size: [256, 256], counts: [16, 96] },
    Scene { name: "coffee", path: "coffee/scene.xml", size: [480, 270], counts: [8, 48] },
    Scene { name: "spaceship", path: "spaceship/scene.xml", size: [480, 270], counts: [8, 48] },
    Scene { name: "kitchen", path: "kitchen/scene.xml", size: [480, 270], counts: [4, 16] },
];

impl Scene {
    /// The difference of the two counts, in millions of samples.
    pub(super) fn millions_between(&self) -> f64 {
        let [few, many] = self.counts;
        let pixels = f64::from(self.size[0]) * f64::from(self.size[1]);
        pixels * f64::from(many - few) * 1e-6
    }
}
