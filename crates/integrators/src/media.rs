//! The components of the volumetric integrators: medium walks, connections to emitters, and the
//! densities of whole paths.

mod connection;
mod walk;
mod weights;

pub(crate) use connection::{Connection, Vertex};
pub(crate) use walk::{Event, MediumVertex, MediumWalk};
pub(crate) use weights::{Heuristic, Turn, Weights};
