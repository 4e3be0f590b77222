//! Memory for large arrays.

/// An empty vector with room for `capacity` items, in large pages where the system has them for
/// those who ask: fewer page faults while it is filled, and fewer misses of the address cache when
/// rays touch it all over.
pub(crate) fn vector_with_capacity<T>(capacity: usize) -> Vec<T> {
    let mut vector = Vec::with_capacity(capacity);
    #[cfg(target_os = "linux")]
    linux::advise_large_pages(vector.spare_capacity_mut());
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

    /// Asks for large pages in the part of `memory` that they can cover. A refusal changes
    /// nothing.
    pub(super) fn advise_large_pages<T>(memory: &mut [MaybeUninit<T>]) {
        let length = size_of_val(memory);
        let start: *mut u8 = memory.as_mut_ptr().cast();
        let skip = start.align_offset(LARGE_PAGE);
        if length < skip.saturating_add(LARGE_PAGE) {
            return;
        }
        let covered = (length - skip) / LARGE_PAGE * LARGE_PAGE;
        // SAFETY: the range lies in memory that is ours, and the advice leaves its content alone.
        unsafe { madvise(start.add(skip).cast(), covered, MADV_HUGEPAGE) };
    }
}
