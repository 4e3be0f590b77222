//! A record of what a plugin has read of its node, to be replayed if the plugin need not be
//! rebuilt.

use super::Parameters;

/// The names asked for and the entries read, by their index in the node.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    asked: Vec<String>,
    parameters: Vec<usize>,
    children: Vec<usize>,
}

impl Parameters<'_> {
    /// What has been read so far.
    pub fn reading(&self) -> Reading {
        let positions = |read: &[bool]| {
            let read = read.iter().enumerate().filter(|(_, read)| **read);
            read.map(|(index, _)| index).collect()
        };
        Reading {
            asked: self.asked.borrow().clone(),
            parameters: positions(&self.parameters_read.borrow()),
            children: positions(&self.children_read.borrow()),
        }
    }

    /// Marks the same entries as read, for a node with the same entries at the same indices.
    pub fn repeat(&self, reading: &Reading) {
        reading.asked.iter().for_each(|name| self.ask(name));
        let mark = |read: &mut Vec<bool>, positions: &[usize]| {
            for position in positions {
                if let Some(read) = read.get_mut(*position) {
                    *read = true;
                }
            }
        };
        mark(&mut self.parameters_read.borrow_mut(), &reading.parameters);
        mark(&mut self.children_read.borrow_mut(), &reading.children);
    }
}
