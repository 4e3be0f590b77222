//! Materials from XML, for tests.

use super::{Bsdf, Material, Materials};
use crate::builder::{Assets, BuildOptions, Builder};
use crate::ids::{MaterialId, ShapeId};
use crate::interaction::SurfaceInteraction;
use crate::texture::{Texture, Textures};
use etendue_document::{Class, Diagnostic, Diagnostics, Document, MemoryResources};
use etendue_math::Frame;
use etendue_mitsuba::LoadOptions;
use glam::{Vec2, Vec3};

/// A material with everything it refers to.
pub(crate) struct TestMaterial {
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    root: MaterialId,
}

impl TestMaterial {
    /// Builds the material of a `<bsdf>` element, which must be free of faults.
    #[track_caller]
    pub(crate) fn read(xml: &str) -> Self {
        let (material, found) = read(xml);
        assert!(found.is_empty(), "{xml}: {found:#?}");
        material.expect("a material, or a diagnostic")
    }

    /// The resolved scattering at [`surface`].
    pub(crate) fn bsdf(&self, wi: Vec3) -> Bsdf<'_> {
        let materials = Materials { materials: &self.materials };
        materials.prepare(self.root, Textures(&self.textures), &surface(wi))
    }
}

/// The messages that building the material of a `<bsdf>` element leads to.
pub(crate) fn messages(xml: &str) -> Vec<String> {
    read(xml).1.into_iter().map(|found| found.message).collect()
}

fn read(xml: &str) -> (Option<TestMaterial>, Vec<Diagnostic>) {
    let text = format!("<scene version=\"3.0.0\">{xml}</scene>");
    let (resources, diagnostics) = (MemoryResources::default(), Diagnostics::new());
    let document: Document =
        etendue_mitsuba::read_text(&text, &resources, &LoadOptions::default(), &diagnostics)
            .expect("a scene");
    let assets = Assets::new(&document, &resources, &diagnostics, false);
    let options = BuildOptions::default();
    let mut builder = Builder::new(&assets, &options);
    let node = document.parameters(document.root, &diagnostics).children_of(Class::Bsdf)[0].node;
    let root = builder.material(node);
    let (materials, textures) = (builder.materials, builder.textures);
    (root.map(|root| TestMaterial { materials, textures, root }), diagnostics.sorted())
}

/// A hit on the plane z = 0, whose shading frame is the world's.
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
