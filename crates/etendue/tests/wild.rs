//! Scenes as strangers write them: what loads, with which warnings, and what is rendered.

use etendue::document::{Diagnostic, MemoryResources, Severity};
use etendue::{ExcerptStyle, Loaded, RenderOptions, SceneOptions, load_text, render_text};

fn scene(version: &str, content: &str) -> String {
    format!("<scene version=\"{version}\">{content}</scene>")
}

fn load_with(text: &str, options: &SceneOptions) -> (Loaded, Vec<Diagnostic>) {
    let files = MemoryResources::default()
        .with("/points.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n")
        .with("/secret.txt", "SECRET\nSECRET");
    let loaded = load_text(text, "/".into(), &files, options);
    let found = loaded.diagnostics.list.clone();
    (loaded, found)
}

/// Loads a scene; the messages of its warnings. Most of these scenes have no light, which is not meant
/// here.
fn warnings(text: &str) -> Vec<String> {
    let (loaded, found) = load_with(text, &SceneOptions::default());
    assert!(loaded.scene.is_some(), "{text}: {found:?}");
    let warnings = found.into_iter().filter(|found| found.severity == Severity::Warning);
    let messages = warnings.map(|found| found.message);
    messages.filter(|message| !message.starts_with("the scene has no emitter")).collect()
}

/// The one error of a scene that does not load: its message and its advice.
fn refused(text: &str) -> String {
    let (loaded, found) = load_with(text, &SceneOptions::default());
    assert!(loaded.scene.is_none(), "{text}");
    let error = found.iter().find(|found| found.severity == Severity::Error).expect("an error");
    format!("{} {}", error.message, error.help.join(" "))
}

const SENSOR: &str = r#"<sensor type="orthographic">
    <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/>
        <string name="pixel_format" value="rgb"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="1024"/></sampler></sensor>"#;

/// The mean colour of a scene that a sensor of ±1 around the z axis sees.
fn mean(version: &str, content: &str) -> [f32; 3] {
    let text = scene(version, &format!("{SENSOR}{content}"));
    let rendering = render_text(&text, &SceneOptions::default(), &RenderOptions::default());
    let picture = rendering.expect(content).picture;
    ["R", "G", "B"].map(|name| {
        let channel = picture.channels.iter().find(|channel| channel.name == name);
        let data = &channel.expect("a colour").data;
        data.iter().sum::<f32>() / data.len() as f32
    })
}

fn assert_near(found: [f32; 3], expected: [f32; 3], what: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() < 0.01 * expected + 1e-3, "{what}: {found} {expected}");
    }
}

#[test]
fn emitters_of_shapes_may_stand_beside_them() {
    let emitter =
        r#"<emitter type="area" id="light"><rgb name="radiance" value="3, 2, 1"/></emitter>"#;
    let shape = r#"<shape type="rectangle"><transform name="to_world"><scale value="2"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf><ref id="light"/></shape>"#;
    let far = shape.replace("<scale value=\"2\"/>", "<translate z=\"-9\"/>");
    for content in
        [format!("{emitter}{shape}"), format!("{shape}{emitter}"), format!("{far}{shape}{emitter}")]
    {
        assert_eq!(warnings(&scene("3.0.0", &format!("{SENSOR}{content}"))), [""; 0], "{content}");
        assert_near(mean("3.0.0", &content), [3.0, 2.0, 1.0], &content);
    }
    let beam = shape.replace("light", "beam");
    let content = format!("{SENSOR}<emitter type=\"directionalarea\" id=\"beam\"/>{beam}");
    assert_eq!(warnings(&scene("3.0.0", &content)), [""; 0]);
}

