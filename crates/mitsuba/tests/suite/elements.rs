//! Each element by itself, and what is said where one is wrong.

use etendue_document::Fault::{BadValue, MissingParameter, Syntax, UnknownParameter};
use etendue_document::Severity::{Error, Warning};
use etendue_document::{Class, SpectrumValue, Value};
use etendue_mitsuba::{LoadOptions, read_text};
use glam::DVec3;

use super::{clean, load, nested, object, value};

/// The value of one element inside a shape.
fn read(element: &str) -> Value {
    let document = clean(&format!("<shape type='sphere'>{element}</shape>"));
    value(object(&document, 0), "a").clone()
}

/// The one message about an element inside a shape.
fn refused(element: &str) -> String {
    let loaded = load(&format!("<shape type='sphere'>{element}</shape>"));
    assert_eq!(loaded.findings(), [(Error, BadValue, 2)], "{element}");
    let shape = object(&loaded.document, 0);
    assert!(shape.parameters.is_empty(), "nothing comes of {element}");
    loaded.messages().remove(0)
}

#[test]
fn plain_values() {
    assert_eq!(read("<boolean name='a' value='true'/>"), Value::Boolean(true));
    assert_eq!(read("<boolean name='a' value='False'/>"), Value::Boolean(false));
    assert_eq!(read("<integer name='a' value='-3'/>"), Value::Integer(-3));
    assert_eq!(read("<integer name='a' value='10.0'/>"), Value::Integer(10));
    assert_eq!(read("<float name='a' value='1e3'/>"), Value::Float(1000.0));
    assert_eq!(read("<float name='a' value='-2.91046e-011'/>"), Value::Float(-2.91046e-11));
    assert_eq!(read("<string name='a' value='x, y'/>"), Value::String("x, y".into()));
    assert_eq!(read("<string name='a' value='&lt;&amp;'/>"), Value::String("<&".into()));
}

#[test]
fn plain_values_that_are_none() {
    assert_eq!(refused("<boolean name='a' value='yes'/>"), "`yes` is neither `true` nor `false`");
    assert_eq!(refused("<integer name='a' value='1.5'/>"), "`1.5` is not a whole number");
    assert_eq!(refused("<float name='a' value='inf'/>"), "`inf` is not a finite number");
    assert_eq!(refused("<float name='a' value='1,5'/>"), "`1,5` is not a number");
    assert_eq!(refused("<float name='a' value=''/>"), "a number is missing here");
}

#[test]
fn points_and_vectors() {
    let expected = DVec3::new(1.0, -2.0, 3.5);
    for attributes in ["x='1' y='-2' z='3.5'", "value='1 -2 3.5'", "value='1, -2, 3.5'"] {
        assert_eq!(read(&format!("<point name='a' {attributes}/>")), Value::Point(expected));
        assert_eq!(read(&format!("<vector name='a' {attributes}/>")), Value::Vector(expected));
    }
    assert_eq!(refused("<point name='a' value='1, 2'/>"), "three numbers are expected, not 2");
    let loaded = load("<shape type='sphere'><point name='a' x='1' y='2'/></shape>");
    assert_eq!(loaded.findings(), [(Error, MissingParameter, 2)]);
    assert_eq!(loaded.messages(), ["`<point>` needs the attribute `z`"]);
}

#[test]
fn colors() {
    let rgb = |r, g, b| Value::Rgb(DVec3::new(r, g, b));
    assert_eq!(read("<rgb name='a' value='0.1, 0.2 0.3'/>"), rgb(0.1, 0.2, 0.3));
    assert_eq!(read("<rgb name='a' value='300'/>"), rgb(300.0, 300.0, 300.0));
    assert_eq!(read("<rgb name='a' value='#ff0000'/>"), rgb(1.0, 0.0, 0.0));
    assert_eq!(read("<srgb name='a' value='0 1 0'/>"), rgb(0.0, 1.0, 0.0));
    // 0x80/255 is 0.2158605 of full intensity (IEC 61966-2-1).
    let Value::Rgb(grey) = read("<srgb name='a' value='#808080'/>") else { panic!() };
    assert!((grey - DVec3::splat(0.2158605)).length() < 1e-7, "{grey}");
    assert_eq!(read("<rgb name='a' value='#f00'/>"), rgb(1.0, 0.0, 0.0));
    for with_alpha in ["#f008", "#ff000080"] {
        let loaded = load(&format!("<shape type='x'><rgb name='a' value='{with_alpha}'/></shape>"));
        assert_eq!(loaded.findings(), [(Warning, BadValue, 2)], "the alpha is left out");
        assert_eq!(value(object(&loaded.document, 0), "a"), &rgb(1.0, 0.0, 0.0));
    }
    assert_eq!(refused("<rgb name='a' value='#ff000'/>"), "`#ff000` is not a colour `#rrggbb`");
    assert_eq!(refused("<rgb name='a' value='#+f0000'/>"), "`#+f0000` is not a colour `#rrggbb`");
    assert_eq!(refused("<rgb name='a' value='1 2'/>"), "three numbers are expected, not 2");
}

