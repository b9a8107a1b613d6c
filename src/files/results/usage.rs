//! Cost of a run: wall time, processor time, memory.

use serde::{Deserialize, Serialize};
use std::ops::Add;
use std::time::{Duration, Instant};

/// Cost of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Usage {
    /// Time on the clock.
    pub wall_time: Duration,
    /// Part of the wall time spent in steps with contact.
    pub wall_time_with_contact: Duration,
    /// Processor time of all threads that worked on the run; `None` if the system does not report
    /// it.
    pub cpu_time: Option<Duration>,
    /// Largest resident memory of the process, bytes; `None` if the system does not report it.
    pub peak_memory: Option<u64>,
}

/// No work at all.
impl Default for Usage {
    fn default() -> Self {
        Self {
            wall_time: Duration::ZERO,
            wall_time_with_contact: Duration::ZERO,
            cpu_time: Some(Duration::ZERO),
            peak_memory: None,
        }
    }
}

/// The total cost of two consecutive periods of work.
impl Add for Usage {
    type Output = Self;

    fn add(self, later: Self) -> Self {
        Self {
            wall_time: self.wall_time + later.wall_time,
            wall_time_with_contact: self.wall_time_with_contact + later.wall_time_with_contact,
            cpu_time: self.cpu_time.zip(later.cpu_time).map(|(a, b)| a + b),
            peak_memory: self.peak_memory.max(later.peak_memory),
        }
    }
}

/// A duration from seconds; zero for an invalid number, as in a damaged file.
pub fn duration(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

/// Measures [`Usage`] from its creation on.
pub struct UsageMeter {
    start: Instant,
    cpu_time_before: Option<Duration>,
    with_contact: Duration,
}

impl UsageMeter {
    /// Starts to measure.
    pub fn start() -> Self {
        Self {
            start: Instant::now(),
            cpu_time_before: cpu_time(),
            with_contact: Duration::ZERO,
        }
    }

    /// Adds the time of a step with contact.
    pub fn add_step_with_contact(&mut self, wall_time: Duration) {
        self.with_contact += wall_time;
    }

    /// Wall time since the start.
    pub fn wall_time(&self) -> Duration {
        self.start.elapsed()
    }

    /// Cost since the start; the peak memory is that of the whole life of the process.
    pub fn usage(&self) -> Usage {
        let cpu_time = cpu_time().zip(self.cpu_time_before);
        Usage {
            wall_time: self.wall_time(),
            wall_time_with_contact: self.with_contact,
            cpu_time: cpu_time.map(|(now, before)| now.saturating_sub(before)),
            peak_memory: peak_memory(),
        }
    }
}

/// Processor time used so far: by the threads of the current pool, or by the whole process.
fn cpu_time() -> Option<Duration> {
    match rayon::current_thread_index() {
        Some(_) => rayon::broadcast(|_| thread_cpu_time()).into_iter().sum(),
        None => process_cpu_time(),
    }
}

/// Time that this thread has spent on a processor, from `/proc/thread-self/schedstat`, in ns.
pub fn thread_cpu_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}

/// User and system time of the process, from `/proc/self/stat` (fields 14 and 15 of proc(5)).
fn process_cpu_time() -> Option<Duration> {
    // In this file Linux counts in units of 10 ms, regardless of the kernel's clock.
    const TICK: Duration = Duration::from_millis(10);
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Field 2, the program's name in parentheses, may contain blanks; field 3 is the first one
    // after it.
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut times = after_name.split_whitespace().skip(14 - 3);
    let mut ticks = || times.next()?.parse::<u32>().ok();
    Some(TICK * (ticks()? + ticks()?))
}

/// `VmHWM` of `/proc/self/status`.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn work_costs_processor_time_and_memory() {
        let meter = UsageMeter::start();
        let block = std::hint::black_box(vec![1u8; 64 << 20]);
        // This loop ends only if processor time is counted.
        while meter.usage().cpu_time.unwrap() < Duration::from_millis(50) {
            std::hint::black_box(block.iter().map(|byte| u64::from(*byte)).sum::<u64>());
        }
        let usage = meter.usage();
        assert!(usage.peak_memory.unwrap() > 64 << 20, "{usage:?}");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn work_in_a_pool_is_not_charged_for_work_beside_it() {
        let pool = || {
            rayon::ThreadPoolBuilder::new()
                .num_threads(1)
                .build()
                .unwrap()
        };
        let spin = |time: Duration| {
            let meter = UsageMeter::start();
            while meter.usage().cpu_time.unwrap() < time {
                std::hint::black_box((0..1000u64).sum::<u64>());
            }
        };
        let (idle, busy) = (pool(), pool());
        let charged = idle.install(|| {
            let meter = UsageMeter::start();
            busy.install(|| spin(Duration::from_millis(50)));
            meter.usage().cpu_time.unwrap()
        });
        assert!(charged < Duration::from_millis(25), "{charged:?}");
    }

    #[test]
    fn costs_add_up_and_memory_is_the_larger() {
        let usage = |seconds, memory| Usage {
            wall_time: Duration::from_secs(seconds),
            wall_time_with_contact: Duration::from_millis(100 * seconds),
            cpu_time: Some(Duration::from_secs(2 * seconds)),
            peak_memory: memory,
        };
        let sum = usage(1, Some(7)) + usage(2, None);
        assert_eq!(sum, usage(3, Some(7)));
        assert_eq!(Usage::default() + sum, sum);
    }
}
