//! Splitting vertices along sharp edges.
