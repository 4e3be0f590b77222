//! Scenes that load although something in them is odd: each oddity is one warning, with its place.

use etendue_document::{Diagnostics, MemoryResources, Severity};
use etendue_image::{Channel, EncodeOptions, ExrPrecision, FileFormat, Picture, encode};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, build_scene};

/// A grid of two cells.
fn grid(values: [f32; 2]) -> Vec<u8> {
    let header = [1, 2, 1, 1, 1].map(i32::to_le_bytes).concat();
    let bounds = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].map(f32::to_le_bytes).concat();
    [b"VOL\x03".to_vec(), header, bounds, values.map(f32::to_le_bytes).concat()].concat()
}

/// A grey picture of four texels whose third one is `odd`.
fn picture(odd: f32) -> Vec<u8> {
    let data = vec![0.5, 0.5, odd, 0.5];
    let channels =
        ["R", "G", "B"].map(|name| Channel { name: name.to_owned(), data: data.clone() });
    let picture = Picture { channels: channels.to_vec(), ..Picture::new(2, 2) };
    let options = EncodeOptions { exr_precision: ExrPrecision::Float, ..EncodeOptions::default() };
    encode(&picture, FileFormat::Exr, &options).expect("the picture can be written")
}

/// The warnings of a scene, which must load.
#[track_caller]
fn warnings(body: &str) -> Vec<String> {
    let resources = MemoryResources::default()
        .with("undershoot.vol", grid([-0.004, 1.5]))
        .with("distance.vol", include_bytes!("data/distance.vol").to_vec())
        .with("curves.txt", b"0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1\n".to_vec())
        .with("ellipsoids.ply", include_bytes!("data/ellipsoids.ply").to_vec())
        .with("nan.exr", picture(f32::NAN))
        .with("inf.exr", picture(f32::INFINITY))
        .with("negative.exr", picture(-1.0))
        .with("fine.exr", picture(0.5));
    let diagnostics = Diagnostics::new();
    let text = format!(r#"<scene version="3.0.0"><sensor type="perspective"/>{body}</scene>"#);
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).ok();
    let scene = document.and_then(|document| {
        build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
    });
    assert!(scene.is_some(), "{body}: {:?}", diagnostics.sorted());
    let found = diagnostics.sorted();
    assert!(found.iter().all(|one| one.severity == Severity::Warning && one.span.is_some()));
    found.into_iter().map(|one| one.message).collect()
}

/// There is one warning, and it contains `part`.
#[track_caller]
fn assert_warns(body: &str, part: &str) {
    let found = warnings(body);
    assert!(found.len() == 1 && found[0].contains(part), "{body}: {found:?}");
}

#[track_caller]
fn assert_silent(body: &str) {
    let found = warnings(body);
    assert!(found.is_empty(), "{body}: {found:?}");
}

