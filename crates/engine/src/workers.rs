//! The threads that a render runs on.

use std::num::NonZeroUsize;

use crate::error::EngineError;

/// A pool of threads. All parallel work inside [`Workers::run`] uses these threads and no others, so
/// that loading a scene and rendering it use the same number.
#[derive(Debug)]
pub struct Workers {
    pool: rayon::ThreadPool,
}

impl Workers {
    /// Starts as many threads as asked for, or one per processor.
    ///
    /// # Errors
    ///
    /// [`EngineError::Threads`] if the operating system refuses.
    pub fn new(thread_count: Option<NonZeroUsize>) -> Result<Self, EngineError> {
        let thread_count = thread_count
            .or_else(|| std::thread::available_parallelism().ok())
            .map_or(1, NonZeroUsize::get);
        let builder = rayon::ThreadPoolBuilder::new().num_threads(thread_count);
        let pool = builder.build().map_err(|error| EngineError::Threads(error.to_string()))?;
        Ok(Self { pool })
    }

    /// How many threads there are.
    pub fn thread_count(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Runs `work` on one of the threads and waits for it; its parallel parts use all of them.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }
}
