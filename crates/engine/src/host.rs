//! What a program gives a render to run with.

use crate::observer::{Cancel, Observer};
use crate::workers::Workers;

/// What the program that renders provides: threads, an observer, and a way to stop.
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// The threads.
    pub workers: &'a Workers,
    /// Hears how the render goes.
    pub observer: &'a dyn Observer,
    /// Stops the render.
    pub cancel: &'a Cancel,
}