#[test]
fn spectra() {
    let spectrum = |element| match read(element) {
        Value::Spectrum(spectrum) => spectrum,
        other => panic!("{other:?}"),
    };
    assert_eq!(spectrum("<spectrum name='a' value='0.5'/>"), SpectrumValue::Constant(0.5));
    assert_eq!(
        spectrum("<spectrum name='a' value='400:0.1, 500:0.2'/>"),
        SpectrumValue::Samples(vec![(400.0, 0.1), (500.0, 0.2)])
    );
    assert_eq!(
        spectrum("<spectrum name='a' filename='Au.eta.spd'/>"),
        SpectrumValue::File("Au.eta.spd".into())
    );
    assert_eq!(read("<spectrum name='a' value='1 2 3'/>"), Value::Rgb(DVec3::new(1.0, 2.0, 3.0)));
    assert_eq!(refused("<spectrum name='a' value='500:1, 400:1'/>"), "wavelengths must ascend");
    assert!(refused("<spectrum name='a' value='1 2'/>").contains("not 2 numbers"));
}

#[test]
fn a_spectrum_with_a_type_is_a_texture() {
    let document = clean(
        "<bsdf type='diffuse'><spectrum type='rawconstant' name='reflectance'>
            <float name='value' value='2'/></spectrum></bsdf>",
    );
    let texture = nested(&document, object(&document, 0), 0);
    assert_eq!((texture.class, texture.plugin.as_str()), (Class::Texture, "rawconstant"));
    assert_eq!(value(texture, "value"), &Value::Float(2.0));
}

#[test]
fn black_bodies() {
    let body = |temperature, scale| Value::Blackbody { temperature, scale };
    assert_eq!(read("<blackbody name='a' temperature='5000'/>"), body(5000.0, 1.0));
    assert_eq!(read("<blackbody name='a' temperature='6500K' scale='2'/>"), body(6500.0, 2.0));
    assert!(refused("<blackbody name='a' temperature='-1'/>").contains("above 0"));
}

#[test]
fn curves() {
    let document = clean(
        "<shape type='revsurface'><curve type='Bspline'>
            <vec value='0, 1, 2'/><vec x='3' y='4' z='5'/></curve></shape>",
    );
    let curve = nested(&document, object(&document, 0), 0);
    assert_eq!((curve.class, curve.plugin.as_str()), (Class::Curve, "Bspline"));
    let points = vec![DVec3::new(0.0, 1.0, 2.0), DVec3::new(3.0, 4.0, 5.0)];
    assert_eq!(value(curve, "points"), &Value::Points(points));
    let loaded = load("<shape type='sphere'><vec value='0 0 0'/></shape>");
    assert_eq!(loaded.messages(), ["`<vec>` stands inside a `<curve>` only"]);
}

#[test]
fn every_object_element_has_its_class() {
    let elements = [
        ("integrator", Class::Integrator),
        ("sensor", Class::Sensor),
        ("camera", Class::Sensor),
        ("film", Class::Film),
        ("sampler", Class::Sampler),
        ("rfilter", Class::ReconstructionFilter),
        ("shape", Class::Shape),
        ("bsdf", Class::Bsdf),
        ("texture", Class::Texture),
        ("emitter", Class::Emitter),
        ("luminaire", Class::Emitter),
        ("medium", Class::Medium),
        ("phase", Class::Phase),
        ("volume", Class::Volume),
        ("subsurface", Class::Subsurface),
    ];
    for (element, class) in elements {
        let document = clean(&format!("<{element} type=' p ' id='i' name='role'/>"));
        let node = object(&document, 0);
        assert_eq!((node.class, node.plugin.as_str()), (class, "p"));
        assert_eq!(node.id.as_deref(), Some("i"));
        assert_eq!(document.node(document.root).children[0].name.as_deref(), Some("role"));
    }
}

