//! Valid and hostile scenes built in code.

use glam::{DMat4, DVec3};

use crate::*;

fn build(scene: Node) -> (Document, Vec<Diagnostic>) {
    let diagnostics = Diagnostics::new();
    let document = Document::build(scene, &DocumentOptions::default(), &diagnostics);
    (document, diagnostics.sorted())
}

/// Every finding as a path and a message.
fn findings(scene: Node) -> Vec<(String, String)> {
    let (document, found) = build(scene);
    let place = |found: &Diagnostic| {
        let span = found.span.expect("every finding has a place");
        document.sources.locate(span).to_string()
    };
    found.iter().map(|found| (place(found), found.message.clone())).collect()
}

fn one_finding(scene: Node) -> (String, String) {
    let mut found = findings(scene);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

#[test]
fn a_tree_becomes_a_flat_document_in_the_order_of_the_code() {
    let glass = Node::bsdf("dielectric").id("glass").with("int_ior", 1.5);
    let placed = DMat4::from_translation(DVec3::X);
    let ball = Node::shape("sphere")
        .with("to_world", placed)
        .with("flip", true)
        .child(reference("glass"))
        .with("interior", Node::medium("homogeneous").child(Node::phase("hg")));
    let (document, found) = build(Node::scene().child(ball).child(glass));
    assert_eq!(found, []);
    let plugins: Vec<&str> = document.nodes.iter().map(|node| node.plugin.as_str()).collect();
    assert_eq!(plugins, ["scene", "sphere", "homogeneous", "hg", "dielectric"]);
    let ball = document.node(NodeId(1));
    assert_eq!(ball.parameters[0].value, Value::transform(placed));
    assert_eq!(ball.parameters[1].value, Value::Boolean(true));
    let children: Vec<_> = ball.children.iter().map(|c| (c.name.as_deref(), c.node)).collect();
    assert_eq!(children, [(None, NodeId(4)), (Some("interior"), NodeId(2))]);
    assert_eq!(document.find("glass"), Some(NodeId(4)));
    assert_eq!(document.find("wood"), None);
}

#[test]
fn every_place_has_a_path() {
    let shape = |alpha: f64| {
        let bsdf = Node::bsdf("roughplastic").with("alpha", alpha);
        Node::shape("sphere").child(Node::bsdf("twosided").with("nested", bsdf))
    };
    let scene =
        Node::scene().child(shape(0.1)).child(Node::emitter("constant")).child(shape(f64::NAN));
    let (path, message) = one_finding(scene);
    assert_eq!(path, "scene.shapes[1].bsdf.nested.alpha");
    assert_eq!(message, "`alpha` must be finite, but holds NaN or an infinity");
}

#[test]
fn findings_show_the_path_where_texts_show_an_excerpt() {
    let (document, found) = build(Node::scene().child(Node::shape("").with("a", f64::NAN)));
    let shown: String = found
        .iter()
        .map(|found| render_diagnostic(found, &document.sources, ExcerptStyle::default()))
        .collect();
    let expected = "\
error: this shape names no plugin
 = at scene.shape
error: `a` must be finite, but holds NaN or an infinity
 = at scene.shape.a
";
    assert_eq!(shown, expected);
}

#[test]
fn unknown_and_repeated_ids_are_reported() {
    let scene = Node::scene()
        .child(Node::bsdf("diffuse").id("wood"))
        .child(Node::bsdf("plastic").id("wood"))
        .child(Node::shape("sphere").with("bsdf", reference("woood")));
    let (document, found) = build(scene);
    let messages: Vec<&str> = found.iter().map(|found| found.message.as_str()).collect();
    assert_eq!(
        messages,
        ["the id `wood` is given twice", "there is no object with the id `woood`"]
    );
    let shown = render_diagnostic(&found[0], &document.sources, ExcerptStyle::default());
    assert!(shown.contains("at scene.bsdfs[1]\n"), "{shown}");
    assert!(shown.contains("at scene.bsdfs[0]: given here before"), "{shown}");
    assert_eq!(found[1].help, ["did you mean `wood`?"]);
    assert!(document.incomplete.contains(&NodeId(3)));
    assert_eq!(document.node(NodeId(3)).children.len(), 0);
}

#[test]
fn references_that_form_a_cycle_are_cut() {
    let sided = |id: &str, inner: &str| Node::bsdf("twosided").id(id).child(reference(inner));
    let scene = Node::scene().child(sided("a", "b")).child(sided("b", "a")).child(sided("c", "c"));
    let found = findings(scene.clone());
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().all(|(_, message)| message.contains("in a circle")), "{found:?}");
    let (document, _) = build(scene);
    let has_children = |id: &str| {
        let id = document.find(id).expect("it is kept");
        !document.node(id).children.is_empty()
    };
    assert_eq!(["a", "b", "c"].map(has_children), [true, false, false]);
}

