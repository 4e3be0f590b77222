//! How a render is divided into passes.

use std::ops::Range;
use std::time::Duration;

/// Passes take about this long once they have grown: long enough that waiting for the last tile
/// costs little, short enough for previews.
const PASS_TIME: Duration = Duration::from_millis(200);

/// Hands out ranges of sample indices: one sample first, then twice as many each time, until a
/// pass takes as long as it should.
///
/// How the indices are divided does not change the picture, so the clock may have a say here.
#[derive(Debug)]
pub(crate) struct Schedule {
    next: u32,
    end: u32,
    size: u32,
}

impl Schedule {
    /// A schedule for sample indices below `end`.
    pub(crate) fn new(end: u32) -> Self {
        Self { next: 0, end, size: 1 }
    }

    /// The indices of the next pass; `None` when all have been handed out.
    pub(crate) fn next_pass(&mut self) -> Option<Range<u32>> {
        if self.next >= self.end {
            return None;
        }
        let start = self.next;
        self.next = start.saturating_add(self.size).min(self.end);
        Some(start..self.next)
    }

    /// Sets the size of the next pass by how long the last one took.
    pub(crate) fn adapt(&mut self, last: Duration) {
        let fitting = f64::from(self.size) * PASS_TIME.as_secs_f64() / last.as_secs_f64().max(1e-9);
        let doubled = self.size.saturating_mul(2);
        // The cast saturates.
        self.size = (fitting as u32).clamp(1, doubled);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_passes_cover_every_index_once() {
        let mut schedule = Schedule::new(1000);
        let mut expected = 0;
        while let Some(pass) = schedule.next_pass() {
            assert_eq!(pass.start, expected);
            assert!(pass.end > pass.start);
            expected = pass.end;
            schedule.adapt(Duration::from_millis(1));
        }
        assert_eq!(expected, 1000);
    }

    #[test]
    fn passes_double_while_they_are_short_and_settle_at_their_time() {
        let mut schedule = Schedule::new(u32::MAX);
        let mut sizes = Vec::new();
        for _ in 0..8 {
            let pass = schedule.next_pass().unwrap();
            let size = pass.end - pass.start;
            sizes.push(size);
            schedule.adapt(Duration::from_millis(10) * size);
        }
        assert_eq!(sizes, [1, 2, 4, 8, 16, 20, 20, 20]);
    }

    #[test]
    fn a_slow_scene_gets_single_samples() {
        let mut schedule = Schedule::new(4);
        schedule.next_pass();
        schedule.adapt(Duration::from_secs(1000));
        assert_eq!(schedule.next_pass(), Some(1..2));
    }
}
