//! Includes, folders and whole files.

use std::path::Path;

use etendue_document::Fault::{Io, Limit, Syntax};
use etendue_document::{
    Diagnostics, ExcerptStyle, MemoryResources, Severity, Value, render_diagnostic,
};
use etendue_mitsuba::{Limits, LoadOptions, read_file};

use super::{Loaded, names, nested, object, value};

fn files(files: &[(&str, &str)]) -> MemoryResources {
    let mut resources = MemoryResources::default();
    for (path, text) in files {
        resources.insert(*path, *text);
    }
    resources
}

fn load_files(resources: &MemoryResources, path: &str) -> Loaded {
    let options = LoadOptions { working_directory: "/home".into(), ..LoadOptions::default() };
    let diagnostics = Diagnostics::new();
    let document = read_file(Path::new(path), resources, &options, &diagnostics);
    Loaded { document: document.expect("it is a scene"), diagnostics }
}

#[test]
fn an_included_scene_stands_in_the_place_of_its_include() {
    let resources = files(&[
        (
            "/s/main.xml",
            "<scene version='3.0.0'><default name='n' value='1'/><shape type='a'/>
             <include filename='parts/more.xml'/><shape type='c$m'><ref id='mat'/></shape></scene>",
        ),
        (
            "/s/parts/more.xml",
            "<scene version='2.0.0'><default name='m' value='9'/><default name='n' value='2'/>
             <shape type='b$n'><string name='filename' value='mesh.obj'/></shape>
             <include filename='material.xml'/></scene>",
        ),
        ("/s/parts/material.xml", "<bsdf version='3.0.0' type='diffuse' id='mat'/>"),
        ("/s/parts/mesh.obj", ""),
    ]);
    let loaded = load_files(&resources, "/s/main.xml");
    assert_eq!(loaded.findings(), [], "{}", loaded.shown());
    let document = &loaded.document;
    let plugins: Vec<&str> = (0..4).map(|index| object(document, index).plugin.as_str()).collect();
    assert_eq!(plugins, ["a", "b1", "diffuse", "c9"], "defaults go in and come out");
    assert_eq!(nested(document, object(document, 3), 0).id.as_deref(), Some("mat"));
    let mesh = &object(document, 1).parameters[0];
    let found = document.resolve("mesh.obj", mesh.span, &resources);
    assert_eq!(found, Ok("/s/parts/mesh.obj".into()), "relative to the file that names it");
    let place = document.sources.locate(mesh.span).to_string();
    assert!(place.starts_with("/s/parts/more.xml:"), "{place}");
}

#[test]
fn path_entries_and_paths_relative_to_the_working_directory() {
    let resources = files(&[
        ("/home/s/main.xml", "<scene><path value='../common'/><shape type='obj'/></scene>"),
        ("/home/common/mesh.obj", ""),
    ]);
    let loaded = load_files(&resources, "s/main.xml");
    assert_eq!(loaded.findings(), []);
    let shape = object(&loaded.document, 0);
    let found = loaded.document.resolve("mesh.obj", shape.span, &resources);
    assert_eq!(found, Ok("/home/common/mesh.obj".into()));
    let place = loaded.document.sources.locate(shape.span).to_string();
    assert!(place.starts_with("s/main.xml:"), "{place}: as the user says it");
}

#[test]
fn loops_of_includes_show_the_way() {
    let resources = files(&[
        ("/s/a.xml", "<scene>\n<include filename='b.xml'/></scene>"),
        ("/s/b.xml", "<scene>\n\n<include filename='a.xml'/></scene>"),
    ]);
    for path in ["/s/a.xml", "/s/./x/../a.xml"] {
        let loaded = load_files(&resources, path);
        assert_eq!(loaded.findings(), [(Severity::Error, Syntax, 3)], "{}", loaded.shown());
        assert_eq!(loaded.messages(), ["/s/a.xml includes itself"]);
        let related = &loaded.diagnostics.sorted()[0].related;
        assert_eq!(related[0].message, "/s/b.xml is included here");
        assert_eq!(loaded.document.sources.locate(related[0].span).line(), Some(2));
    }
}

#[test]
fn the_same_file_may_be_included_twice() {
    let resources = files(&[
        ("/a.xml", "<scene><include filename='b.xml'/><include filename='b.xml'/></scene>"),
        ("/b.xml", "<scene><shape type='sphere'/></scene>"),
    ]);
    let loaded = load_files(&resources, "/a.xml");
    assert_eq!(loaded.findings(), []);
    assert_eq!(loaded.document.node(loaded.document.root).children.len(), 2);
}