#[test]
fn parameters_keep_their_place_and_the_name_as_typed() {
    let document =
        clean("<shape type='obj'>\n  <boolean name='faceNormals' value='true'/></shape>");
    let parameter = &object(&document, 0).parameters[0];
    assert_eq!(parameter.name, "face_normals");
    assert_eq!(parameter.original_name, "faceNormals");
    let place = document.sources.locate(parameter.span);
    assert_eq!(place.to_string(), "<scene>:3:3");
    let text = document.sources.excerpt(parameter.span);
    assert_eq!(text, "<boolean name='faceNormals' value='true'");
}

#[test]
fn what_is_missing_or_unknown_is_said_where_it_is() {
    let loaded = load(
        "<shape id='s'><float name='radius' value='1'/></shape>
         <shape type='sphere'>
            <float value='1'/>
            <float name='radius'/>
            <flaot name='radius' value='1'/>
            <float name='radius' valeu='1' value='2'/>
            <ref/>
            <scene/>
            <float name='r' value='1'><float name='x' value='1'/></float>
            loose words
         </shape>
         <shape type='instance'><ref id='s'/></shape>",
    );
    assert_eq!(
        loaded.findings(),
        [
            (Error, MissingParameter, 2),
            (Error, MissingParameter, 4),
            (Error, MissingParameter, 5),
            (Error, Syntax, 6),
            (Warning, UnknownParameter, 7),
            (Error, MissingParameter, 8),
            (Error, Syntax, 9),
            (Error, Syntax, 10),
            (Warning, Syntax, 11),
        ],
        "{}",
        loaded.shown()
    );
    let help = &loaded.diagnostics.sorted()[3].help;
    assert_eq!(help[0], "did you mean `float`?");
}

#[test]
fn names_given_by_the_caller_replace_defaults_anywhere() {
    let text = "<scene version='3.0.0'><default name='spp' value='16'/><default name='kind' value='independent'/>
        <sampler type='$kind'><integer name='sample_count' value='$spp'/>
        <string name='x' value='a${'/><string name='y' value='f_$spp.png'/></sampler></scene>"
        .replace("a${", "a");
    let diagnostics = etendue_document::Diagnostics::new();
    let options = LoadOptions {
        defines: vec![("spp".into(), "64".into()), ("sp".into(), "1".into())],
        ..LoadOptions::default()
    };
    let resources = etendue_document::MemoryResources::default();
    let document = read_text(&text, &resources, &options, &diagnostics).unwrap();
    let sampler = object(&document, 0);
    assert_eq!(sampler.plugin, "independent");
    assert_eq!(value(sampler, "sample_count"), &Value::Integer(64));
    assert_eq!(value(sampler, "y"), &Value::String("f_64.png".into()));
    let found = diagnostics.sorted();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].message, "the scene does not use `$sp`");
    assert_eq!(found[0].help, ["it uses `kind`, `spp`"]);
}

#[test]
fn an_undefined_name_is_pointed_at_and_brings_no_further_errors() {
    let loaded = load(
        "<default name='spp' value='1'/><sampler type='independent'>
         <integer name='sample_count' value='$ssp'/></sampler><shape type='$kind'/>",
    );
    assert_eq!(loaded.findings(), [(Error, BadValue, 3), (Error, BadValue, 3)]);
    let found = &loaded.diagnostics.sorted()[0];
    assert_eq!(found.message, "`$ssp` is not defined");
    assert_eq!(loaded.document.sources.excerpt(found.span.unwrap()), "$ssp");
    assert_eq!(found.help[0], "did you mean `$spp`?");
}

#[test]
fn a_default_that_cannot_be_expanded_is_reported_once() {
    let loaded = load(
        "<default name='a' value='$nothing'/>
         <default name='b' value='$a'/>
         <sampler type='$b'><integer name='sample_count' value='$a'/></sampler>",
    );
    assert_eq!(loaded.findings(), [(Error, BadValue, 2)], "{}", loaded.shown());
}
