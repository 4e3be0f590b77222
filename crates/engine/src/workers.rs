//! The threads that a render runs on.

use std::num::NonZeroUsize;

use crate::EngineError;

/// A pool of threads. Everything that works in parallel inside [`Workers::run`] uses these threads
/// and no others, so that building a scene and rendering it keep to the same number.
#[derive(Debug)]
pub struct Workers {
    pool: rayon::ThreadPool,
}

impl Workers {
    /// Starts threads: as many as asked for, or one per processor.
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

    /// Runs `work` on one of the threads and waits for it; parallel parts spread to the others.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }
}
