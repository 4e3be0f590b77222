//! Transforms, frames, rays, boxes, intervals, polynomial roots and robust ray offsets.
#![forbid(unsafe_code)]
