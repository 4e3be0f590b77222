//! Processor time.

use std::time::Instant;

#[repr(C)]
struct Time {
    seconds: i64,
    nanoseconds: i64,
}

unsafe extern "C" {
    fn clock_gettime(clock: i32, time: *mut Time) -> i32;
}

/// The processor time of this thread in seconds.
pub(crate) fn thread_seconds() -> f64 {
    const THREAD_CPU_TIME: i32 = 3;
    seconds_of(THREAD_CPU_TIME)
}

fn seconds_of(clock: i32) -> f64 {
    let mut time = Time { seconds: 0, nanoseconds: 0 };
    // SAFETY: the C library of 64-bit Linux has this function, and `time` is a timespec there.
    unsafe { clock_gettime(clock, &mut time) };
    time.seconds as f64 + time.nanoseconds as f64 * 1e-9
}

/// A measured duration.
#[derive(Clone, Copy)]
pub(crate) struct Took {
    /// Wall time in seconds.
    pub(crate) wall: f64,
    /// The processor time of all threads in seconds.
    pub(crate) processors: f64,
}

/// Measures how long `run` takes.
pub(crate) fn timed<T>(run: impl FnOnce() -> T) -> (Took, T) {
    const PROCESS_CPU_TIME: i32 = 2;
    let (start, processors) = (Instant::now(), seconds_of(PROCESS_CPU_TIME));
    let result = run();
    let wall = start.elapsed().as_secs_f64();
    (Took { wall, processors: seconds_of(PROCESS_CPU_TIME) - processors }, result)
}