#[test]
fn includes_that_double_at_every_step_are_bounded() {
    let mut resources = MemoryResources::default();
    for index in 0..15 {
        let next = format!("<include filename='f{}.xml'/>", index + 1);
        resources.insert(format!("/f{index}.xml"), format!("<scene>{next}{next}</scene>"));
    }
    resources.insert("/f15.xml", "<scene/>");
    let loaded = load_files(&resources, "/f0.xml");
    assert!(
        loaded
            .findings()
            .iter()
            .all(|(severity, fault, _)| { (*severity, *fault) == (Severity::Error, Limit) })
    );
    assert!(loaded.diagnostics.has_errors());
}

#[test]
fn the_bytes_of_all_files_are_bounded() {
    let text = "<scene>\n<include filename='a.xml'/></scene>";
    let resources = files(&[("/m.xml", text), ("/a.xml", "<scene>                    </scene>")]);
    let limits = Limits { total_bytes: 50, ..Limits::default() };
    let options = LoadOptions { limits, ..LoadOptions::default() };
    let diagnostics = Diagnostics::new();
    let document = read_file(Path::new("/m.xml"), &resources, &options, &diagnostics).unwrap();
    let loaded = Loaded { document, diagnostics };
    assert_eq!(loaded.findings(), [(Severity::Error, Limit, 2)]);
}

#[test]
fn a_missing_include_says_where_it_was_sought_and_the_rest_goes_on() {
    let resources = files(&[
        ("/s/m.xml", "<scene><include filename='parts/bas.xml'/><shape type='sphere'/></scene>"),
        ("/s/parts/base.xml", "<scene/>"),
    ]);
    let loaded = load_files(&resources, "/s/m.xml");
    assert_eq!(loaded.findings(), [(Severity::Error, Io, 1)]);
    let help = &loaded.diagnostics.sorted()[0].help;
    assert_eq!(help[0], "there is `base.xml`");
    assert_eq!(help[1], "looked for it in\n/s\n/home\n/");
    assert_eq!(object(&loaded.document, 0).plugin, "sphere");
}

#[test]
fn a_broken_include_is_reported_in_its_own_file() {
    let resources = files(&[
        ("/s/m.xml", "<scene><include filename='a.xml'/><shape type='sphere'/></scene>"),
        ("/s/a.xml", "<scene>\n<shape type='x'>\n</scene>"),
    ]);
    let loaded = load_files(&resources, "/s/m.xml");
    assert_eq!(loaded.findings(), [(Severity::Error, Syntax, 3)]);
    assert!(loaded.shown().contains("/s/a.xml:3:"), "{}", loaded.shown());
    assert_eq!(object(&loaded.document, 0).plugin, "sphere");
}

#[test]
fn a_missing_scene_has_no_place() {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default();
    let path = Path::new("/none.xml");
    assert!(read_file(path, &resources, &LoadOptions::default(), &diagnostics).is_err());
    let found = diagnostics.sorted();
    assert_eq!((found[0].fault, found[0].span), (Io, None));
    let text = render_diagnostic(
        &found[0],
        &etendue_document::Sources::default(),
        ExcerptStyle::default(),
    );
    assert_eq!(text, "error: cannot read /none.xml: no such file\n");
}

/// An original scene in the dialect of version 0.5, with the quirks that real ones have.
const OLD: &str = include_str!("../corpus/old_dialect.xml");

#[test]
fn an_old_scene_loads_with_its_quirks_reported_and_nothing_else() {
    let resources = files(&[
        ("/r/testcases/room/scene.xml", OLD),
        ("/r/testcases/room/models/Mesh000.obj", ""),
    ]);
    let loaded = load_files(&resources, "/r/testcases/room/scene.xml");
    assert_eq!(
        loaded.messages(),
        [
            "`strictNormals` is dropped, as in version 3: `strict_normals` asks for it",
            "a `perspective` with `apertureRadius` is a `thinlens`",
            "references to `Cushion` get the `bumpmap` around it, which has no id of its own",
            "the texture filter `trilinear` is rendered as `bilinear`, without levels",
        ]
    );
    let document = &loaded.document;
    let sensor = object(document, 1);
    assert_eq!(sensor.plugin, "thinlens");
    assert_eq!(names(sensor), ["fov", "to_world", "focus_distance", "aperture_radius"]);
    let shape = object(document, 4);
    assert_eq!(value(shape, "face_normals"), &Value::Boolean(true));
    let mesh = shape.parameters[0].span;
    let found = document.resolve("testcases/room/models/Mesh000.obj", mesh, &resources);
    assert_eq!(found, Ok("/r/testcases/room/models/Mesh000.obj".into()));
}
