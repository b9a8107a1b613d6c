//! Several jobs at a time, each with its own threads.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Threads of a job when `jobs` of them share those of the program.
pub fn threads_of_a_job(jobs: usize) -> usize {
    (rayon::current_num_threads() / jobs).max(1)
}

/// Calls `work` with 0, 1, ..., `count` − 1, started in this order, `jobs` at a time, until a call
/// returns a break.
///
/// Each worker has its own thread pool. In a shared pool a thread that waits for other threads of
/// its run could take work from another run, and its time would be attributed to the wrong run.
///
/// # Errors
/// The system could not start the threads; nothing was called.
pub fn for_each(
    count: usize,
    jobs: usize,
    work: impl Fn(usize) -> ControlFlow<()> + Sync,
) -> Result<(), rayon::ThreadPoolBuildError> {
    let threads = threads_of_a_job(jobs);
    let pools: Vec<rayon::ThreadPool> = (0..jobs.min(count))
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(threads).build())
        .collect::<Result<_, _>>()?;
    let next = AtomicUsize::new(0);
    let stopped = AtomicBool::new(false);
    let work_loop = || {
        while !stopped.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break;
            }
            if work(index).is_break() {
                stopped.store(true, Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for pool in &pools {
            scope.spawn(|| pool.install(work_loop));
        }
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn everything_is_done_once_and_in_order_by_one_worker() {
        for jobs in [1, 3, 20] {
            let done = Mutex::new(Vec::new());
            for_each(10, jobs, |index| {
                done.lock().unwrap().push(index);
                ControlFlow::Continue(())
            })
            .unwrap();
            let mut done = done.into_inner().unwrap();
            if jobs > 1 {
                done.sort_unstable();
            }
            assert!(done.into_iter().eq(0..10));
        }
    }

    #[test]
    fn nothing_is_started_after_a_break() {
        let done = Mutex::new(Vec::new());
        for_each(10, 1, |index| {
            done.lock().unwrap().push(index);
            if index == 3 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap();
        assert_eq!(done.into_inner().unwrap(), [0, 1, 2, 3]);
    }
}
