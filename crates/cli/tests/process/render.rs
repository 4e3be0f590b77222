//! `etendue render`: outputs, options, and identical results for any number of threads.

use std::fs;

use etendue::image::{MetadataValue, Picture, Window, decode_exr_layers};

use crate::run::{Workplace, small_scene, test_file};

fn exr(workplace: &Workplace, name: &str) -> Picture {
    decode_exr_layers(&workplace.read(name)).unwrap()
}

#[test]
fn the_default_outputs_are_exr_and_png_in_the_working_directory() {
    let workplace = Workplace::new();
    let outcome = workplace.succeed(&["render", &small_scene()]);
    assert_eq!(workplace.files(), ["small.exr", "small.png"]);
    assert_eq!(outcome.stdout, "", "results go to files, messages to standard error");
    assert!(outcome.stderr.contains("small.exr, small.png: 40x24, 4 samples per pixel"));
    let picture = exr(&workplace, "small.exr");
    assert_eq!((picture.width, picture.height), (40, 24));
    let main = picture.main_layer().unwrap();
    assert!(!main.is_grey && main.alpha.is_none());
}

#[test]
fn several_outputs_hold_the_same_picture() {
    let workplace = Workplace::new();
    let names = ["a.exr", "b.png", "c.jpg", "d.hdr", "e.pfm", "f.bmp", "g.tiff", "h.EXR"];
    let scene = small_scene();
    let mut arguments = vec!["render", &scene, "-q"];
    for name in names {
        arguments.extend(["-o", name]);
    }
    workplace.succeed(&arguments);
    let mut expected: Vec<_> = names.iter().map(|name| (*name).to_owned()).collect();
    expected.sort();
    assert_eq!(workplace.files(), expected);
    assert_eq!(workplace.read("a.exr"), workplace.read("h.EXR"));
    for name in &names[1..7] {
        let bytes = workplace.read(name);
        let bitmap = etendue::image::decode(&bytes, name).unwrap();
        assert_eq!((bitmap.width, bitmap.height), (40, 24), "{name}");
    }
}

#[test]
fn an_output_folder_gets_the_default_names() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("out")).unwrap();
    workplace.succeed(&["render", &small_scene(), "-q", "-o", "out"]);
    assert!(workplace.path("out/small.exr").is_file());
    assert!(workplace.path("out/small.png").is_file());
    assert_eq!(workplace.files(), ["out"]);
}

#[test]
fn several_scenes_are_rendered_in_one_run() {
    let workplace = Workplace::new();
    fs::copy(small_scene(), workplace.path("other.xml")).unwrap();
    workplace.succeed(&["render", &small_scene(), "other.xml", "-q"]);
    assert_eq!(
        workplace.files(),
        ["other.exr", "other.png", "other.xml", "small.exr", "small.png"]
    );
    workplace.fail(&["render", &small_scene(), "other.xml", "-o", "a.exr"]);
    workplace.fail(&["render", &small_scene(), &small_scene()]);
}

#[test]
fn the_other_scenes_are_rendered_despite_a_broken_one() {
    let workplace = Workplace::new();
    let broken = test_file("broken/empty.xml");
    let outcome = workplace.run(&["render", &broken, &small_scene(), "-q"]);
    assert_eq!(outcome.code, Some(2));
    assert_eq!(workplace.files(), ["small.exr", "small.png"]);
}

#[test]
fn the_picture_does_not_depend_on_the_number_of_threads() {
    let workplace = Workplace::new();
    let render = |threads: &str| {
        let arguments = ["render", &small_scene(), "-q", "-t", threads, "--variance"];
        workplace.succeed(&[&arguments[..], &["-o", "a.exr"]].concat());
        exr(&workplace, "a.exr").channels
    };
    let one = render("1");
    assert_eq!(one.len(), 6);
    assert_eq!(one, render("2"));
    assert_eq!(one, render("5"));
}

