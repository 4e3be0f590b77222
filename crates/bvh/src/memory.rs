//! Allocation of large arrays.

use rayon::prelude::*;

/// An empty vector with room for `capacity` items. Requests huge pages where the system grants them
/// on request: filling the vector causes fewer page faults, and random access fewer TLB misses.
pub(crate) fn vector_with_capacity<T>(capacity: usize) -> Vec<T> {
    let mut vector = Vec::with_capacity(capacity);
    #[cfg(target_os = "linux")]
    linux::advise_large_pages(vector.spare_capacity_mut());
    vector
}

/// Concatenates the items of all parts in parallel, and reserves room for `room` more items.
/// `length` must return the number of items that `items` yields for a part.
///
/// # Panics
///
/// If `items` yields more or fewer items than `length` says.
pub(crate) fn concatenate<'a, P: Sync, T: Send, I: Iterator<Item = T>>(
    parts: &'a [P],
    room: usize,
    length: impl Fn(&P) -> usize,
    items: impl Fn(&'a P) -> I + Sync,
) -> Vec<T> {
    let lengths: Vec<usize> = parts.iter().map(length).collect();
    let total = lengths.iter().sum();
    let mut vector = vector_with_capacity(total + room);
    let mut rest = &mut vector.spare_capacity_mut()[..total];
    let mut tasks = Vec::with_capacity(parts.len());
    for (part, length) in parts.iter().zip(lengths) {
        let (slots, others) = std::mem::take(&mut rest).split_at_mut(length);
        tasks.push((part, slots));
        rest = others;
    }
    tasks.into_par_iter().for_each(|(part, slots)| {
        let mut written = 0;
        items(part).for_each(|item| {
            slots[written].write(item);
            written += 1;
        });
        assert_eq!(written, slots.len(), "a part has a different length");
    });
    // SAFETY: each of the `total` slots belongs to one part, and every part has filled its slots.
    unsafe { vector.set_len(total) };
    vector
}

#[cfg(target_os = "linux")]
mod linux {
    use std::ffi::{c_int, c_void};
    use std::mem::MaybeUninit;

    const LARGE_PAGE: usize = 2 << 20;
    const MADV_HUGEPAGE: c_int = 14;

    unsafe extern "C" {
        fn madvise(address: *mut c_void, length: usize, advice: c_int) -> c_int;
    }

    /// Advises the kernel to use huge pages for the part of `memory` that they can cover. Failure
    /// has no effect.
    pub(super) fn advise_large_pages<T>(memory: &mut [MaybeUninit<T>]) {
        let length = size_of_val(memory);
        let start: *mut u8 = memory.as_mut_ptr().cast();
        let skip = start.align_offset(LARGE_PAGE);
        if length < skip.saturating_add(LARGE_PAGE) {
            return;
        }
        let covered = (length - skip) / LARGE_PAGE * LARGE_PAGE;
        // SAFETY: the range is inside our own memory, and the advice does not change its content.
        unsafe { madvise(start.add(skip).cast(), covered, MADV_HUGEPAGE) };
    }
}
