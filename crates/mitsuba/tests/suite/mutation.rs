//! Random damage to a valid scene: whatever comes of it, nothing panics.

use etendue_document::{Diagnostics, ExcerptStyle, MemoryResources, render_diagnostic};
use etendue_mitsuba::{LoadOptions, read_file};
use proptest::prelude::*;
use std::path::Path;

const SCENE: &[u8] = br##"<scene version="0.6.0">
<default name="spp" value="4"/><path value="."/><alias id="mat" as="other"/>
<integrator type="adaptive"><integrator type="bdpt"><integer name="maxDepth" value="3"/></integrator></integrator>
<sensor type="perspective"><float name="fov" value="45"/><float name="apertureRadius" value="0.1"/>
<transform name="toWorld"><lookAt origin="0,0,-5" target="0 0 0" up="0 1 0"/><scale value="2"/>
<rotate value="0, 0, 1" angle="15"/><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform>
<sampler type="sobol"><integer name="sampleCount" value="$spp"/></sampler></sensor>
<bsdf type="bumpmap"><texture type="bitmap"><string name="filterType" value="ewa"/><float name="uscale" value="2"/>
<string name="wrapModeU" value="zero"/><float name="gamma" value="1"/></texture>
<bsdf type="phong" id="mat"><rgb name="diffuseReflectance" value="#80ff00"/><float name="exponent" value="9"/></bsdf></bsdf>
<shape type="revsurface"><curve type="Bspline"><vec value="0 1 0"/><vec x="1" y="2" z="3"/></curve><ref id="other"/>
<emitter type="area"><spectrum name="radiance" value="400:1, 700:2"/><blackbody name="x" temperature="5000K"/></emitter></shape>
<include filename="scene.xml"/><!-- end --></scene>"##;

/// One change to the bytes of a scene.
#[derive(Clone, Debug)]
enum Damage {
    Replace(prop::sample::Index, u8),
    Remove(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize, usize),
    Insert(prop::sample::Index, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let pieces =
        ["<", ">", "\"", "$", "<ref id=\"mat\"/>", "</bsdf>", "&", "<bsdf>", "1e999", "é", "<!--"];
    prop_oneof![
        (any::<prop::sample::Index>(), any::<u8>())
            .prop_map(|(at, byte)| Damage::Replace(at, byte)),
        (any::<prop::sample::Index>(), 1usize..40)
            .prop_map(|(at, count)| Damage::Remove(at, count)),
        (any::<prop::sample::Index>(), 1usize..60, 1usize..9)
            .prop_map(|(at, length, times)| Damage::Repeat(at, length, times)),
        (any::<prop::sample::Index>(), prop::sample::select(pieces.to_vec()))
            .prop_map(|(at, piece)| Damage::Insert(at, piece)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    let end = |start: usize, length: usize| (start + length).min(bytes.len());
    match damage {
        Damage::Replace(at, byte) => {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        Damage::Remove(at, count) => {
            let start = at.index(bytes.len());
            bytes.drain(start..end(start, *count));
        }
        Damage::Repeat(at, length, times) => {
            let start = at.index(bytes.len());
            let piece = bytes[start..end(start, *length)].repeat(*times);
            bytes.splice(start..start, piece);
        }
        Damage::Insert(at, piece) => {
            let at = at.index(bytes.len());
            bytes.splice(at..at, piece.bytes());
        }
    }
    if bytes.is_empty() {
        bytes.push(b' ');
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_scenes_are_read_or_refused(damages in prop::collection::vec(damage(), 0..6)) {
        let mut bytes = SCENE.to_vec();
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        let resources = MemoryResources::default().with("scene.xml", bytes);
        let diagnostics = Diagnostics::new();
        let options = LoadOptions::default();
        let document = read_file(Path::new("scene.xml"), &resources, &options, &diagnostics);
        prop_assert!(document.is_ok() || diagnostics.has_errors());
        let Ok(document) = document else { return Ok(()) };
        for found in diagnostics.sorted() {
            let style = ExcerptStyle { is_colored: true, ..ExcerptStyle::default() };
            prop_assert!(!render_diagnostic(&found, &document.sources, style).is_empty());
        }
        // Every child exists, and every plugin's reader can be made and finished.
        for index in 0..document.nodes.len() {
            let id = etendue_document::NodeId(index as u32);
            prop_assert!(document.node(id).children.iter().all(|c| c.node.index() < document.nodes.len()));
            document.parameters(id, &diagnostics).finish();
        }
    }
}
