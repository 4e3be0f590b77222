//! Tests of how plugins read their nodes.

use std::collections::BTreeSet;

use glam::{DMat4, DVec3};

use crate::*;

const TEXT: &str = "bsdf alpha alpha distribution intIOR reflectance nested texture toWorld\n";

/// The span of a word of [`TEXT`].
fn place(sources: &Sources, word: &str) -> Span {
    let id = sources.iter().next().map(|_| SourceId::default()).unwrap();
    let start = TEXT.find(word).unwrap();
    Span::new(id, start..start + word.len())
}

/// A node with the given parameters, at the spans of their names, and with a `bsdf` and a `texture`
/// named `reflectance` inside it.
fn document(parameters: Vec<(&str, Value)>) -> Document {
    let mut sources = Sources::default();
    sources.add("test.xml", TEXT);
    let node = |class, plugin: &str, word: &str| FlatNode {
        class,
        plugin: plugin.into(),
        id: None,
        span: place(&sources, word),
        parameters: List::new(),
        children: List::new(),
    };
    let mut root = node(Class::Bsdf, "roughplastic", "bsdf");
    for (name, value) in parameters {
        let original_name = name.into();
        let span = place(&sources, name);
        let name = if name == "intIOR" { "int_ior" } else { name }.into();
        root.parameters.push(Parameter { name, original_name, value, span });
    }
    for (name, node, word) in [(None, 1, "nested"), (Some("reflectance"), 2, "texture")] {
        let span = place(&sources, word);
        root.children.push(Child { name: name.map(Name::from), node: NodeId(node), span });
    }
    let nested = node(Class::Bsdf, "diffuse", "nested");
    let texture = node(Class::Texture, "bitmap", "texture");
    let nodes = vec![root, nested, texture];
    Document {
        nodes,
        root: NodeId(0),
        incomplete: BTreeSet::new(),
        sources,
        resolver: Resolver::default(),
    }
}

fn messages(diagnostics: &Diagnostics) -> Vec<String> {
    diagnostics.sorted().into_iter().map(|found| found.message).collect()
}

