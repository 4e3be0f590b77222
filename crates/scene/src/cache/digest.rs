//! Digests of nodes: what they say, whatever their position, their place in a file and their name.
//!
//! Two nodes with the same digest build the same thing from the same files. XXH3 with 128 bits guards
//! against mistakes, not against forgers.

use etendue_document::{Class, Document, FlatNode, NodeId};
use std::path::Path;
use xxhash_rust::xxh3::xxh3_128;

/// Bytes to be digested. Every entry begins with its kind or its length, so that no two sequences of
/// entries have the same bytes.
#[derive(Default)]
pub(crate) struct Digest(Vec<u8>);

impl Digest {
    pub(crate) fn number(&mut self, number: u128) {
        self.0.extend_from_slice(&number.to_le_bytes());
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    pub(crate) fn path(&mut self, path: &Path) {
        self.bytes(path.as_os_str().as_encoded_bytes());
    }

    pub(crate) fn floats(&mut self, floats: &[f32]) {
        self.0.extend(floats.iter().flat_map(|float| float.to_bits().to_le_bytes()));
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.extend_from_slice(bytes);
    }

    pub(crate) fn finish(&self) -> u128 {
        xxh3_128(&self.0)
    }

    /// What the node is and its parameters; the values of those that `except` names do not count.
    fn node(&mut self, node: &FlatNode, except: &[&str]) {
        self.text(node.class.name());
        self.text(&node.plugin);
        for parameter in &node.parameters {
            self.0.push(1);
            self.text(&parameter.name);
            if !except.contains(&parameter.name.as_str()) {
                parameter.value.append_bytes(&mut self.0);
            }
        }
        self.0.push(0);
    }
}

/// The digest of every node of a document with all that it holds.
#[derive(Debug)]
pub(crate) struct NodeDigests(Vec<u128>);

impl NodeDigests {
    /// Digests all nodes. A node that holds itself, which no document should, counts as empty there.
    pub(crate) fn new(document: &Document) -> Self {
        #[derive(Clone, Copy)]
        enum State {
            Unknown,
            Open,
            Known(u128),
        }
        let mut states = vec![State::Unknown; document.nodes.len()];
        let mut open: Vec<NodeId> = Vec::new();
        for start in (0..document.nodes.len() as u32).map(NodeId) {
            open.push(start);
            // Children come before their parents, without recursion: documents may be deep.
            while let Some(&id) = open.last() {
                let node = document.node(id);
                if matches!(states[id.index()], State::Unknown) {
                    states[id.index()] = State::Open;
                    let children = node.children.iter().map(|child| child.node);
                    open.extend(
                        children.filter(|child| matches!(states[child.index()], State::Unknown)),
                    );
                    continue;
                }
                open.pop();
                if matches!(states[id.index()], State::Open) {
                    let mut digest = Digest::default();
                    digest.node(node, &[]);
                    digest.text(node.id.as_deref().unwrap_or_default());
                    for child in &node.children {
                        let known = match states[child.node.index()] {
                            State::Known(known) => known,
                            State::Unknown | State::Open => 0,
                        };
                        digest.text(child.name.as_deref().unwrap_or_default());
                        digest.number(known);
                    }
                    states[id.index()] = State::Known(digest.finish());
                }
            }
        }
        let known = |state| match state {
            State::Known(known) => known,
            State::Unknown | State::Open => 0,
        };
        Self(states.into_iter().map(known).collect())
    }

    /// A node with all that it holds.
    pub(crate) fn of(&self, node: NodeId) -> u128 {
        self.0[node.index()]
    }

    /// A node with what decides its geometry, or whatever else is made of it without materials, lights,
    /// media and sensors. The values of the parameters that `except` names do not count.
    pub(crate) fn without_appearance(
        &self,
        document: &Document,
        node: NodeId,
        except: &[&str],
    ) -> u128 {
        let mut digest = Digest::default();
        digest.node(document.node(node), except);
        for (position, child) in document.node(node).children.iter().enumerate() {
            let class = document.node(child.node).class;
            if !matches!(class, Class::Bsdf | Class::Emitter | Class::Medium | Class::Sensor) {
                digest.number(position as u128);
                digest.text(child.name.as_deref().unwrap_or_default());
                digest.number(self.of(child.node));
            }
        }
        digest.finish()
    }
}