#[test]
fn the_picture_does_not_depend_on_the_cpu_instructions() {
    let workplace = Workplace::new();
    let scenes = ["cornell-box", "glass-and-metal", "soft-shadows", "textures", "cups"];
    for name in scenes {
        let scene = format!("{}/../../scenes/{name}/scene.xml", env!("CARGO_MANIFEST_DIR"));
        let render = |more: &[&str]| {
            let arguments =
                ["render", &scene, "-q", "--size", "48x27", "--spp", "4", "-o", "a.pfm"];
            workplace.succeed(&[&arguments[..], more].concat());
            workplace.read("a.pfm")
        };
        assert_eq!(render(&[]), render(&["--portable"]), "{name}");
    }
}

#[test]
fn another_seed_gives_other_noise() {
    let workplace = Workplace::new();
    let render = |seed: &str| {
        workplace.succeed(&["render", &small_scene(), "-q", "--seed", seed, "-o", "a.pfm"]);
        workplace.read("a.pfm")
    };
    let first = render("1");
    assert_eq!(first, render("1"));
    assert_ne!(first, render("2"));
}

#[test]
fn the_header_describes_the_render() {
    let workplace = Workplace::new();
    let arguments =
        ["render", &small_scene(), "-q", "--spp", "3", "--seed", "18446744073709551615"];
    workplace.succeed(&arguments);
    let picture = exr(&workplace, "small.exr");
    assert_eq!(picture.metadata("samplesPerPixel"), Some(&MetadataValue::Integer(3)));
    let text = |name: &str| match picture.metadata(name) {
        Some(MetadataValue::Text(text)) => text.clone(),
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!(text("seed"), u64::MAX.to_string());
    assert!(text("software").starts_with("Etendue "));
    assert_eq!(text("sceneHash").len(), 64);
    assert!(matches!(picture.metadata("renderSeconds"), Some(MetadataValue::Float(s)) if *s > 0.0));
    let Some(MetadataValue::Matrix4(matrix)) = picture.metadata("worldToCamera") else {
        panic!("no camera matrix");
    };
    // The last row is the translation: the origin of the world lies √26 in front of the camera.
    assert!((matrix[14] - 26_f32.sqrt()).abs() < 1e-4, "{matrix:?}");
    assert!(picture.metadata("chromaticities").is_some());
}

#[test]
fn the_scene_hash_depends_only_on_the_content() {
    let workplace = Workplace::new();
    let hash = |arguments: &[&str]| {
        workplace.succeed(&[&["render", "-q", "--spp", "1", "-o", "a.exr"], arguments].concat());
        exr(&workplace, "a.exr").metadata("sceneHash").cloned()
    };
    let own = hash(&[&small_scene()]);
    assert!(own.is_some());
    let text = fs::read_to_string(small_scene()).unwrap();
    fs::write(workplace.path("copy.xml"), &text).unwrap();
    assert_eq!(own, hash(&["copy.xml"]), "the same content elsewhere");
    fs::write(workplace.path("copy.xml"), text.replace("0.5", "0.6")).unwrap();
    assert_ne!(own, hash(&["copy.xml"]));
}

#[test]
fn options_take_effect() {
    let workplace = Workplace::new();
    let render = |arguments: &[&str]| {
        let scene = small_scene();
        workplace.succeed(&[&["render", &scene, "-q", "-o", "a.exr"], arguments].concat());
        exr(&workplace, "a.exr")
    };
    let size = |picture: &Picture| (picture.width, picture.height);
    let plain = render(&[]);
    assert_eq!(size(&render(&["--size", "10x6"])), (10, 6));
    assert_eq!(size(&render(&["-s", "1"])), (20, 20));
    assert_eq!(render(&["-s", "1"]).channels, render(&["-s", "side"]).channels);

    let crop = render(&["--crop", "10,5,12,8"]);
    assert_eq!((size(&crop), crop.data_origin), ((12, 8), [10, 5]));
    assert_eq!(crop.display_window, Window { x: 0, y: 0, width: 40, height: 24 });
    for (index, value) in crop.channels[0].data.iter().enumerate() {
        let whole = &plain.channels[0].data[(index / 12 + 5) * 40 + index % 12 + 10];
        assert_eq!(value, whole, "a crop is the same picture, cut out");
    }

    let changes: [&[&str]; 5] = [
        &["-D", "grey=0.1"],
        &["--filter", "box"],
        &["--integrator", "depth"],
        &["--no-emitter-sampling"],
        &["--spp", "7"],
    ];
    for change in changes {
        assert_ne!(render(change).channels, plain.channels, "{change:?}");
    }
}

#[test]
fn invalid_arguments_are_rejected_before_rendering() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let cases: [(&[&str], &str); 17] = [
        (&["-o", "a.xyz"], "`.xyz`"),
        (&["-o", "a"], "extension"),
        (&["-o", "nowhere/a.exr"], "nowhere"),
        (&["-o", "a.exr", "-o", "b.gif"], "`.gif`"),
        (&["--spp", "0"], "--spp"),
        (&["--spp", "many"], "--spp"),
        (&["--size", "40"], "--size"),
        (&["--size", "2000000000x2000000000"], "2000000000"),
        (&["--crop", "1,2,3"], "--crop"),
        (&["--crop", "30,20,40,40"], "40x24"),
        (&["--time", "soon"], "--time"),
        (&["-s", "5"], "0 (`front`), 1 (`side`)"),
        (&["-s", "top"], "0 (`front`), 1 (`side`)"),
        (&["--integrator", "magic"], "magic"),
        (&["--filter", "magic"], "magic"),
        (&["-t", "0"], "--threads"),
        (&["-D", "grey"], "NAME=VALUE"),
    ];
    for (arguments, message) in cases {
        let outcome = workplace.fail(&[&["render", &scene], arguments].concat());
        assert!(outcome.stderr.contains(message), "{arguments:?}: {}", outcome.stderr);
    }
    workplace.fail(&["render"]);
    workplace.fail(&["paint", &scene]);
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_rejected_before_rendering() {
    let workplace = Workplace::new();
    let outcome = workplace.fail(&["render", &small_scene(), "-o", "/proc/a.exr"]);
    assert!(outcome.stderr.contains("/proc/a.exr"), "{}", outcome.stderr);
}

#[test]
fn an_old_output_is_replaced() {
    let workplace = Workplace::new();
    fs::write(workplace.path("a.pfm"), "old").unwrap();
    workplace.succeed(&["render", &small_scene(), "-q", "-o", "a.pfm"]);
    assert!(workplace.read("a.pfm").starts_with(b"PF"));
    assert_eq!(workplace.files(), ["a.pfm"]);
}

#[test]
fn quiet_prints_nothing_and_verbose_prints_more() {
    let workplace = Workplace::new();
    let quiet = workplace.succeed(&["render", &small_scene(), "-q"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    let verbose = workplace.succeed(&["render", &small_scene(), "-v"]);
    assert!(verbose.stderr.contains("passes in"), "{}", verbose.stderr);
    workplace.fail(&["render", &small_scene(), "-q", "-v"]);
}

#[test]
fn without_a_terminal_there_are_no_escape_codes_and_progress_is_lines() {
    let workplace = Workplace::new();
    let outcome = workplace.succeed(&["render", &small_scene(), "--time", "3s", "-o", "a.png"]);
    assert!(!outcome.stderr.contains('\x1b'), "{:?}", outcome.stderr);
    let lines: Vec<&str> = outcome.stderr.lines().collect();
    assert!(lines.len() >= 3, "{:?}", outcome.stderr);
    assert!(lines[0].starts_with("memory: "), "{:?}", outcome.stderr);
    assert!(lines[1].contains(" %  ") && lines[1].contains("samples/s"), "{:?}", outcome.stderr);
    assert!(lines[1].contains("left"), "{:?}", outcome.stderr);
}

#[test]
fn one_sample_can_be_replayed() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let outcome = workplace.succeed(&["render", &scene, "--replay", "20,12,3"]);
    assert!(outcome.stdout.contains("pixel 20,12  sample 3"), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("radiance"), "{}", outcome.stdout);
    assert_eq!(workplace.files(), [""; 0]);
    let again = workplace.succeed(&["render", &scene, "--replay", "20,12,3", "-t", "1"]);
    assert_eq!(outcome.stdout, again.stdout);
    workplace.fail(&["render", &scene, "--replay", "40,12,3"]);
}

#[test]
fn help_lists_the_exit_codes() {
    for arguments in [&["--help"][..], &["render", "--help"]] {
        let outcome = Workplace::new().succeed(arguments);
        for code in ["0 ", "1 ", "2 ", "130", "143"] {
            assert!(outcome.stdout.contains(&format!("\n  {code}")), "{}", outcome.stdout);
        }
    }
    assert!(Workplace::new().succeed(&["--version"]).stdout.starts_with("etendue "));
}

#[test]
fn exposure_and_tone_curve_change_what_is_shown_and_nothing_else() {
    let workplace = Workplace::new();
    let render = |more: &[&str]| {
        let scene = small_scene();
        let names = ["-o", "a.png", "-o", "a.exr", "-o", "a.hdr"];
        workplace.succeed(&[&["render", &scene, "-q"], &names[..], more].concat());
        let png = etendue::image::decode(&workplace.read("a.png"), "").unwrap();
        let mean = png.to_linear().iter().sum::<f32>() / png.to_linear().len() as f32;
        (mean, exr(&workplace, "a.exr").channels, workplace.read("a.hdr"))
    };
    let (plain, values, hdr) = render(&[]);
    for (more, expected) in [
        (&["--exposure", "-2"][..], 0.25 * plain),
        (&["--exposure", "0", "--tonemap", "none"], plain),
    ] {
        let (mean, other, other_hdr) = render(more);
        assert!((mean - expected).abs() < 0.01 * plain, "{more:?}: {mean} {expected}");
        assert!(other == values && other_hdr == hdr, "{more:?}");
    }
    for curve in ["aces", "agx", "filmic"] {
        let (mean, other, _) = render(&["--tonemap", curve]);
        assert!((mean - plain).abs() > 0.02 * plain, "{curve}: {mean} {plain}");
        assert!(other == values, "{curve}");
    }
    workplace.fail(&["render", &small_scene(), "--exposure", "inf", "-o", "b.png"]);
}

/// Two rectangles whose edge crosses pixels, and their indices.
const INDICES: &str = r#"<scene version="3.0.0">
  <integrator type="aov"><string name="aovs" value="shape:shape_index, prim_index, depth"/>
    <integrator type="path"/></integrator>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0.03, 0.05, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="20"/>
      <rfilter type="gaussian"/></film>
    <sampler type="independent"><integer name="sample_count" value="16"/></sampler>
  </sensor>
  <emitter type="constant"/>
  <shape type="rectangle"><transform name="to_world"><rotate z="1" angle="20"/></transform></shape>
  <shape type="sphere"><float name="radius" value="0.7"/></shape>
</scene>"#;

#[test]
fn indices_are_whole_numbers_whatever_the_division_of_samples() {
    let workplace = Workplace::new();
    fs::write(workplace.path("s.xml"), INDICES).unwrap();
    workplace.succeed(&["render", "s.xml", "-q", "-o", "a.exr", "-t", "1"]);
    let whole = exr(&workplace, "a.exr");
    for (name, most) in [("shape.I", 2.0), ("prim_index.I", 1.0)] {
        let data = &whole.channel(name).unwrap().data;
        assert!(data.iter().all(|value| value.fract() == 0.0 && *value <= most), "{name}");
        assert!(data.contains(&0.0) && data.contains(&most), "{name}");
    }
    // Distances are still means: some pixel on the edge lies between.
    let depth = &whole.channel("depth.T").unwrap().data;
    assert!(depth.iter().any(|value| *value > 0.1 && *value < 3.0));
    for (samples, name) in [("0..5", "0.part"), ("5..16", "1.part")] {
        workplace.succeed(&["render", "s.xml", "-q", "--samples", samples, "-o", name]);
    }
    workplace.succeed(&["merge", "-q", "1.part", "0.part", "-o", "b.exr"]);
    assert_eq!(exr(&workplace, "b.exr").channels, whole.channels);
}

/// A lamp of radiance 10³⁰ that is seen through a wide filter.
const BRIGHT: &str = r#"<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0"
    up="0, 1, 0"/></transform><film type="hdrfilm"><integer name="width" value="16"/>
    <integer name="height" value="16"/></film>
    <sampler type="independent"><integer name="sample_count" value="8"/></sampler></sensor>
  <shape type="sphere"><emitter type="area"><rgb name="radiance" value="1e30"/></emitter></shape>
</scene>"#;

#[test]
fn variances_beyond_single_precision_are_clamped_and_said() {
    let workplace = Workplace::new();
    fs::write(workplace.path("s.xml"), BRIGHT).unwrap();
    let outcome = workplace.succeed(&["render", "s.xml", "--variance", "-o", "a.exr"]);
    assert!(outcome.stderr.contains("beyond single precision"), "{}", outcome.stderr);
    let picture = exr(&workplace, "a.exr");
    let variance = &picture.channel("variance.R").unwrap().data;
    assert!(variance.contains(&f32::MAX) && variance.iter().all(|value| value.is_finite()));
}

/// A wall lit evenly, whose texture has a colour of the primaries of BT.2020 that BT.709 lacks.
const WIDE: &str = r#"<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0"
    up="0, 1, 0"/></transform><film type="hdrfilm"><integer name="width" value="8"/>
    <integer name="height" value="8"/></film>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler></sensor>
  <emitter type="constant"/>
  <shape type="rectangle"><transform name="to_world"><scale value="9"/></transform>
    <bsdf type="diffuse"><texture type="bitmap" name="reflectance">
      <string name="filename" value="wide.exr"/><boolean name="raw" value="$raw"/></texture></bsdf>
  </shape></scene>"#;

/// Nothing but the sky, of the same picture.
const WIDE_SKY: &str = r#"<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/>
    <integer name="height" value="8"/></film></sensor>
  <emitter type="envmap"><string name="filename" value="wide.exr"/></emitter></scene>"#;

#[test]
fn textures_and_environments_of_wider_primaries_keep_their_colour() {
    let workplace = Workplace::new();
    fs::write(workplace.path("s.xml"), WIDE).unwrap();
    fs::write(workplace.path("sky.xml"), WIDE_SKY).unwrap();
    let mut texture = Picture::new(1, 1);
    for (name, value) in [("R", 0.05), ("G", 0.8), ("B", 0.05)] {
        texture.push(name, vec![value]);
    }
    let points = [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329];
    let points = MetadataValue::Chromaticities(points);
    texture.metadata.push(("chromaticities".to_owned(), points));
    let options = etendue::image::EncodeOptions::default();
    let bytes =
        etendue::image::encode(&texture, etendue::image::FileFormat::Exr, &options).unwrap();
    fs::write(workplace.path("wide.exr"), bytes).unwrap();
    let render = |arguments: &[&str]| {
        workplace.succeed(&[&["render", "-q", "-o", "a.exr"], arguments].concat());
        let picture = exr(&workplace, "a.exr");
        ["R", "G", "B"].map(|name| picture.channel(name).unwrap().data[27])
    };
    // The matrix of BT.2087, on (0.05, 0.8, 0.05). Four samples of the light have some noise.
    let expected = [-0.3907, 0.8997, -0.0255];
    for arguments in [&["s.xml", "-D", "raw=false"][..], &["sky.xml"]] {
        for (found, expected) in render(arguments).into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.01, "{arguments:?}: {found} {expected}");
        }
    }
    for (found, expected) in render(&["s.xml", "-D", "raw=true"]).into_iter().zip([0.05, 0.8, 0.05])
    {
        assert!((found - expected).abs() < 0.01, "{found} {expected}");
    }
}

#[test]
fn completions_and_the_manual_name_every_command() {
    let workplace = Workplace::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = workplace.succeed(&["completions", shell]).stdout;
        for word in ["render", "convert", "fail-above", "skip-existing"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    workplace.fail(&["completions", "cmd"]);
    let page = workplace.succeed(&["man"]).stdout;
    assert!(page.contains(".TH etendue 1"), "{page}");
    for name in ["RENDER", "MERGE", "DIFF", "COMPLETIONS"] {
        assert!(page.contains(&format!("ETENDUE {name}")), "{name}");
    }
}
