//! Many mistakes at once: all are reported, and similar ones are shortened.

use std::fs;

use crate::case::Parts;
use crate::run::Workplace;

/// Mistakes of different kinds, one per line, each with text that its error must contain.
const MISTAKES: [(&str, &str); 7] = [
    (r#"<shape type="spherre"/>"#, "unknown shape `spherre`"),
    (r#"<shape type="sphere"><float name="radius" value="one"/></shape>"#, "`one` is not a number"),
    (r#"<shape type="sphere"><ref id="gold"/></shape>"#, "no object with the id `gold`"),
    (r#"<shape type="obj"><string name="filename" value="a.obj"/></shape>"#, "no file `a.obj`"),
    (r#"<bsdf type="roughconductor"><float name="alpha" value="-1"/></bsdf>"#, "`alpha` is -1"),
    (r#"<emitter type="spot"><float name="cutoff_angle" value="$angle"/></emitter>"#, "`$angle`"),
    (r#"<integrator type="path"><integer name="rr_depth" value="0"/></integrator>"#, "`rr_depth`"),
];

#[test]
fn one_run_reports_every_mistake_of_a_scene() {
    let lines: Vec<&str> = MISTAKES.iter().map(|(line, _)| *line).collect();
    let parts = Parts {
        sensor: r#"<float name="fov" value="180"/>"#,
        film: r#"<film type="hdrfilm"><integer name="width" value="0"/></film>"#,
        sampler: r#"<sampler type="dependent"/>"#,
        content: &lines.join("\n"),
    };
    let workplace = Workplace::new();
    fs::write(workplace.path("scene.xml"), parts.scene()).unwrap();
    let outcome = workplace.fail(&["render", "scene.xml"]);
    let of_sensor = [(2, "`fov` is 180"), (3, "`width` is 0"), (4, "unknown sampler `dependent`")];
    let of_scene = MISTAKES.iter().enumerate().map(|(index, (_, message))| (7 + index, *message));
    for (line, message) in of_sensor.into_iter().chain(of_scene) {
        let shown = outcome.stderr.split("error: ").find(|error| error.contains(message));
        let shown = shown.unwrap_or_else(|| panic!("{message} is missing: {}", outcome.stderr));
        assert!(shown.contains(&format!("scene.xml:{line}:")), "line {line}: {shown}");
    }
    assert!(outcome.stderr.ends_with("10 errors, 0 warnings\n"), "{}", outcome.stderr);
}

/// Writes a scene whose 300 mesh files are missing.
fn write_moved_scene(workplace: &Workplace) {
    let mesh = |index| {
        format!(
            "<shape type=\"obj\"><string name=\"filename\" value=\"meshes/{index:03}.obj\"/></shape>\n"
        )
    };
    let content: String = (0..300).map(mesh).collect();
    let scene = Parts { content: &content, ..Parts::default() }.scene();
    fs::write(workplace.path("scene.xml"), scene).unwrap();
}

#[test]
fn three_hundred_missing_files_fit_on_a_page() {
    let workplace = Workplace::new();
    write_moved_scene(&workplace);
    let outcome = workplace.fail(&["render", "scene.xml"]);
    let text = &outcome.stderr;
    assert!(text.lines().count() < 70, "{text}");
    assert_eq!(text.matches("looked for it in").count(), 1, "the folders are listed once: {text}");
    assert!(text.contains("295 more errors like these"), "{text}");
    assert!(text.ends_with("300 errors, 0 warnings\n"), "{text}");
    let outcome = workplace.fail(&["check", "scene.xml"]);
    for index in 0..300 {
        let name = format!("`meshes/{index:03}.obj`");
        assert!(outcome.stderr.contains(&name), "check must list every file: {name}");
    }
    let all = workplace.fail(&["check", "scene.xml", "--verbose"]);
    assert_eq!(all.stderr.matches("looked for it in").count(), 300);
}

#[test]
fn warnings_about_skipped_files_are_shortened_too() {
    let workplace = Workplace::new();
    write_moved_scene(&workplace);
    let outcome = workplace.succeed(&["render", "scene.xml", "--skip-missing", "-o", "a.pfm"]);
    assert!(outcome.stderr.contains("295 more warnings like these"), "{}", outcome.stderr);
}