#[test]
fn values_come_back_by_type_and_defaults_where_absent() {
    let matrix = DMat4::from_scale(DVec3::splat(2.0));
    let document = document(vec![
        ("alpha", Value::Integer(2)),
        ("distribution", Value::String("ggx".into())),
        ("intIOR", Value::Float(3.0)),
        ("reflectance", Value::Vector(DVec3::X)),
        ("toWorld", Value::transform(matrix)),
    ]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert_eq!(parameters.float("alpha", 0.1), 2.0, "an integer is a number");
    assert_eq!(parameters.integer("int_ior", 0), 3, "a whole float is an integer");
    assert_eq!(parameters.string("distribution", "beckmann"), "ggx");
    assert_eq!(parameters.point("reflectance", DVec3::ZERO), DVec3::X);
    assert_eq!(parameters.transform("toWorld"), matrix);
    assert_eq!(parameters.float("alpha_u", 0.25), 0.25);
    assert_eq!(parameters.transform("to_uv"), DMat4::IDENTITY);
    assert_eq!(parameters.points("points"), []);
    assert!(diagnostics.sorted().is_empty());
}

#[test]
fn wrong_types_and_ranges_are_errors_under_the_name_as_typed() {
    let document =
        document(vec![("alpha", Value::Float(-1.0)), ("intIOR", Value::String("bk7".into()))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert_eq!(parameters.float("int_ior", 1.5), 1.5);
    assert_eq!(parameters.float_in("alpha", 0.1, 0.0..=1.0), 0.1);
    assert_eq!(
        messages(&diagnostics),
        [
            "`alpha` is -1, but must be at least 0 and at most 1",
            "`intIOR` must be a number, not a string",
        ]
    );
    let found = &diagnostics.sorted()[1];
    assert_eq!(found.fault, Fault::BadValue);
    assert_eq!(found.span, Some(place(&document.sources, "intIOR")));
}

#[test]
fn bounds_are_shown_without_rows_of_zeros() {
    let document = document(vec![("alpha", Value::Float(1e300)), ("intIOR", Value::Integer(0))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    parameters.float_in("alpha", 0.1, 0.5..1e18);
    parameters.float_in("int_ior", 1.5, f64::MIN_POSITIVE..=1000.0);
    assert_eq!(
        messages(&diagnostics),
        [
            "`alpha` is 1e300, but must be at least 0.5 and below 1e18",
            "`intIOR` is 0, but must be above 0 and at most 1000",
        ]
    );
}

#[test]
fn choices_list_the_names() {
    let document = document(vec![("distribution", Value::String("beckman".into()))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert_eq!(parameters.choice("distribution", 7, &[("ggx", 1), ("beckmann", 2)]), 7);
    let found = &diagnostics.sorted()[0];
    assert_eq!(found.message, "`distribution` cannot be `beckman`");
    assert_eq!(found.help, ["did you mean `beckmann`?", "it can be `ggx`, `beckmann`"]);
}

#[test]
fn what_is_required_is_missed_once() {
    let document = document(vec![]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert_eq!(parameters.required_string("filename"), None);
    assert_eq!(parameters.required_float("radius"), None);
    assert!(parameters.required_child(Class::Medium).is_none());
    assert!(diagnostics.sorted().iter().all(|found| found.fault == Fault::MissingParameter));
    assert_eq!(diagnostics.error_count(), 3);
}

#[test]
fn the_last_of_two_counts_with_a_warning() {
    let document = document(vec![("alpha", Value::Float(0.1)), ("alpha", Value::Float(0.2))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert_eq!(parameters.float("alpha", 0.0), 0.2);
    parameters.unnamed_child(Class::Bsdf);
    parameters.child("reflectance");
    parameters.finish();
    assert_eq!(messages(&diagnostics), ["`alpha` is given twice; the last one counts"]);
}

#[test]
fn unread_entries_are_reported_with_near_names_and_all_names() {
    let document =
        document(vec![("alpha", Value::Float(0.1)), ("distribution", Value::Float(1.0))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    parameters.float("alpha_u", 0.1);
    parameters.finish();
    let found = diagnostics.sorted();
    assert!(found.iter().all(|found| found.fault == Fault::UnknownParameter));
    assert_eq!(
        messages(&diagnostics),
        [
            "`roughplastic` has no parameter `alpha`",
            "`roughplastic` has no parameter `distribution`",
            "`roughplastic` has no use for this bsdf",
            "`roughplastic` has no use for a texture named `reflectance`",
        ]
    );
    assert_eq!(found[0].help, ["did you mean `alpha_u`?", "`roughplastic` takes `alpha_u`"]);
    assert_eq!(found[1].help, ["`roughplastic` takes `alpha_u`"]);
}

#[test]
fn asking_whether_something_is_there_does_not_read_it() {
    let document = document(vec![("alpha", Value::Float(0.1))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert!(parameters.has("alpha") && parameters.has("reflectance") && !parameters.has("beta"));
    parameters.children_of(Class::Bsdf);
    parameters.children_of(Class::Texture);
    parameters.finish();
    assert_eq!(messages(&diagnostics), ["`roughplastic` has no parameter `alpha`"]);
}

#[test]
fn of_a_value_and_a_child_with_one_name_the_later_counts() {
    let document = document(vec![("reflectance", Value::Float(0.1))]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert!(matches!(parameters.entry("reflectance"), Some(Entry::Child(_))));
    assert!(parameters.entry("alpha").is_none());
}

#[test]
fn children_are_found_by_class_whether_named_or_not() {
    let document = document(vec![]);
    let diagnostics = Diagnostics::new();
    let parameters = document.parameters(NodeId(0), &diagnostics);
    assert_eq!(parameters.unnamed_child(Class::Bsdf).map(|child| child.node), Some(NodeId(1)));
    assert!(parameters.unnamed_child(Class::Bsdf).is_none(), "it is given out once");
    assert_eq!(parameters.unnamed_child(Class::Texture).map(|child| child.node), Some(NodeId(2)));
    parameters.finish();
    assert!(diagnostics.sorted().is_empty());
}