fn bsdf(inside: &str) -> String {
    format!(r#"<shape type="sphere"><bsdf {inside}</bsdf></shape>"#)
}

#[test]
fn environments_with_broken_texels_load() {
    let environment = |file: &str| {
        format!(r#"<emitter type="envmap"><string name="filename" value="{file}.exr"/></emitter>"#)
    };
    assert_warns(&environment("nan"), "texel 0, 1 is NaN, NaN, NaN");
    assert_warns(&environment("inf"), "texel 0, 1 is inf, inf, inf");
    assert_warns(&environment("negative"), "texel 0, 1 is -1, -1, -1");
    assert_silent(&environment("fine"));
    assert_silent(&environment("fine").replace("</em", r#"<float name="scale" value="0"/></em"#));
}

#[test]
fn negative_reflectances_and_indices_count_as_zero() {
    let metal = |name: &str, value: &str| {
        bsdf(&format!(r#"type="roughconductor"><rgb name="{name}" value="{value}"/>"#))
    };
    assert_warns(&metal("eta", "-0.05, 4, 5"), "negative component");
    assert_warns(&metal("k", "3, 3, -1e-3"), "negative component");
    assert_warns(&metal("specular_reflectance", "-1, 0.5, 0.5"), "negative component");
    assert_silent(&metal("k", "3, 3, 0"));
    let measured = r#"type="diffuse"><spectrum name="reflectance" value="400:-0.1, 700:0.5"/>"#;
    assert_warns(&bsdf(measured), "negative value");
}

#[test]
fn roughness_above_one_is_unusual() {
    for plugin in ["roughconductor", "roughdielectric", "roughplastic"] {
        let rough = |alpha: &str| {
            bsdf(&format!(r#"type="{plugin}"><float name="alpha" value="{alpha}"/>"#))
        };
        assert_warns(&rough("20"), "`alpha` is 20");
        assert_silent(&rough("1"));
    }
}

#[test]
fn a_metal_without_an_index_is_black() {
    let principled = |metallic: &str, specular: &str| {
        bsdf(&format!(
            r#"type="principled"><float name="metallic" value="{metallic}"/>
            <float name="specular" value="{specular}"/>"#
        ))
    };
    assert_warns(&principled("1", "0"), "reflects nothing");
    assert_silent(&principled("0", "0"));
    assert_silent(&principled("1", "0.5"));
}

#[test]
fn wide_spot_lights_load() {
    let spot = |inside: &str| format!(r#"<emitter type="spot">{inside}</emitter>"#);
    let angle = |name: &str, value: u32| format!(r#"<float name="{name}" value="{value}"/>"#);
    for cutoff in [90, 120, 180, 360] {
        assert_silent(&spot(&angle("cutoff_angle", cutoff)));
    }
    let beam = angle("cutoff_angle", 20) + &angle("beam_width", 40);
    assert_warns(&spot(&beam), "wider than the cutoff");
    let picture = angle("cutoff_angle", 120) + r#"<texture type="checkerboard" name="texture"/>"#;
    assert_warns(&spot(&picture), "limited to 89");
}

#[test]
fn volumes_a_little_below_zero_load() {
    for name in ["sigma_t", "albedo"] {
        let medium = format!(
            r#"<shape type="cube"><bsdf type="null"/><medium type="heterogeneous" name="interior">
            <volume type="gridvolume" name="{name}"><string name="filename" value="undershoot.vol"/></volume>
            </medium></shape>"#
        );
        let found = warnings(&medium);
        assert!(found.iter().any(|message| message.contains("down to -0.004")), "{found:?}");
    }
}

#[test]
fn lights_that_are_not_sampled_are_reported() {
    let shapes = [
        ("bsplinecurve", r#"<string name="filename" value="curves.txt"/>"#),
        ("linearcurve", r#"<string name="filename" value="curves.txt"/>"#),
        ("sdfgrid", r#"<string name="filename" value="distance.vol"/>"#),
        ("ellipsoids", r#"<string name="filename" value="ellipsoids.ply"/>"#),
        ("ellipsoidsmesh", r#"<string name="filename" value="ellipsoids.ply"/>"#),
    ];
    for (shape, inside) in shapes {
        let shape = |emitter: &str| format!(r#"<shape type="{shape}">{inside}{emitter}</shape>"#);
        assert_warns(&shape(r#"<emitter type="area"/>"#), "by chance");
        assert_silent(&shape(""));
    }
    for shape in ["cube", "sphere", "rectangle", "disk", "cylinder"] {
        assert_silent(&format!(r#"<shape type="{shape}"><emitter type="area"/></shape>"#));
    }
}

#[test]
fn an_irradiance_meter_does_not_see_points() {
    let meter = r#"<shape type="rectangle"><sensor type="irradiancemeter"><film type="hdrfilm">
        <integer name="width" value="1"/><integer name="height" value="1"/></film></sensor></shape>"#;
    for emitter in ["point", "spot", "directional"] {
        let body = format!(r#"{meter}<emitter type="{emitter}"/>"#);
        assert_warns(&body, &format!("the light of `{emitter}` reaches this meter only"));
        assert_silent(&format!(r#"<emitter type="{emitter}"/>"#));
    }
    assert_silent(&format!(r#"{meter}<emitter type="constant"/>"#));
}

#[test]
fn parameters_without_effect_that_mitsuba_has_are_accepted() {
    let idle = [
        r#"<sensor type="perspective"><float name="focus_distance" value="3"/></sensor>"#,
        r#"<sensor type="orthographic"><float name="focus_distance" value="3"/></sensor>"#,
        r#"<shape type="sphere"><float name="silhouette_sampling_weight" value="1"/></shape>"#,
        r#"<medium type="homogeneous" id="fog"><boolean name="has_spectral_extinction" value="false"/></medium>"#,
    ];
    for body in idle {
        assert_silent(body);
    }
    assert_warns(
        r#"<sensor type="perspective"><float name="focal_distance" value="3"/></sensor>"#,
        "no parameter `focal_distance`",
    );
}
