//! Older dialects in the names of version 3.

use etendue_document::Fault::{Approximation, MissingParameter};
use etendue_document::Severity::{Error, Note, Warning};
use etendue_document::{Diagnostics, MemoryResources, SpectrumValue, Value};
use etendue_mitsuba::{LoadOptions, read_text};
use glam::{DMat4, DVec3};

use super::{Loaded, clean, load, names, nested, object, value};

/// Loads one approximated object, which must be reported at its line.
fn approximated(content: &str, line: usize) -> Loaded {
    let loaded = load(content);
    assert_eq!(loaded.findings(), [(Warning, Approximation, line)], "{}", loaded.shown());
    loaded
}

fn text(text: &str) -> Value {
    Value::String(text.to_owned())
}

#[test]
fn names_of_parameters_and_children_become_snake_case_silently() {
    let document = clean(
        "<bsdf type='plastic'><float name='intIOR' value='1.5'/><string name='extIOR' value='air'/>
            <texture name='diffuseReflectance' type='checkerboard'/></bsdf>
         <film type='hdrfilm'><integer name='cropOffsetX' value='1'/>
            <string name='componentFormat' value='float32'/></film>",
    );
    let plastic = object(&document, 0);
    assert_eq!(names(plastic), ["int_ior", "ext_ior"]);
    assert_eq!(plastic.children[0].name.as_deref(), Some("diffuse_reflectance"));
    assert_eq!(names(object(&document, 1)), ["crop_offset_x", "component_format"]);
}

#[test]
fn renamed_parameters() {
    let document = clean(
        "<bsdf type='diffuse'><rgb name='diffuseReflectance' value='1'/></bsdf>
         <bsdf type='roughplastic'><texture name='reflectance' type='bitmap'/></bsdf>
         <emitter type='area'><rgb name='intensity' value='1'/></emitter>
         <emitter type='point'><rgb name='intensity' value='1'/></emitter>
         <film type='hdrfilm'><boolean name='highQualityEdges' value='true'/></film>
         <bsdf type='diffuse'><rgb name='reflectance' value='1'/>
            <rgb name='diffuseReflectance' value='0'/></bsdf>",
    );
    assert_eq!(names(object(&document, 0)), ["reflectance"]);
    let child = &object(&document, 1).children[0];
    assert_eq!(child.name.as_deref(), Some("diffuse_reflectance"));
    assert_eq!(names(object(&document, 2)), ["radiance"]);
    assert_eq!(names(object(&document, 3)), ["intensity"], "of a point light it is the name");
    assert_eq!(names(object(&document, 4)), ["sample_border"]);
    let both = object(&document, 5);
    assert_eq!(names(both), ["reflectance", "diffuse_reflectance"], "the new name is taken");
}

#[test]
fn integrators_this_version_lacks_become_path() {
    for plugin in [
        "bdpt",
        "mlt",
        "pssmlt",
        "erpt",
        "ppm",
        "sppm",
        "photonmapper",
        "vpl",
        "prb",
        "prb_basic",
        "prb_projective",
        "prb_reparam",
        "prb_threepoint",
        "motion",
    ] {
        let loaded = approximated(
            &format!(
                "<integrator type='{plugin}'><integer name='maxDepth' value='7'/>
                 <integer name='initialSamples' value='3'/></integrator>"
            ),
            2,
        );
        let integrator = object(&loaded.document, 0);
        assert_eq!(integrator.plugin, "path");
        assert_eq!(names(integrator), ["max_depth"], "what steers {plugin} is left out");
        assert!(loaded.messages()[0].starts_with(&format!("`{plugin}` is rendered as `path`")));
    }
    for plugin in ["volpath_simple", "prbvolpath"] {
        let loaded = approximated(&format!("<integrator type='{plugin}'/>"), 2);
        assert_eq!(object(&loaded.document, 0).plugin, "volpath");
    }
    for plugin in ["direct_projective", "direct_reparam", "ao"] {
        let loaded = approximated(&format!("<integrator type='{plugin}'/>"), 2);
        assert_eq!(object(&loaded.document, 0).plugin, "direct");
    }
    let emission = approximated("<integrator type='emission_reparam'/>", 2);
    assert_eq!(value(object(&emission.document, 0), "max_depth"), &Value::Integer(1));
    for plugin in ["path", "direct", "depth", "moment", "aov"] {
        assert_eq!(object(&clean(&format!("<integrator type='{plugin}'/>")), 0).plugin, plugin);
    }
}

