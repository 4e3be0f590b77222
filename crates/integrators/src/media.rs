//! What the volumetric integrators are made of: flights through media, connections to emitters, and
//! how likely each way of finding a path was.

mod connection;
mod walk;
mod weights;

pub(crate) use connection::{Connection, Vertex};
pub(crate) use walk::{Event, MediumWalk};
pub(crate) use weights::{Heuristic, Weights};
