//! How a render is divided into passes.

use std::time::Duration;

/// What a pass should take: long enough that waiting for the last tile costs little, short enough for
/// previews.
const PASS_TIME: Duration = Duration::from_millis(200);

/// Hands out ranges of sample indices: first one sample, then twice as many each time, until a pass
/// takes as long as it should.
///
/// The clock may decide this, because the division into passes does not change the picture.
#[derive(Debug)]
pub(crate) struct Schedule {
    next: u32,
    end: u32,
    size: u32,
}

impl Schedule {
    /// A schedule for the sample indices from `start` to below `end`.
    pub(crate) fn new(start: u32, end: u32) -> Self {
        Self { next: start, end, size: 1 }
    }

    /// The end of the next pass: it takes the samples with an index below. `None` when all samples
    /// have been handed out.
    pub(crate) fn next_pass(&mut self) -> Option<u32> {
        if self.next >= self.end {
            return None;
        }
        self.next = self.next.saturating_add(self.size).min(self.end);
        Some(self.next)
    }

    /// Sets the size of the next pass by the time that the last one took.
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
    fn the_passes_cover_every_index() {
        let mut schedule = Schedule::new(3, 1000);
        let mut last = 3;
        while let Some(end) = schedule.next_pass() {
            assert!(end > last);
            last = end;
            schedule.adapt(Duration::from_millis(1));
        }
        assert_eq!(last, 1000);
    }

    #[test]
    fn passes_double_while_they_are_short_and_settle_at_their_time() {
        let mut schedule = Schedule::new(0, u32::MAX);
        let mut ends = Vec::new();
        for _ in 0..8 {
            let start = ends.last().copied().unwrap_or(0);
            let end = schedule.next_pass().unwrap();
            ends.push(end);
            schedule.adapt(Duration::from_millis(10) * (end - start));
        }
        assert_eq!(ends, [1, 3, 7, 15, 31, 51, 71, 91]);
    }

    #[test]
    fn a_slow_scene_gets_single_samples() {
        let mut schedule = Schedule::new(0, 4);
        schedule.next_pass();
        schedule.adapt(Duration::from_secs(1000));
        assert_eq!(schedule.next_pass(), Some(2));
    }
}