#[test]
fn integrators_that_steer_another_one_give_way_to_it() {
    let loaded = load(
        "<integrator type='adaptive'><float name='maxError' value='5'/>
            <integrator type='irrcache'>
                <integrator type='bdpt'><integer name='maxDepth' value='3'/></integrator>
            </integrator></integrator>",
    );
    let lines: Vec<usize> = loaded.findings().iter().map(|found| found.2).collect();
    assert_eq!(lines, [2, 3, 4], "{}", loaded.shown());
    let integrator = object(&loaded.document, 0);
    assert_eq!((integrator.plugin.as_str(), names(integrator)), ("path", vec!["max_depth"]));
    assert!(integrator.children.is_empty());
}

#[test]
fn a_perspective_with_an_aperture_is_a_thin_lens() {
    let loaded = load(
        "<sensor type='perspective'><film type='hdrfilm'/>
            <float name='apertureRadius' value='0.07'/>
            <float name='focusDistance' value='8'/></sensor>",
    );
    assert_eq!(loaded.findings(), [(Note, Approximation, 3)]);
    assert_eq!(object(&loaded.document, 0).plugin, "thinlens");
    let document = clean(
        "<sensor type='perspective'><float name='focus_distance' value='8'/></sensor>
         <sensor type='perspective'><float name='aperture_radius' value='0'/></sensor>",
    );
    assert_eq!(object(&document, 0).plugin, "perspective", "a pinhole is in focus everywhere");
    assert_eq!(object(&document, 1).plugin, "perspective");
    assert_eq!(names(object(&document, 1)), [""; 0]);
}

#[test]
fn texture_coordinates_are_scaled_then_moved() {
    let document = clean(
        "<texture type='bitmap'><float name='uscale' value='2'/><integer name='vscale' value='3'/>
            <float name='uoffset' value='0.5'/></texture>
         <texture type='checkerboard'><float name='voffset' value='0.25'/>
            <transform name='toUV'><scale value='2'/></transform></texture>",
    );
    let Value::Transform(matrix) = value(object(&document, 0), "to_uv") else { panic!() };
    assert_eq!(matrix.transform_point3(DVec3::ONE), DVec3::new(2.5, 3.0, 1.0));
    let Value::Transform(matrix) = value(object(&document, 1), "to_uv") else { panic!() };
    let expected =
        DMat4::from_scale(DVec3::splat(2.0)) * DMat4::from_translation(DVec3::new(0.0, 0.25, 0.0));
    assert_eq!(DMat4::from(*matrix), expected, "what stands there already comes after");
}

#[test]
fn texture_filters_with_levels_are_reported_once_with_every_line() {
    let texture = "<texture type='bitmap'><string name='filterType' value='ewa'/></texture>\n";
    let loaded = approximated(&texture.repeat(3), 2);
    assert_eq!(value(object(&loaded.document, 2), "filter_type"), &text("bilinear"));
    assert_eq!(loaded.diagnostics.sorted()[0].help, ["also on lines 3, 4"]);
    for filter in ["trilinear", "isotropic"] {
        approximated(&texture.replace("ewa", filter), 2);
    }
    for filter in ["nearest", "bilinear"] {
        let document = clean(&texture.replace("ewa", filter));
        assert_eq!(value(object(&document, 0), "filter_type"), &text(filter));
    }
}

