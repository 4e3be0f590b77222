//! Bounding volume hierarchy: builders, wide nodes, watertight traversal, instancing.