#[test]
fn an_emitter_of_shapes_that_no_shape_has_is_a_warning() {
    for (content, advice) in [
        (r#"<emitter type="area" id="L"/>"#, "`<ref id=\"L\"/>`"),
        (r#"<emitter type="area"/>"#, "put it inside a `<shape>`"),
        (r#"<sensor type="irradiancemeter" id="L"/>"#, "`<ref id=\"L\"/>`"),
    ] {
        let text = scene("3.0.0", &format!("{SENSOR}<emitter type=\"constant\"/>{content}"));
        let (loaded, found) = load_with(&text, &SceneOptions::default());
        assert!(loaded.scene.is_some());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].message.contains("belongs in a shape"), "{}", found[0].message);
        assert!(found[0].help[0].contains(advice), "{}", found[0].help[0]);
    }
    let inside = r#"<shape type="sphere"><emitter type="point"/></shape>"#;
    assert!(refused(&scene("3.0.0", inside)).contains("`point` stands in the scene"));
}

#[test]
fn sensors_of_shapes_may_stand_beside_them() {
    let meter = r#"<sensor type="irradiancemeter" id="I"><film type="hdrfilm">
        <integer name="width" value="1"/><integer name="height" value="1"/></film></sensor>"#;
    let content = format!(
        "{meter}<shape type=\"sphere\"><ref id=\"I\"/></shape><emitter type=\"constant\"/>"
    );
    let (loaded, found) = load_with(&scene("3.0.0", &content), &SceneOptions::default());
    assert_eq!(found, [], "{found:?}");
    assert_eq!(loaded.scene.expect("a scene").scene.sensors().len(), 1);
}

#[test]
fn shapes_of_the_scene_may_be_members_of_groups() {
    let content = r#"<emitter type="constant"/>
        <shape type="rectangle" id="S"><transform name="to_world"><scale x="0.5"/><translate x="-0.5"/></transform>
            <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></shape>
        <shape type="shapegroup" id="G"><ref id="S"/></shape>
        <shape type="shapegroup" id="H"><ref id="S"/></shape>
        <shape type="instance"><ref id="G"/><transform name="to_world"><translate x="1"/></transform></shape>
        <shape type="instance"><ref id="H"/><transform name="to_world"><translate x="9"/></transform></shape>"#;
    assert_eq!(warnings(&scene("3.0.0", &format!("{SENSOR}{content}"))), [""; 0]);
    assert_near(mean("3.0.0", content), [0.0; 3], "two halves cover the picture");
}

#[test]
fn old_colors_are_rendered_as_version_0_6_does() {
    let surface = r##"<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
        <shape type="rectangle"><transform name="toWorld"><scale value="9"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="#804020"/></bsdf></shape>"##;
    assert_near(mean("0.6.0", surface), [0.502, 0.251, 0.1255], "linear");
    assert_near(mean("3.0.0", surface), [0.2159, 0.0513, 0.0144], "sRGB");
    let light = r#"<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>"#;
    assert_near(mean("0.6.0", light), [1.0; 3], "white");
    assert_near(mean("3.0.0", light), [1.2048, 0.9483, 0.9089], "equal energy");
}

#[test]
fn the_scale_of_a_sunsky_counts() {
    let sky = |scale: f32| {
        let content = format!(
            "<emitter type=\"sunsky\"><float name=\"scale\" value=\"{scale}\"/>
            <transform name=\"toWorld\"><rotate x=\"1\" angle=\"-90\"/></transform></emitter>"
        );
        mean("0.5.0", &content)
    };
    let (one, fifty) = (sky(1.0), sky(50.0));
    assert!(one[1] > 0.0);
    assert!((fifty[1] / one[1] - 50.0).abs() < 0.01, "{fifty:?} {one:?}");
}

#[test]
fn a_flat_rectangle_is_rendered() {
    let flat = r#"<emitter type="constant"/><shape type="rectangle"><transform name="to_world">
        <scale x="2" y="2" z="0"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.25"/></bsdf></shape>"#;
    assert_near(mean("3.0.0", flat), [0.25; 3], "flat");
    let sphere =
        r#"<shape type="sphere"><transform name="to_world"><scale z="0"/></transform></shape>"#;
    assert_eq!(warnings(&scene("3.0.0", &format!("{SENSOR}{sphere}"))).len(), 2);
}

#[test]
fn parts_of_sensors_may_stand_beside_them() {
    let used = r#"<rfilter type="box" id="r"/><film type="hdrfilm" id="f"><ref id="r"/></film>
        <sampler type="independent" id="s"/><sensor type="perspective"><ref id="f"/><ref id="s"/></sensor>"#;
    assert_eq!(warnings(&scene("3.0.0", used)), [""; 0]);
    let unused = format!("{SENSOR}<film type=\"hdrfilm\" id=\"f\"/>");
    assert_eq!(warnings(&scene("3.0.0", &unused)), ["no sensor has this film: it is left out"]);
}

#[test]
fn what_cannot_be_rendered_is_a_warning() {
    let mask = r#"<shape type="sphere"><bsdf type="mask"><rgb name="opacity" value="0.25, 0.5, 1"/>
        <bsdf type="diffuse"/></bsdf></shape>"#;
    let grey = mask.replace("0.25, 0.5, 1", "0.5");
    let layers = r#"<integrator type="aov"><string name="aovs" value="a:albedo, x:nonsense"/>
        <integrator type="path"/></integrator>"#;
    let bytes = r#"<bsdf type="diffuse"><rgb name="reflectance" value="255, 128, 0"/></bsdf>"#;
    let points = r#"<shape type="ply"><string name="filename" value="points.ply"/></shape>"#;
    for (content, words) in [
        (mask, vec!["opacity has a colour"]),
        (grey.as_str(), vec![]),
        (layers, vec!["no layer `nonsense`"]),
        (bytes, vec!["`reflectance` is above 1"]),
        (points, vec!["no triangles", "point cloud"]),
    ] {
        let found = warnings(&scene("3.0.0", &format!("{SENSOR}{content}")));
        assert_eq!(found.len(), words.len(), "{found:?}");
        for (found, words) in found.iter().zip(words) {
            assert!(found.contains(words), "{found}");
        }
    }
}

#[test]
fn names_of_materials_are_found_in_any_spelling() {
    for metal in ["gold", "Gold", "Au", "aluminium", "cu"] {
        let bsdf = format!(
            "{SENSOR}<bsdf type=\"conductor\"><string name=\"material\" value=\"{metal}\"/></bsdf>"
        );
        assert_eq!(warnings(&scene("3.0.0", &bsdf)), [""; 0], "{metal}");
    }
}

#[test]
fn messages_say_what_to_write_and_are_short() {
    let bsdf = |plugin: &str| format!("<bsdf type=\"{plugin}\"/>");
    let metal = |name: &str| {
        format!("<bsdf type=\"conductor\"><string name=\"material\" value=\"{name}\"/></bsdf>")
    };
    let glass = r#"<bsdf type="dielectric"><string name="int_ior" value="glas"/></bsdf>"#;
    for (content, words) in [
        (bsdf("glass"), "write `dielectric`"),
        (r#"<shape type="box"/>"#.to_owned(), "write `cube`"),
        (r#"<integrator type="pathtracer"/>"#.to_owned(), "write `path`"),
        (metal("glas"), "there is no metal `glas`"),
        (metal("bk7"), "it is a dielectric"),
        (metal("Agg"), "`Ag`"),
        (glass.to_owned(), "`bk7`, or the number 1.5"),
    ] {
        let said = refused(&scene("3.0.0", &content));
        assert!(said.contains(words), "{said}");
        assert!(said.matches('`').count() <= 2 * 12 + 8, "{said}");
    }
}

#[test]
fn unknown_plugins_are_replaced_if_asked_for() {
    let content = r#"<integrator type="mine"><integer name="max_depth" value="3"/><float name="x" value="1"/></integrator>
        <sensor type="mine"><film type="mine"><integer name="width" value="7"/><rfilter type="mine"/></film>
            <sampler type="mine"><integer name="sample_count" value="5"/></sampler></sensor>
        <shape type="sphere"><bsdf type="mine"><rgb name="a" value="1"/></bsdf></shape>
        <shape type="cube"><bsdf type="diffuse"><texture type="mine" name="reflectance"/></bsdf></shape>
        <shape type="mine"><bsdf type="diffuse"/></shape>
        <emitter type="mine"/><emitter type="constant"/>"#;
    let text = scene("3.0.0", content);
    let (loaded, _) = load_with(&text, &SceneOptions::default());
    assert!(loaded.scene.is_none(), "refused unless asked for");
    let lenient = SceneOptions { lenient: true, ..SceneOptions::default() };
    let (loaded, found) = load_with(&text, &lenient);
    let unknown = found.iter().filter(|found| found.message.starts_with("unknown")).count();
    assert_eq!((found.len(), unknown), (9, 9), "{found:?}");
    let scene = loaded.scene.expect("everything is replaced or left out").scene;
    assert_eq!(scene.sensors()[0].film.width, 7);
    let plain = r#"<sensor type="perspective"/><emitter type="constant"/>"#;
    let (_, found) = load_with(&crate::scene("3.0.0", plain), &lenient);
    assert_eq!(found, [], "nothing to replace");
}

/// A scene may name any file of the machine, so no message quotes one.
#[test]
fn nothing_of_a_file_of_another_kind_is_shown() {
    for content in [
        r#"<shape type="ply"><string name="filename" value="secret.txt"/></shape>"#,
        r#"<shape type="obj"><string name="filename" value="secret.txt"/></shape>"#,
        r#"<shape type="serialized"><string name="filename" value="secret.txt"/></shape>"#,
        r#"<shape type="linearcurve"><string name="filename" value="secret.txt"/></shape>"#,
        r#"<shape type="sdfgrid"><string name="filename" value="secret.txt"/></shape>"#,
        r#"<shape type="ellipsoids"><string name="filename" value="secret.txt"/></shape>"#,
        r#"<bsdf type="measured"><string name="filename" value="secret.txt"/></bsdf>"#,
        r#"<texture type="bitmap"><string name="filename" value="secret.txt"/></texture>"#,
        r#"<volume type="gridvolume"><string name="filename" value="secret.txt"/></volume>"#,
        r#"<emitter type="constant"><spectrum name="radiance" filename="secret.txt"/></emitter>"#,
        r#"<emitter type="envmap"><string name="filename" value="secret.txt"/></emitter>"#,
        r#"<include filename="secret.txt"/>"#,
    ] {
        let (loaded, found) = load_with(&scene("3.0.0", content), &SceneOptions::default());
        let sources = &loaded.diagnostics.sources;
        let style = ExcerptStyle::default();
        let render = |found| etendue::render_diagnostic(found, sources, style);
        let shown: String = found.iter().map(render).collect();
        assert!(found.iter().any(|found| found.severity == Severity::Error), "{content}");
        assert!(!shown.contains("SECRET"), "{shown}");
    }
}
