//! Media of older versions in the terms of version 3.

use etendue_document::{Class, Diagnostics, Document, FlatNode, MemoryResources, Value};
use etendue_mitsuba::{LoadOptions, read_text};
use glam::DVec3;

use super::{clean, names, nested, object, value};

/// A scene of version 0.6.
fn old(content: &str) -> Document {
    let text = format!("<scene version=\"0.6.0\">\n{content}\n</scene>");
    let (resources, diagnostics) = (MemoryResources::default(), Diagnostics::new());
    read_text(&text, &resources, &LoadOptions::default(), &diagnostics).expect("it is a scene")
}

fn close(node: &FlatNode, name: &str, expected: [f64; 3]) {
    let Value::Rgb(found) = value(node, name) else { panic!("{name}: {node:?}") };
    assert!((*found - DVec3::from_array(expected)).length() < 1e-12, "{name}: {found}");
}

#[test]
fn scattering_and_absorption_become_extinction_and_albedo() {
    let document = clean(
        "<medium type='homogeneous'><rgb name='sigmaS' value='3 1 0'/><float name='sigmaA' value='1'/>
            <float name='densityMultiplier' value='4'/></medium>
         <medium type='homogeneous'><rgb name='sigmaS' value='3 1 0'/></medium>
         <medium type='homogeneous'><float name='sigmaT' value='2'/><float name='albedo' value='1'/></medium>",
    );
    let medium = object(&document, 0);
    close(medium, "sigma_t", [4.0, 2.0, 1.0]);
    close(medium, "albedo", [0.75, 0.5, 0.0]);
    assert_eq!(value(medium, "scale"), &Value::Float(4.0));
    assert_eq!(names(medium).len(), 3);
    close(object(&document, 1), "albedo", [1.0, 1.0, 0.0]);
    assert_eq!(names(object(&document, 2)), ["sigma_t", "albedo"]);
}

#[test]
fn measured_media_have_names() {
    let document = clean(
        "<medium type='homogeneous'><string name='material' value='Ketchup'/></medium>
         <medium type='homogeneous'><string name='material' value='head &amp; shoulders shampoo'/></medium>
         <medium type='homogeneous'><string name='material' value='gravel'/></medium>",
    );
    close(object(&document, 0), "sigma_t", [0.18 + 0.061, 0.07 + 0.97, 0.03 + 1.45]);
    assert_eq!(names(object(&document, 1)), ["sigma_t", "albedo"]);
    assert_eq!(names(object(&document, 2)), ["material"], "the plugin reports it");
}

#[test]
fn every_measured_medium_can_be_read() {
    let table = include_str!("../../src/upgrade/data/media.txt");
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines.len(), 47);
    for line in lines {
        let name = line.split(':').next().expect("a name").replace('&', "&amp;");
        let document = clean(&format!(
            "<medium type='homogeneous'><string name='material' value='{name}'/></medium>"
        ));
        assert_eq!(names(object(&document, 0)), ["sigma_t", "albedo"], "{name}");
    }
}

#[test]
fn heterogeneous_media_have_an_extinction() {
    let document = clean(
        "<medium type='heterogeneous'><string name='method' value='woodcock'/>
            <volume name='density' type='volcache'>
                <volume type='gridvolume'><string name='filename' value='a.vol'/>
                    <boolean name='sendData' value='false'/></volume></volume>
            <phase type='hgphase'/></medium>",
    );
    let medium = object(&document, 0);
    assert_eq!(medium.children[0].name.as_deref(), Some("sigma_t"));
    assert!(names(medium).is_empty());
    let volume = nested(&document, medium, 0);
    assert_eq!((volume.plugin.as_str(), names(volume)), ("gridvolume", vec!["filename"]));
    assert_eq!(nested(&document, medium, 1).plugin, "hg");
}

#[test]
fn mixtures_become_blends_of_two() {
    let document = clean(
        "<phase type='mixturephase'><string name='weights' value='1, 1, 2'/>
            <phase type='isotropic'/><phase type='rayleigh'/><phase type='hg'/></phase>",
    );
    let outer = object(&document, 0);
    assert_eq!(
        (outer.plugin.as_str(), value(outer, "weight")),
        ("blendphase", &Value::Float(0.75))
    );
    assert_eq!(nested(&document, outer, 0).plugin, "isotropic");
    let inner = nested(&document, outer, 1);
    assert_eq!(value(inner, "weight"), &Value::Float(2.0 / 3.0));
    assert_eq!(nested(&document, inner, 0).plugin, "rayleigh");
    assert_eq!(nested(&document, inner, 1).plugin, "hg");
}

#[test]
fn some_defaults_were_others() {
    let content = "<medium type='homogeneous'/><volume type='gridvolume'/>
        <shape type='sphere'><medium name='interior' type='heterogeneous'/></shape>
        <shape type='sphere'><medium name='interior' type='heterogeneous'/><bsdf type='dielectric'/></shape>";
    let document = old(content);
    assert_eq!(names(object(&document, 0)), ["sigma_t", "albedo"]);
    assert_eq!(value(object(&document, 1), "use_grid_bbox"), &Value::Boolean(true));
    let surface = nested(&document, object(&document, 2), 1);
    assert_eq!((surface.class, surface.plugin.as_str()), (Class::Bsdf, "null"));
    assert_eq!(nested(&document, object(&document, 3), 1).plugin, "dielectric");
    assert_eq!(object(&document, 3).children.len(), 2);
    let new = clean(content);
    assert!((0..2).all(|index| names(object(&new, index)).is_empty()));
    assert_eq!(object(&new, 2).children.len(), 1);
}
