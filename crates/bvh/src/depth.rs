//! Limits of the depth of a hierarchy.

use crate::node::WIDTH;

/// The binary tree is split by cost down to this depth, and in halves below it.
pub(crate) const MAX_COST_DEPTH: usize = 48;

/// The maximum depth of the parts of the binary tree (see `build::top`), which leaves room for many
/// splits by cost.
pub(crate) const MAX_TOP_DEPTH: usize = 28;

/// The maximum depth of a hierarchy: below [`MAX_COST_DEPTH`], every level halves the at most 2³¹
/// references.
pub(crate) const MAX_DEPTH: usize = MAX_COST_DEPTH + 32;

/// The number of children that can be pending at once in a hierarchy of [`MAX_DEPTH`], with a
/// margin for eight children written at once.
pub(crate) const STACK_SIZE: usize = MAX_DEPTH * (WIDTH - 1) + 16;
