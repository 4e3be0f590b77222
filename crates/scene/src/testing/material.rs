//! Materials from XML, for tests.

use crate::batch::{BatchMaterial, Materials};
use crate::bsdf::{Bsdf, Material, Transport};
use crate::builder::{Assets, BuildOptions, Builder};
use crate::ids::{MaterialId, ShapeId};
use crate::interaction::SurfaceInteraction;
use crate::texture::{Texture, Textures};
use etendue_document::{
    Class, Diagnostic, Diagnostics, Document, Fault, MemoryResources, Severity,
};
use etendue_math::Frame;
use etendue_mitsuba::LoadOptions;
use etendue_testkit::TestRng;
use glam::{Vec2, Vec3};

/// A material with everything that it refers to.
pub(crate) struct TestMaterial {
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    batch: Vec<BatchMaterial>,
    pub(crate) root: MaterialId,
}

impl TestMaterial {
    /// Builds the material of a `<bsdf>` element without errors. Extreme values may be warned about.
    #[track_caller]
    pub(crate) fn read(xml: &str) -> Self {
        let (material, found) = read(xml);
        let is_tolerable = |found: &Diagnostic| {
            (found.severity, found.fault) == (Severity::Warning, Fault::BadValue)
        };
        assert!(found.iter().all(is_tolerable), "{xml}: {found:#?}");
        material.expect("a material, or a diagnostic")
    }

    /// The closure at [`surface`].
    pub(crate) fn bsdf(&self, wi: Vec3) -> Bsdf<'_> {
        self.bsdf_at(&surface(wi))
    }

    /// The closure at a hit.
    pub(crate) fn bsdf_at(&self, surface: &SurfaceInteraction) -> Bsdf<'_> {
        self.materials().prepare(self.root, Textures(&self.textures), surface)
    }

    /// The material and its nested materials.
    pub(crate) fn materials(&self) -> Materials<'_> {
        Materials { materials: &self.materials, batch: &self.batch }
    }
}

/// Asserts that building the material of a `<bsdf>` element reports a single fault of this kind,
/// whose message contains `words`.
#[track_caller]
pub(crate) fn assert_finds(xml: &str, severity: Severity, fault: Fault, words: &str) {
    let found = read(xml).1;
    let [only] = found.as_slice() else { panic!("{xml}: {found:#?}") };
    let agree = (only.severity, only.fault) == (severity, fault) && only.message.contains(words);
    assert!(agree, "{xml}: {only:#?}");
}

/// Asserts that two materials scatter alike.
#[track_caller]
pub(crate) fn assert_same(first: &str, second: &str) {
    let materials = [first, second].map(TestMaterial::read);
    let mut random = TestRng::new(7);
    for _ in 0..200 {
        let (wi, wo) = (random.unit_vector(), random.unit_vector());
        let values = materials.each_ref().map(|material| {
            let bsdf = material.bsdf(wi);
            let sample = bsdf.sample(wi, 0.3, Vec2::new(0.2, 0.6), Transport::Radiance);
            let sample = sample.map(|sample| (sample.wo, sample.weight, sample.pdf, sample.eta));
            (bsdf.eval_pdf(wi, wo, Transport::Radiance), sample)
        });
        assert_eq!(values[0], values[1], "{first} and {second} from {wi} to {wo}");
    }
}

/// Files that materials may refer to.
fn resources() -> MemoryResources {
    MemoryResources::default()
        .with("isotropic.bsdf", include_bytes!("../bsdf/measured/isotropic.bsdf").to_vec())
        .with("anisotropic.bsdf", include_bytes!("../bsdf/measured/anisotropic.bsdf").to_vec())
        .with("quarter.bsdf", include_bytes!("../bsdf/measured/quarter.bsdf").to_vec())
        .with("spectral.bsdf", include_bytes!("../bsdf/measured/spectral.bsdf").to_vec())
        .with("broken.bsdf", b"tensor_file".to_vec())
}

fn read(xml: &str) -> (Option<TestMaterial>, Vec<Diagnostic>) {
    let text = format!("<scene version=\"3.0.0\">{xml}</scene>");
    let (resources, diagnostics) = (resources(), Diagnostics::new());
    let document: Document =
        etendue_mitsuba::read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
            .expect("a scene");
    let assets = Assets::new(&document, &resources, &diagnostics);
    let options = BuildOptions::default();
    let mut builder = Builder::new(&assets, &options);
    let node = document.parameters(document.root, &diagnostics).children_of(Class::Bsdf)[0].node;
    let root = builder.material(node);
    assets.report_not_found();
    let (materials, textures) = (builder.materials, builder.textures);
    let batch = BatchMaterial::of_all(&materials);
    (root.map(|root| TestMaterial { materials, textures, batch, root }), diagnostics.sorted())
}

/// A hit on the plane z = 0, whose shading frame is that of the world.
pub(crate) fn surface(wi: Vec3) -> SurfaceInteraction {
    SurfaceInteraction {
        point: Vec3::ZERO,
        error: Vec3::ZERO,
        t: 1.0,
        normal: Vec3::Z,
        shading: Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z },
        uv: Vec2::new(0.3, 0.4),
        dp_du: Vec3::X,
        dp_dv: Vec3::Y,
        wi,
        shape: ShapeId(0),
        primitive: 0,
        barycentric: Vec2::ZERO,
        instance: None,
    }
}