#[test]
fn wrap_modes_become_one() {
    let mode = |u: &str, v: &str| {
        load(&format!(
            "<texture type='bitmap'><string name='wrapModeU' value='{u}'/>
                <string name='wrapModeV' value='{v}'/></texture>"
        ))
    };
    let same = mode("mirror", "mirror");
    assert_eq!(same.findings(), []);
    assert_eq!(value(object(&same.document, 0), "wrap_mode"), &text("mirror"));
    let different = mode("repeat", "clamp");
    assert_eq!(different.findings(), [(Warning, Approximation, 3)]);
    assert_eq!(value(object(&different.document, 0), "wrap_mode"), &text("repeat"));
    let zero = mode("zero", "zero");
    assert_eq!(zero.findings(), [(Warning, Approximation, 2)]);
    assert_eq!(value(object(&zero.document, 0), "wrap_mode"), &text("clamp"));
}

#[test]
fn a_texture_gamma_of_one_means_raw() {
    let gamma = |value: &str| {
        load(&format!(
            "<texture type='bitmap'><float name='gamma' value='{value}'/></texture>
             <film type='ldrfilm'><float name='gamma' value='2.2'/></film>"
        ))
    };
    let raw = gamma("1");
    assert_eq!(raw.findings(), []);
    assert_eq!(value(object(&raw.document, 0), "raw"), &Value::Boolean(true));
    assert_eq!(names(object(&raw.document, 1)), ["gamma"], "of a film it stays");
    assert_eq!(names(object(&gamma("-1").document, 0)), [""; 0]);
    assert_eq!(gamma("2.2").findings(), [(Warning, Approximation, 2)]);
}

#[test]
fn phong_becomes_a_blend_of_its_two_lobes() {
    let loaded = approximated(
        "<bsdf type='phong' id='p'><float name='exponent' value='49.5'/>
            <rgb name='diffuseReflectance' value='0.3, 0.1, 0.1'/>
            <spectrum name='specularReflectance' value='0.1'/></bsdf>",
        2,
    );
    let document = &loaded.document;
    let blend = object(document, 0);
    assert_eq!((blend.plugin.as_str(), blend.id.as_deref()), ("blendbsdf", Some("p")));
    assert_eq!(value(blend, "weight"), &Value::Float(0.25));
    let diffuse = nested(document, blend, 0);
    let Value::Rgb(reflectance) = value(diffuse, "reflectance") else { panic!() };
    // Times its weight of 3/4 it is what the file says.
    assert!((*reflectance * 0.75 - DVec3::new(0.3, 0.1, 0.1)).length() < 1e-12);
    let lobe = nested(document, blend, 1);
    assert_eq!(lobe.plugin, "roughconductor");
    let Value::Rgb(reflectance) = value(lobe, "specular_reflectance") else { panic!() };
    assert!((*reflectance * 0.25 - DVec3::splat(0.1)).length() < 1e-12);
    // α² = 1 / (2 · 49.5 + 1).
    assert_eq!(value(lobe, "alpha_u"), &Value::Float(0.1));
    assert_eq!(value(lobe, "material"), &text("none"));
}

#[test]
fn ward_keeps_its_two_roughnesses() {
    let loaded = approximated(
        "<bsdf type='ward'><float name='alphaU' value='0.2'/><float name='alphaV' value='0.3'/>
            <string name='variant' value='balanced'/></bsdf>",
        2,
    );
    let lobe = nested(&loaded.document, object(&loaded.document, 0), 1);
    assert_eq!(value(lobe, "alpha_u"), &Value::Float(0.2));
    assert_eq!(value(lobe, "alpha_v"), &Value::Float(0.3));
}

#[test]
fn phong_with_a_texture_becomes_rough_plastic() {
    let loaded = approximated(
        "<bsdf type='phong'><texture type='bitmap' name='diffuseReflectance'/>
            <float name='exponent' value='49.5'/></bsdf>",
        2,
    );
    let plastic = object(&loaded.document, 0);
    assert_eq!((plastic.plugin.as_str(), names(plastic)), ("roughplastic", vec!["alpha"]));
    let Value::Float(alpha) = value(plastic, "alpha") else { panic!() };
    assert!((alpha - 0.1).abs() < 1e-15);
    assert_eq!(plastic.children[0].name.as_deref(), Some("diffuse_reflectance"));
}

