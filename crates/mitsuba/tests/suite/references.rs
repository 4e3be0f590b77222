//! References, aliases, ids, and the wrapper without an id.

use etendue_document::Fault::{Approximation, BadValue, Limit};
use etendue_document::NodeId;
use etendue_document::Severity::{Error, Note};

use super::{child_ids, clean, load, nested, object};

#[test]
fn references_reach_back_and_forward_and_share_the_node() {
    let document = clean(
        "<bsdf type='diffuse' id='before'/>
         <shape type='a'><ref id='before'/><ref name='interior' id='after'/></shape>
         <shape type='b'><ref id='before'/></shape>
         <medium type='homogeneous' id='after'/>",
    );
    let scene = child_ids(document.node(document.root));
    let shape = object(&document, 1);
    assert_eq!(child_ids(shape), [scene[0], scene[3]]);
    assert_eq!(shape.children[1].name.as_deref(), Some("interior"));
    assert_eq!(child_ids(object(&document, 2)), [scene[0]]);
}

#[test]
fn references_keep_their_place_among_nested_objects() {
    let document = clean(
        "<bsdf type='blendbsdf'><ref id='x'/><bsdf type='second'/></bsdf>
         <bsdf type='first' id='x'/>",
    );
    let blend = object(&document, 0);
    assert_eq!(nested(&document, blend, 0).plugin, "first");
    assert_eq!(nested(&document, blend, 1).plugin, "second");
}

#[test]
fn nested_objects_with_ids_can_be_referred_to() {
    let document = clean(
        "<shape type='a'><bsdf type='diffuse' id='inner'/></shape>
         <shape type='b'><ref id='inner'/></shape>",
    );
    assert_eq!(child_ids(object(&document, 0)), child_ids(object(&document, 1)));
}

#[test]
fn aliases_stand_for_ids_and_for_aliases() {
    let document = clean(
        "<alias id='second' as='third'/><bsdf type='diffuse' id='first'/>
         <alias id='first' as='second'/><shape type='a'><ref id='third'/></shape>",
    );
    assert_eq!(nested(&document, object(&document, 1), 0).id.as_deref(), Some("first"));
}

#[test]
fn aliases_that_lead_nowhere() {
    let loaded = load("<alias id='a' as='b'/>\n<alias id='b' as='a'/>\n<alias id='c' as='d'/>");
    assert_eq!(loaded.findings(), [2, 3, 4].map(|line| (Error, BadValue, line)));
}

#[test]
fn an_unknown_id_suggests_near_ones_and_leaves_no_child() {
    let loaded =
        load("<bsdf type='diffuse' id='Floor'/>\n<shape type='a'><ref id='floor'/></shape>");
    assert_eq!(loaded.findings(), [(Error, BadValue, 3)]);
    assert_eq!(loaded.diagnostics.sorted()[0].help, ["did you mean `Floor`?"]);
    assert!(object(&loaded.document, 1).children.is_empty());
}

#[test]
fn an_id_given_twice_names_both_places() {
    let loaded = load("<bsdf type='a' id='x'/>\n<texture type='b' id='x'/>");
    assert_eq!(loaded.findings(), [(Error, BadValue, 3)]);
    let found = &loaded.diagnostics.sorted()[0];
    assert_eq!(loaded.document.sources.locate(found.related[0].span).line(), Some(2));
}

#[test]
fn a_top_level_wrapper_without_id_takes_the_references_to_what_it_wraps() {
    let loaded = load(
        "<shape type='before'><ref id='Cushion'/></shape>
         <bsdf type='bumpmap'>
            <texture type='bitmap'/>
            <bsdf type='twosided' id='Cushion'><bsdf type='diffuse'/></bsdf>
         </bsdf>
         <shape type='after'><ref id='Cushion'/></shape>",
    );
    assert_eq!(loaded.findings(), [(Note, Approximation, 3)], "once, at the wrapper");
    let document = &loaded.document;
    for shape in [0, 2] {
        assert_eq!(nested(document, object(document, shape), 0).plugin, "bumpmap");
    }
    let bumpmap = object(document, 1);
    assert_eq!(nested(document, bumpmap, 1).plugin, "twosided", "which keeps its own child");
}

#[test]
fn wrappers_go_through_wrappers_but_not_where_it_is_ambiguous() {
    let through = load(
        "<bsdf type='twosided'><bsdf type='bumpmap'><bsdf type='diffuse' id='x'/></bsdf></bsdf>
         <shape type='a'><ref id='x'/></shape>",
    );
    assert_eq!(nested(&through.document, object(&through.document, 1), 0).plugin, "twosided");
    for content in [
        "<bsdf type='blendbsdf'><bsdf type='u' id='x'/><bsdf type='v' id='y'/></bsdf>
         <shape type='a'><ref id='x'/></shape>",
        "<bsdf type='bumpmap' id='outer'><bsdf type='u' id='x'/></bsdf>
         <shape type='a'><ref id='x'/></shape>",
    ] {
        let document = clean(content);
        assert_eq!(nested(&document, object(&document, 1), 0).plugin, "u");
    }
}

#[test]
fn a_wrapper_without_a_reference_to_what_it_wraps_is_silent() {
    clean("<bsdf type='bumpmap'><bsdf type='diffuse' id='x'/></bsdf>");
}

#[test]
fn circles_are_cut_and_shown() {
    let loaded = load(
        "<bsdf type='twosided' id='a'>\n<ref id='b'/>\n</bsdf>
         <bsdf type='twosided' id='b'>\n<ref id='a'/>\n</bsdf>
         <bsdf type='twosided' id='self'>\n<ref id='self'/>\n</bsdf>",
    );
    assert_eq!(loaded.findings(), [(Error, BadValue, 6), (Error, BadValue, 9)]);
    let messages = loaded.messages();
    assert_eq!(messages[0], "objects hold each other in a circle: a → b → a");
    assert_eq!(messages[1], "objects hold each other in a circle: self → self");
    let related = &loaded.diagnostics.sorted()[0].related;
    assert_eq!(loaded.document.sources.locate(related[0].span).line(), Some(3));
    assert_no_cycle(&loaded.document, loaded.document.root, 0);
}

fn assert_no_cycle(document: &etendue_document::Document, node: NodeId, depth: usize) {
    assert!(depth < 100);
    for child in &document.node(node).children {
        assert_no_cycle(document, child.node, depth + 1);
    }
}

#[test]
fn long_chains_of_references_are_bounded() {
    let link = |index: usize| {
        format!("<bsdf type='twosided' id='b{index}'><ref id='b{}'/></bsdf>\n", index + 1)
    };
    let chain: String = (0..20_000).map(link).collect();
    let loaded = load(&(chain + "<bsdf type='diffuse' id='b20000'/>"));
    assert!(loaded.findings().iter().all(|found| (found.0, found.1) == (Error, Limit)));
    assert!(loaded.diagnostics.has_errors());
    assert_no_cycle(&loaded.document, loaded.document.root, 0);
}

#[test]
fn objects_that_double_at_every_step_are_bounded() {
    let link = |index: usize| {
        let next = index + 1;
        format!("<bsdf type='blend' id='b{index}'><ref id='b{next}'/><ref id='b{next}'/></bsdf>\n")
    };
    let chain: String = (0..40).map(link).collect();
    let loaded = load(&(chain + "<bsdf type='diffuse' id='b40'/>"));
    let findings = loaded.findings();
    // 2^19 is below a million, 2^20 - 1 above: one in every twenty steps is cut.
    assert_eq!(findings.len(), 2, "{findings:?}");
    assert!(findings.iter().all(|found| (found.0, found.1) == (Error, Limit)));
}