#[test]
fn of_several_entries_with_one_name_the_last_counts() {
    let texture = Node::texture("checkerboard");
    let bsdf = Node::bsdf("diffuse").with("reflectance", texture).with("reflectance", 0.5);
    let (path, message) = one_finding(Node::scene().child(bsdf.clone()));
    assert_eq!(path, "scene.bsdf.reflectance");
    assert_eq!(message, "`reflectance` is given twice; the last one counts");
    let (document, _) = build(Node::scene().child(bsdf));
    assert_eq!((document.nodes.len(), document.nodes[1].parameters.len()), (2, 1));
}

#[test]
fn a_chain_of_ten_thousand_nodes_is_refused() {
    let chain = |length: usize| {
        (0..length).fold(Node::bsdf("diffuse"), |inner, _| Node::bsdf("twosided").child(inner))
    };
    for length in [100, 10_000] {
        let found = findings(Node::scene().child(chain(length)));
        assert!(!found.is_empty());
        let (document, found) = build(Node::scene().child(chain(length)));
        assert!(found.iter().all(|found| found.fault == Fault::Limit), "{found:?}");
        assert!(document.nodes.len() <= 130);
    }
    assert_eq!(findings(Node::scene().child(chain(40))), []);
}

#[test]
fn expansions_and_numbers_of_nodes_are_bounded() {
    let doubled = |index: usize| {
        let next = format!("n{}", index + 1);
        let node = Node::bsdf("blendbsdf").id(&format!("n{index}"));
        node.child(reference(&next)).child(reference(&next))
    };
    let scene = Node::scene().children((0..40).map(doubled)).child(Node::bsdf("diffuse").id("n40"));
    assert!(findings(scene).iter().all(|(_, message)| message.contains("more than 1000000")));

    let limits = DocumentLimits { nodes: 10, ..DocumentLimits::default() };
    let options = DocumentOptions { limits, ..DocumentOptions::default() };
    let diagnostics = Diagnostics::new();
    let scene = Node::scene().children((0..1000).map(|_| Node::shape("sphere")));
    let document = Document::build(scene, &options, &diagnostics);
    assert_eq!((document.nodes.len(), diagnostics.error_count()), (10, 1));
    assert_eq!(diagnostics.sorted()[0].message, "more than 10 objects");
}

#[test]
fn a_million_instances_stay_small() {
    let count: usize = 1_000_000;
    let instance = |index: usize| {
        let place = DMat4::from_translation(DVec3::splat(index as f64));
        Node::shape("instance").with("to_world", place).child(reference("group"))
    };
    let group = Node::shape("shapegroup").id("group").child(Node::shape("cube"));
    let (document, found) = build(Node::scene().child(group).children((0..count).map(instance)));
    assert_eq!(found, []);
    assert_eq!(document.nodes.len(), count + 3);
    let instance = &document.nodes[count];
    assert_eq!(instance.children[0].node, NodeId(1));
    // Inline storage: one parameter and one child need no allocation.
    assert!(size_of_val(&document.nodes[..]) <= 208 * (count + 3));
}

#[test]
fn a_root_that_is_no_scene_is_refused() {
    let found = findings(Node::bsdf("diffuse"));
    assert_eq!(found, [("bsdf".to_owned(), "the root is a bsdf, not a scene".to_owned())]);
}

#[test]
fn buffers_are_shared_with_the_document() {
    let positions = Buffer::from(vec![[0.0_f32, 0.0, 0.0]; 3]);
    let mesh = Node::shape("mesh").with("positions", positions.clone());
    let (mut document, found) = build(Node::scene().child(mesh));
    assert_eq!(found, []);
    let diagnostics = Diagnostics::new();
    {
        let parameters = document.parameters(NodeId(1), &diagnostics);
        assert_eq!(parameters.buffer("positions"), Some(&positions));
        assert!(parameters.buffer("indices").is_none());
        parameters.finish();
    }
    document.set(NodeId(1), "positions", 1.0);
    document.set(NodeId(1), "vertex_color", vec![0.5_f32; 3]);
    let parameters = document.parameters(NodeId(1), &diagnostics);
    assert!(parameters.buffer("positions").is_none());
    let attributes = parameters.buffers_with_prefix("vertex_");
    assert_eq!(attributes.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["vertex_color"]);
    parameters.finish();
    let found = diagnostics.sorted();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].message, "`positions` must be a buffer, not a number");
}