#[test]
fn distributions_that_are_gone_become_beckmann() {
    for name in ["phong", "as"] {
        let loaded = approximated(
            &format!(
                "<bsdf type='roughdielectric'><string name='distribution' value='{name}'/></bsdf>"
            ),
            2,
        );
        assert_eq!(value(object(&loaded.document, 0), "distribution"), &text("beckmann"));
    }
    clean("<bsdf type='roughplastic'><string name='distribution' value='ggx'/></bsdf>");
}

#[test]
fn plugins_that_are_gone_become_the_nearest() {
    for (content, new) in [
        ("<sensor type='telecentric'/>", "orthographic"),
        ("<sensor type='perspective_rdist'/>", "perspective"),
        ("<film type='tiledhdrfilm'/>", "hdrfilm"),
    ] {
        assert_eq!(object(&approximated(content, 2).document, 0).plugin, new);
    }
    let document = clean("<bsdf type='roughdiffuse'/>");
    assert_eq!(object(&document, 0).plugin, "roughdiffuse", "is left to who builds it");
}

#[test]
fn a_conductor_of_which_nothing_is_said_is_copper_in_old_scenes_only() {
    let material = |version: &str, content: &str| {
        let text =
            format!("<scene version='{version}'><bsdf type='conductor'>{content}</bsdf></scene>");
        let diagnostics = Diagnostics::new();
        let resources = MemoryResources::default();
        let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).unwrap();
        object(&document, 0).parameters.last().map(|last| last.value.clone())
    };
    assert_eq!(material("0.6.0", ""), Some(text("Cu")));
    assert_eq!(material("3.0.0", ""), None);
    assert_eq!(material("0.6.0", "<string name='material' value='Au'/>"), Some(text("Au")));
    let eta = material("0.6.0", "<rgb name='eta' value='1'/>");
    assert_eq!(eta, Some(Value::Rgb(DVec3::ONE)));
}

#[test]
fn the_sky_and_the_sun_of_version_0_6_become_one_plugin() {
    let document = clean(
        "<emitter type='sky'><float name='scale' value='2'/><integer name='resolution' value='9'/>
            <vector name='sunDirection' x='0' y='1' z='0'/></emitter>
         <emitter type='sun'><float name='sunRadiusScale' value='2'/>
            <rgb name='albedo' value='0.5'/></emitter>",
    );
    let (sky, sun) = (object(&document, 0), object(&document, 1));
    assert_eq!((&*sky.plugin, &*sun.plugin), ("sunsky", "sunsky"));
    assert_eq!(value(sky, "sky_scale"), &Value::Float(2.0));
    assert_eq!(value(sky, "sun_scale"), &Value::Float(0.0));
    assert_eq!(value(sun, "sky_scale"), &Value::Float(0.0));
    assert_eq!(value(sun, "sun_aperture"), &Value::Float(2.0 * 0.5358));
    assert_eq!(value(sky, "albedo"), &Value::Float(0.2), "the default of that version");
    assert_eq!(value(sun, "albedo"), &Value::Rgb(DVec3::splat(0.5)));
    let Value::Transform(to_world) = value(sky, "to_world") else { panic!("a transform") };
    assert_eq!(to_world.transform_vector3(DVec3::Z), DVec3::Y, "up");
    assert_eq!(to_world.transform_vector3(DVec3::NEG_X), DVec3::NEG_Z, "north");
    assert!(!names(sky).contains(&"resolution"));
}

#[test]
fn mixtures_become_blends_of_two() {
    let document = clean(
        "<bsdf type='mixturebsdf' id='m'><string name='weights' value='0.1, 0.3 0.4'/>
            <bsdf type='diffuse'/><bsdf type='plastic'/><bsdf type='conductor'/></bsdf>",
    );
    // With 0.2 of black there are four parts: two halves of two.
    let root = object(&document, 0);
    assert_eq!((root.plugin.as_str(), root.id.as_deref()), ("blendbsdf", Some("m")));
    let near = |node, expected: f64| {
        let Value::Float(weight) = value(node, "weight") else { panic!("a weight") };
        assert!((weight - expected).abs() < 1e-12, "{weight} {expected}");
    };
    near(root, 0.6);
    let (first, second) = (nested(&document, root, 0), nested(&document, root, 1));
    near(first, 0.75);
    near(second, 1.0 / 3.0);
    assert_eq!(nested(&document, first, 1).plugin, "plastic");
    let black = nested(&document, second, 1);
    assert_eq!(value(black, "reflectance"), &Value::Float(0.0));
}

