//! What bounds the work of a batch of samples: the host, which may abandon it, and limits on every
//! path.

use std::cell::Cell;

/// Watches over a batch of samples while it is traced.
///
/// Long paths ask from time to time whether the batch is still wanted. If it is not, all paths end
/// at once, and the results are meaningless: the caller must discard the whole batch.
pub struct Watch<'a> {
    is_over: &'a dyn Fn() -> bool,
    abandoned: Cell<bool>,
    truncated_paths: Cell<u64>,
}

impl<'a> Watch<'a> {
    /// A watch that asks `is_over` whether the batch is no longer wanted.
    pub fn new(is_over: &'a dyn Fn() -> bool) -> Self {
        Self { is_over, abandoned: Cell::new(false), truncated_paths: Cell::new(0) }
    }

    /// Whether the batch has been abandoned.
    #[must_use]
    pub fn is_abandoned(&self) -> bool {
        self.abandoned.get()
    }

    /// The number of paths that ended because they reached a limit.
    #[must_use]
    pub fn truncated_paths(&self) -> u64 {
        self.truncated_paths.get()
    }

    /// Asks the host whether the batch must be abandoned.
    #[must_use]
    pub fn must_abandon(&self) -> bool {
        let abandoned = self.is_abandoned() || (self.is_over)();
        self.abandoned.set(abandoned);
        abandoned
    }
}

impl Watch<'static> {
    /// A watch over a batch that is never abandoned.
    #[must_use]
    pub fn patient() -> Self {
        Self::new(&|| false)
    }
}

/// The greatest number of edges of a path, whatever `max_depth` and `rr_depth` say. Between two
/// mirrors, a path might never end. With Russian roulette at its default depth, hardly any path has
/// a thousand edges.
pub const MAX_EDGES: u32 = 1 << 16;
/// The greatest number of tentative collisions of a path and its connections in heterogeneous
/// media, and of surfaces that its connections pass. Crossing a cloud takes thousands.
pub const MAX_COLLISIONS: u32 = 1 << 20;

/// The work that a path may still do, in steps of one kind.
#[derive(Clone, Copy)]
pub(crate) struct WorkLimit<'a> {
    watch: &'a Watch<'a>,
    steps_left: u32,
    /// How many steps there are between two questions to the host.
    interval: u32,
}

impl<'a> WorkLimit<'a> {
    /// Limits the edges of a path.
    #[inline]
    pub(crate) fn edges(watch: &'a Watch<'a>) -> Self {
        Self { watch, steps_left: MAX_EDGES, interval: 1 << 10 }
    }

    /// Limits the collisions of a path.
    #[inline]
    pub(crate) fn collisions(watch: &'a Watch<'a>) -> Self {
        Self { watch, steps_left: MAX_COLLISIONS, interval: 1 << 15 }
    }

    /// Takes a step; false if the path must end.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> bool {
        self.step_together(1)
    }

    /// Takes a step of `paths` paths that advance together; false if they must end.
    #[inline(always)]
    pub(crate) fn step_together(&mut self, paths: usize) -> bool {
        if self.steps_left == 0 {
            return false;
        }
        self.steps_left -= 1;
        !self.steps_left.is_multiple_of(self.interval) || self.may_go_on(paths)
    }

    #[cold]
    fn may_go_on(&self, paths: usize) -> bool {
        if self.steps_left == 0 {
            let truncated_paths = &self.watch.truncated_paths;
            truncated_paths.set(truncated_paths.get() + paths as u64);
            return false;
        }
        !self.watch.must_abandon()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_ends_at_its_limit_and_counts_once() {
        let watch = Watch::patient();
        let mut limit = WorkLimit::edges(&watch);
        let steps = (0..2 * MAX_EDGES).take_while(|_| limit.step()).count();
        assert_eq!(steps as u32, MAX_EDGES - 1);
        assert!(!limit.step());
        assert_eq!(watch.truncated_paths(), 1);
        assert!(!watch.is_abandoned());
    }

    #[test]
    fn the_host_is_asked_from_time_to_time() {
        let questions = Cell::new(0);
        let is_over = || {
            questions.set(questions.get() + 1);
            questions.get() == 3
        };
        let watch = Watch::new(&is_over);
        let mut limit = WorkLimit::collisions(&watch);
        let steps = (0..MAX_COLLISIONS).take_while(|_| limit.step()).count();
        assert_eq!((questions.get(), steps), (3, 3 * (1 << 15) - 1));
        assert!(watch.is_abandoned());
        assert_eq!(watch.truncated_paths(), 0);
    }
}
