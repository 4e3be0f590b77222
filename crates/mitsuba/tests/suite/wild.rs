//! What strangers' scenes hold: old colours, stock plugins of version 0.6, text that is not quite XML.

use std::path::Path;

use etendue_document::Fault::{Approximation, BadValue, Syntax};
use etendue_document::Severity::{Error, Warning};
use etendue_document::{
    Diagnostics, Document, ExcerptStyle, MemoryResources, SpectrumValue, Value, render_diagnostic,
};
use etendue_mitsuba::{LoadOptions, read_file};
use glam::DVec3;

use super::{Loaded, load, load_old, names, nested, object, value};

fn old(content: &str) -> Document {
    let loaded = load_old(content);
    assert_eq!(loaded.findings(), [], "{}", loaded.shown());
    loaded.document
}

#[test]
fn only_srgb_is_encoded_in_old_scenes() {
    let document = old("<bsdf type='diffuse'><rgb name='a' value='#804020'/>
        <srgb name='b' value='#804020'/><rgb name='c' value='#fff'/></bsdf>");
    let bsdf = object(&document, 0);
    let linear = DVec3::new(128.0, 64.0, 32.0) / 255.0;
    assert_eq!(value(bsdf, "a"), &Value::Rgb(linear));
    let Value::Rgb(decoded) = value(bsdf, "b") else { panic!("a colour") };
    // IEC 61966-2-1.
    assert!((*decoded - DVec3::new(0.215_860_5, 0.051_269_5, 0.014_443_8)).length() < 1e-6);
    assert_eq!(value(bsdf, "c"), &Value::Rgb(DVec3::ONE));
}

#[test]
fn included_files_without_a_version_are_of_that_of_the_scene() {
    let files = MemoryResources::default()
        .with("/part.xml", "<bsdf type='diffuse'><rgb name='a' value='#804020'/></bsdf>");
    for (version, red) in [("0.5.0", 128.0 / 255.0), ("3.0.0", 0.215_860_5)] {
        let main = format!("<scene version='{version}'><include filename='part.xml'/></scene>");
        let files = files.clone().with("/main.xml", main);
        let diagnostics = Diagnostics::new();
        let path = Path::new("/main.xml");
        let document = read_file(path, &files, &LoadOptions::default(), &diagnostics).unwrap();
        let Value::Rgb(color) = value(object(&document, 0), "a") else { panic!("a colour") };
        assert!((color.x - red).abs() < 1e-6, "{version}: {color}");
    }
}

/// A spectrum of one number is white light in version 0.6, whose RGB is that number.
#[test]
fn one_number_is_white_in_emitters_of_old_scenes() {
    let plugins = [
        ("constant", "radiance"),
        ("area", "radiance"),
        ("point", "intensity"),
        ("spot", "intensity"),
        ("directional", "irradiance"),
    ];
    for (plugin, name) in plugins {
        for intent in ["", "intent='illuminant'", "intent='reflectance'"] {
            let emitter = format!(
                "<emitter type='{plugin}'><spectrum name='{name}' value='2' {intent}/></emitter>"
            );
            assert_eq!(value(object(&old(&emitter), 0), name), &Value::Float(2.0), "{emitter}");
            let new = load(&emitter);
            let constant = Value::Spectrum(SpectrumValue::Constant(2.0));
            assert_eq!(value(object(&new.document, 0), name), &constant, "{emitter}");
        }
    }
    let samples =
        old("<emitter type='constant'><spectrum name='radiance' value='400:1, 700:1'/></emitter>");
    let samples = value(object(&samples, 0), "radiance").clone();
    assert!(matches!(samples, Value::Spectrum(SpectrumValue::Samples(_))), "{samples:?}");
    let odd = load_old("<bsdf type='diffuse'><spectrum name='a' value='1' intent='x'/></bsdf>");
    assert_eq!(odd.findings(), [(Warning, BadValue, 2)]);
}

#[test]
fn one_scale_is_that_of_the_sun_and_the_sky() {
    let document = old("<emitter type='sunsky'><float name='scale' value='50'/></emitter>
         <emitter type='sunsky'><float name='scale' value='50'/><float name='sunScale' value='2'/>
            <float name='stretch' value='1.5'/><boolean name='extend' value='true'/>
            <vector name='sunDirection' x='0' y='1' z='1'/><float name='hour' value='9'/></emitter>");
    let both = object(&document, 0);
    assert_eq!(value(both, "sun_scale"), &Value::Float(50.0));
    assert_eq!(value(both, "sky_scale"), &Value::Float(50.0));
    assert_eq!(value(both, "albedo"), &Value::Float(0.2));
    let mixed = object(&document, 1);
    assert_eq!(value(mixed, "sun_scale"), &Value::Float(2.0));
    assert_eq!(value(mixed, "sky_scale"), &Value::Float(50.0));
    assert_eq!(value(mixed, "stretch"), &Value::Float(1.5));
    assert_eq!(value(mixed, "extend"), &Value::Boolean(true));
    assert!(!names(mixed).contains(&"scale") && !names(mixed).contains(&"hour"));
}

/// One warning, of an approximation.
fn approximated(content: &str) -> Loaded {
    let loaded = load_old(content);
    let [(severity, fault, _)] = loaded.findings()[..] else { panic!("{}", loaded.shown()) };
    assert_eq!((severity, fault), (Warning, Approximation), "{}", loaded.shown());
    loaded
}

#[test]
fn subsurface_scattering_is_rendered_as_its_diffuse_reflectance() {
    let dipole =
        "<subsurface type='dipole'><string name='material' value='skimmilk'/></subsurface>";
    let reflectance = |content: &str, plugin: &str, name: &str| {
        let loaded = approximated(content);
        let shape = object(&loaded.document, 0);
        assert_eq!(shape.children.len(), 1, "{}", loaded.shown());
        let bsdf = nested(&loaded.document, shape, 0);
        assert_eq!(bsdf.plugin, plugin);
        let Value::Rgb(color) = value(bsdf, name) else { panic!("a colour") };
        *color
    };
    let bare = format!("<shape type='sphere'>{dipole}</shape>");
    let milk = reflectance(&bare, "diffuse", "reflectance");
    // α' of the red channel is 0.70 / 0.7014, A of an index of 1.3 is 2.20: 0.5 α' (1 + e^(−4/3 A s))
    // e^(−s) with s = √(3 (1 − α')) = 0.0774.
    assert!((milk.x - 0.824).abs() < 0.01 && milk.x > milk.z, "{milk}");
    for (below, plugin, name) in [
        (
            "<bsdf type='roughplastic'><rgb name='diffuseReflectance' value='0'/></bsdf>",
            "roughplastic",
            "diffuse_reflectance",
        ),
        ("<bsdf type='plastic'/>", "plastic", "diffuse_reflectance"),
        (
            "<bsdf type='roughdielectric'><float name='alpha' value='0.2'/></bsdf>",
            "roughplastic",
            "diffuse_reflectance",
        ),
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>",
            "diffuse",
            "reflectance",
        ),
    ] {
        let content = format!("<shape type='sphere'>{dipole}{below}</shape>");
        assert_eq!(reflectance(&content, plugin, name), milk, "{below}");
    }
    let white = bare.replace(
        "<string name='material' value='skimmilk'/>",
        "<rgb name='sigmaS' value='2, 1, 0'/><rgb name='sigmaA' value='0'/>",
    );
    assert_eq!(reflectance(&white, "diffuse", "reflectance"), DVec3::new(1.0, 1.0, 0.0));
    for plugin in ["multipole", "singlescatter"] {
        reflectance(&bare.replace("dipole", plugin), "diffuse", "reflectance");
    }
}

#[test]
fn a_material_is_kept_for_shapes_that_scatter_nothing() {
    let loaded = approximated(
        "<bsdf type='plastic' id='p'/><subsurface type='dipole' id='d'/>
         <shape type='sphere'><ref id='p'/><ref id='d'/></shape>
         <shape type='cube'><ref id='p'/></shape>",
    );
    let document = &loaded.document;
    assert_eq!(document.node(document.root).children.len(), 3, "the scattering is gone");
    let (sphere, cube) = (object(document, 1), object(document, 2));
    assert!(names(nested(document, sphere, 0)).contains(&"diffuse_reflectance"));
    assert_eq!(names(nested(document, cube, 0)), [""; 0]);
}

#[test]
fn a_normal_map_needs_no_name() {
    let document =
        old("<bsdf type='normalmap'><texture type='bitmap'/><bsdf type='diffuse'/></bsdf>
         <bsdf type='normalmap'><texture type='bitmap'/><texture name='normalmap' type='bitmap'/>
            <bsdf type='diffuse'/></bsdf>");
    assert_eq!(object(&document, 0).children[0].name.as_deref(), Some("normalmap"));
    assert_eq!(object(&document, 1).children[0].name, None, "there is one with the name");
}

#[test]
fn layers_of_version_0_6_are_those_of_aov() {
    let loaded = load_old(
        "<integrator type='multichannel'><integrator type='path'/>
            <integrator type='field'><string name='field' value='shNormal'/></integrator>
            <integrator type='field'><string name='field' value='distance'/></integrator>
         </integrator>
         <film type='hdrfilm'><string name='pixelFormat' value='rgb, luminance'/>
            <string name='channelNames' value='color, normal'/></film>",
    );
    assert!(loaded.findings().iter().all(|found| found.1 == Approximation), "{}", loaded.shown());
    let aov = object(&loaded.document, 0);
    assert_eq!((aov.plugin.as_str(), aov.children.len()), ("aov", 1));
    let layers = Value::String("sh_normal:sh_normal, depth:depth".to_owned());
    assert_eq!(value(aov, "aovs"), &layers);
    let film = object(&loaded.document, 1);
    assert_eq!(names(film), ["pixel_format"]);
    assert_eq!(value(film, "pixel_format"), &Value::String("rgb".to_owned()));
}

#[test]
fn stock_plugins_of_version_0_6_have_stand_ins() {
    for (content, new) in [
        ("<shape type='heightfield'><string name='filename' value='a.exr'/></shape>", "rectangle"),
        ("<shape type='hair'><string name='filename' value='a.hair'/></shape>", "linearcurve"),
        ("<film type='mfilm'><string name='variable' value='x'/></film>", "hdrfilm"),
        ("<integrator type='field'><string name='field' value='albedo'/></integrator>", "aov"),
        ("<volume type='hgridvolume'><string name='filename' value='a'/></volume>", "constvolume"),
    ] {
        assert_eq!(object(&approximated(content).document, 0).plugin, new);
    }
    let hair = approximated("<shape type='hair'/>");
    assert_eq!(value(object(&hair.document, 0), "radius"), &Value::Float(0.025));
    for content in [
        "<emitter type='collimated'/>",
        "<shape type='deformable'><shape type='sphere'/></shape>",
        "<sensor type='fluencemeter'><film type='hdrfilm'/></sensor>",
    ] {
        let loaded = approximated(content);
        let document = &loaded.document;
        assert!(document.node(document.root).children.is_empty(), "{content}");
        assert!(loaded.messages()[0].contains("is left out"), "{}", loaded.shown());
    }
}

/// Loads a whole file.
fn load_bytes(bytes: &[u8]) -> (Option<Document>, Diagnostics) {
    let files = MemoryResources::default().with("/scene.xml", bytes);
    let diagnostics = Diagnostics::new();
    let options = LoadOptions::default();
    let document = read_file(Path::new("/scene.xml"), &files, &options, &diagnostics).ok();
    (document, diagnostics)
}

#[test]
fn text_that_is_not_quite_xml_is_read_with_a_warning() {
    let cases: [(&str, &str, &str); 5] = [
        ("<scene>\n<shape type='a'/></scene>\n<shape type='b'/>", "left out", "<shape type='b'/>"),
        ("<scene><shape type='a'/></scene><scene/> x", "left out", "<scene/> x"),
        ("<scene><!-- a -- b --><shape type='a'/></scene>", "`--`", "<!-- a -- b -->"),
        ("<!----->\n<scene><shape type='a'/><!-- c --- d --></scene>", "`--`", "<!----->"),
        ("<scene><shape type='a'/></scene> words", "left out", "words"),
    ];
    for (text, words, place) in cases {
        let (document, diagnostics) = load_bytes(text.as_bytes());
        let document = document.expect(text);
        assert_eq!(object(&document, 0).plugin, "a");
        let found = diagnostics.sorted();
        assert_eq!(
            (found.len(), found[0].severity, found[0].fault),
            (1, Warning, Syntax),
            "{text}"
        );
        assert!(found[0].message.contains(words), "{}", found[0].message);
        assert_eq!(document.sources.excerpt(found[0].span.unwrap()), place, "{text}");
    }
    for text in ["<scene><shape type='a'/></scene>\n<!-- -->\n<?x?>\n", "<scene/><!-- -->"] {
        assert_eq!(load_bytes(text.as_bytes()).1.sorted(), [], "{text}");
    }
}

#[test]
fn places_are_right_in_every_encoding() {
    let text =
        "<?xml version='1.0' encoding='iso-8859-1'?>\n<!-- größe -->\n<scene>\n é <flot/></scene>";
    let latin: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [latin, utf16] {
        let (document, diagnostics) = load_bytes(&bytes);
        let sources = document.expect("a scene").sources;
        let error = diagnostics.sorted().into_iter().find(|found| found.severity == Error);
        let error = error.expect("there is no `flot`");
        let shown = render_diagnostic(&error, &sources, ExcerptStyle::default());
        assert!(shown.contains("/scene.xml:4:4"), "{shown}");
        assert!(shown.contains(" é <flot/></scene>"), "{shown}");
    }
}

#[test]
fn messages_say_what_to_write() {
    let cases = [
        ("<color name='a' value='1'/>", "`<rgb name"),
        ("<light type='area'/>", "`<emitter type"),
        ("<material type='diffuse'/>", "`<bsdf type"),
        ("<shape type='x'><translate x='1'/></shape>", "`<transform name=\"to_world\">`"),
        ("<shape type='x'><float name='a' value='0,5'/></shape>", "write `0.5`"),
        ("<shape type='x'><rgb name='a' value='0,5 0,5 0,5'/></shape>", "decimals have a point"),
        ("<shape type='x'><float name='a' value='${spp}'/></shape>", "write `$spp`"),
        ("<shape type='x'><integer name='a' value='4*4'/></shape>", "write the result"),
        ("<sphere/>", "`<shape type=\"sphere\">`"),
    ];
    for (content, words) in cases {
        let loaded = load(content);
        let found = loaded.diagnostics.sorted();
        assert_eq!(found.len(), 1, "{}", loaded.shown());
        assert!(loaded.shown().contains(words), "{}", loaded.shown());
    }
}

#[test]
fn a_wrong_closing_tag_points_at_the_element_left_open() {
    let text = "<scene>\n<shape type='a'>\n<bsdf type='b'>\n</shape>\n</scene>";
    let (_, diagnostics) = load_bytes(text.as_bytes());
    let found = &diagnostics.sorted()[0];
    assert_eq!(found.message, "`</shape>` where `</bsdf>` is expected");
    let opened = &found.related[0];
    assert_eq!(&text[opened.span.range()], "<bsdf");
    assert_eq!(opened.message, "opened here");
    let quote = "<scene>\n<float name='fov' value=\"35.6/>\n<float name='x' value=\"1\"/></scene>";
    let (_, diagnostics) = load_bytes(quote.as_bytes());
    let found = &diagnostics.sorted()[0];
    assert!(found.message.contains("quote is not closed"), "{}", found.message);
    assert_eq!(&quote[found.span.unwrap().range()], "\"35.6/>");
}

/// A scene may name any file of the machine, so nothing of a file that is no scene is shown.
#[test]
fn nothing_of_an_included_file_of_another_kind_is_shown() {
    for secret in [
        "root:SECRET:19000:0\ndaemon:*:19000",
        "<config><password>SECRET</password></config>",
        "<!-- SECRET --><fontconfig>SECRET",
        "SECRET\n<scene/>",
        "<scenery SECRET='SECRET'/>",
        "\u{e9}SECRET",
    ] {
        let files = MemoryResources::default()
            .with("/main.xml", "<scene version='3.0.0'>\n<include filename='x.txt'/></scene>")
            .with("/x.txt", secret);
        let diagnostics = Diagnostics::new();
        let path = Path::new("/main.xml");
        let document = read_file(path, &files, &LoadOptions::default(), &diagnostics).unwrap();
        let found = diagnostics.sorted();
        assert!(diagnostics.has_errors());
        let render = |found| render_diagnostic(found, &document.sources, ExcerptStyle::default());
        let shown: String = found.iter().map(render).collect();
        assert!(!shown.contains("SECRET"), "{shown}");
        assert!(shown.contains("/x.txt:1:1") && shown.contains("/main.xml:2"), "{shown}");
    }
}