#[test]
fn composites_say_what_is_wrong_with_them() {
    let mixture = |weights: &str| {
        format!(
            "<bsdf type='mixturebsdf'><string name='weights' value='{weights}'/>
                <bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>"
        )
    };
    let none = "<bsdf type='mixturebsdf'/>".to_owned();
    let no_weights = "<bsdf type='mixturebsdf'><bsdf type='diffuse'/></bsdf>".to_owned();
    let coating = "<bsdf type='coating'/>".to_owned();
    let two = "<bsdf type='roughcoating'><bsdf type='diffuse'/><bsdf type='diffuse'/></bsdf>";
    for (content, words) in [
        (mixture("0.5"), "`mixturebsdf` has 1 weights for 2 bsdfs"),
        (mixture("0.5, 0.5, 0.5"), "has 3 weights for 2 bsdfs"),
        (mixture("a, b"), "not numbers"),
        (mixture("-1, 2"), "negative"),
        (none, "needs the bsdfs that it mixes"),
        (no_weights, "needs the string `weights`"),
        (coating, "`coating` needs one bsdf inside it"),
        (two.to_owned(), "`roughcoating` needs one bsdf inside it, the material below, not 2"),
    ] {
        let loaded = load(&content);
        assert_eq!(loaded.findings(), [(Error, MissingParameter, 2)], "{content}");
        assert!(loaded.messages()[0].contains(words), "{:?}", loaded.messages());
        assert_eq!(object(&loaded.document, 0).plugin, "diffuse", "no second message");
    }
}

#[test]
fn a_coating_of_a_diffuse_base_is_plastic() {
    let loaded = approximated(
        "<bsdf type='coating'><float name='intIOR' value='1.7'/><float name='thickness' value='2'/>
            <bsdf type='diffuse'><texture name='reflectance' type='bitmap'/></bsdf></bsdf>",
        2,
    );
    let plastic = object(&loaded.document, 0);
    assert_eq!(
        (plastic.plugin.as_str(), names(plastic)),
        ("plastic", vec!["int_ior", "nonlinear"])
    );
    assert_eq!(plastic.children[0].name.as_deref(), Some("diffuse_reflectance"));
}

#[test]
fn a_coating_of_anything_else_is_a_mirror_mixed_in() {
    let loaded = approximated(
        "<bsdf type='roughcoating'><float name='intIOR' value='1.5'/><float name='alpha' value='0.2'/>
            <bsdf type='roughconductor'/></bsdf>",
        2,
    );
    let document = &loaded.document;
    let blend = object(document, 0);
    assert_eq!(blend.plugin, "blendbsdf");
    let Value::Float(weight) = value(blend, "weight") else { panic!("a weight") };
    assert!((weight - 0.04).abs() < 1e-12);
    let coat = nested(document, blend, 1);
    assert_eq!((coat.plugin.as_str(), names(coat)), ("roughconductor", vec!["alpha", "material"]));
    assert_eq!(nested(document, blend, 0).plugin, "roughconductor");
}

#[test]
fn sheets_and_cloth_become_the_nearest() {
    let document = clean("<bsdf type='difftrans'><rgb name='transmittance' value='0.3'/></bsdf>");
    let sheet = object(&document, 0);
    assert_eq!(
        (sheet.plugin.as_str(), names(sheet)),
        ("principledthin", vec!["base_color", "diff_trans"])
    );
    let slab = approximated(
        "<bsdf type='hk'><spectrum name='sigmaS' value='3'/><spectrum name='sigmaA' value='1'/>
            <float name='thickness' value='1'/></bsdf>",
        2,
    );
    let slab = object(&slab.document, 0);
    assert_eq!(value(slab, "base_color"), &Value::Rgb(DVec3::splat(0.75)));
    let cloth =
        approximated("<bsdf type='irawan'><string name='filename' value='a.wv'/></bsdf>", 2);
    assert_eq!(object(&cloth.document, 0).plugin, "roughdiffuse");
    let plastic = approximated("<bsdf type='pplastic'><float name='alpha' value='0.2'/></bsdf>", 2);
    assert_eq!(object(&plastic.document, 0).plugin, "roughplastic");
}

