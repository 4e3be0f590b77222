//! The memory that the files of a scene may take together, found before they are decoded.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// The memory that is left for pictures, meshes and their trees. Threads share it.
#[derive(Debug)]
pub(super) struct MemoryBudget {
    limit: u64,
    left: AtomicU64,
}

/// Memory that is needed and not left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Exceeded {
    needed: u64,
    left: u64,
    limit: u64,
}

impl MemoryBudget {
    pub(super) fn new(limit: u64) -> Self {
        Self { limit, left: limit.into() }
    }

    /// Takes memory out of the budget.
    pub(super) fn claim(&self, bytes: u64) -> Result<(), Exceeded> {
        let taken = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(bytes));
        match taken {
            Ok(_) => Ok(()),
            Err(left) => Err(Exceeded { needed: bytes, left, limit: self.limit }),
        }
    }

    /// Gives memory back that was claimed.
    pub(super) fn release(&self, bytes: u64) {
        self.left.fetch_add(bytes, Ordering::Relaxed);
    }
}

impl fmt::Display for Exceeded {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [needed, left, limit] = [self.needed, self.left, self.limit].map(megabytes);
        write!(
            formatter,
            "it needs {needed} of memory, and {left} are left of the {limit} that the files of a \
             scene may take together"
        )
    }
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 * 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_claimed_is_taken_and_what_is_released_is_left() {
        let budget = MemoryBudget::new(100);
        assert_eq!(budget.claim(60), Ok(()));
        assert_eq!(budget.claim(60), Err(Exceeded { needed: 60, left: 40, limit: 100 }));
        budget.release(30);
        assert_eq!(budget.claim(60), Ok(()));
        assert!(budget.claim(u64::MAX).is_err());
    }

    #[test]
    fn the_message_has_all_three_sizes() {
        let text = MemoryBudget::new(2_000_000).claim(3_500_000).unwrap_err().to_string();
        assert!(text.contains("3.5 MB") && text.contains("2.0 MB"), "{text}");
    }
}