#[test]
fn old_textures_become_the_nearest() {
    let document = clean("<texture type='vertexcolors'/><texture type='ldrtexture'/>");
    assert_eq!(value(object(&document, 0), "name"), &text("vertex_color"));
    assert_eq!(object(&document, 0).plugin, "mesh_attribute");
    assert_eq!(object(&document, 1).plugin, "bitmap");
    let wires = approximated(
        "<texture type='wireframe'><rgb name='interiorColor' value='0.3'/>
            <rgb name='edgeColor' value='1'/></texture>",
        2,
    );
    let wires = object(&wires.document, 0);
    assert_eq!(
        (wires.plugin.as_str(), names(wires)),
        ("gridtexture", vec!["color0", "line_width"])
    );
    assert_eq!(value(wires, "color0"), &Value::Rgb(DVec3::splat(0.3)));
    let grey = approximated("<texture type='curvature'/>", 2);
    assert_eq!(value(object(&grey.document, 0), "color0"), &Value::Float(0.5));
}

#[test]
fn spectra_that_are_plugins_become_values() {
    let document = clean(
        "<emitter type='constant'><spectrum name='radiance' type='blackbody'>
            <float name='temperature' value='5000'/></spectrum></emitter>
         <bsdf type='diffuse'><spectrum name='reflectance' type='regular'>
            <float name='wavelength_min' value='400'/><float name='wavelength_max' value='700'/>
            <string name='values' value='0.1, 0.2 0.4'/></spectrum></bsdf>
         <bsdf type='diffuse'><spectrum name='reflectance' type='irregular'>
            <string name='wavelengths' value='400, 650'/><string name='values' value='0.1, 0.2'/>
            </spectrum></bsdf>
         <emitter type='point'><spectrum name='intensity' type='d65'>
            <rgb name='color' value='0.5'/><float name='scale' value='4'/></spectrum></emitter>
         <bsdf type='diffuse'><spectrum name='reflectance' type='uniform'>
            <float name='value' value='0.3'/></spectrum></bsdf>",
    );
    let samples = |pairs: &[(f64, f64)]| Value::Spectrum(SpectrumValue::Samples(pairs.to_vec()));
    let expected = [
        ("radiance", Value::Blackbody { temperature: 5000.0, scale: 1.0 }),
        ("reflectance", samples(&[(400.0, 0.1), (550.0, 0.2), (700.0, 0.4)])),
        ("reflectance", samples(&[(400.0, 0.1), (650.0, 0.2)])),
        ("intensity", Value::Rgb(DVec3::splat(2.0))),
        ("reflectance", Value::Float(0.3)),
    ];
    for (index, (name, expected)) in expected.into_iter().enumerate() {
        let object = object(&document, index);
        assert_eq!(value(object, name), &expected);
        assert!(object.children.is_empty());
    }
}

#[test]
fn a_sun_that_wanders_stands_still_and_merged_shapes_stand_alone() {
    let loaded = approximated(
        "<emitter type='timed_sunsky'><integer name='start_year' value='2020'/>
            <integer name='end_year' value='2021'/><float name='window_start_time' value='8'/>
            </emitter>
         <shape type='merge'><shape type='cube'/><shape type='sphere'/></shape>",
        2,
    );
    let sky = object(&loaded.document, 0);
    assert_eq!(sky.plugin, "sunsky");
    assert_eq!(names(sky), ["year", "hour"]);
    assert_eq!(value(sky, "hour"), &Value::Float(13.5));
    let shapes: Vec<&str> = (1..3).map(|index| &*object(&loaded.document, index).plugin).collect();
    assert_eq!(shapes, ["cube", "sphere"]);
}
