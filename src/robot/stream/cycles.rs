//! The cycles of a stream: a deadline every millisecond, and how far deadlines are missed.

use super::timer::Timer;
use std::time::{Duration, Instant};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ScheduleParams, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id, thread_schedule_policy_param,
};

/// Time between two cycles.
pub(super) const CYCLE: Duration = Duration::from_millis(1);
/// Width of a bin of delays.
const BIN: Duration = Duration::from_micros(50);
/// Number of bins; longer delays are counted in the last one.
const BINS: usize = 400;
/// Real-time priority of the thread, from 1 to 99: below those of the kernel's interrupt threads,
/// 50.
const PRIORITY: u8 = 40;
/// Shortest pause of a cycle. A thread with real-time scheduling would otherwise keep a processor
/// for itself when its work takes longer than a cycle.
const PAUSE: Duration = Duration::from_micros(250);
/// Excess of cycles that were late by a whole cycle, over the others, at which real-time scheduling
/// is given up.
const OVERLOAD: u32 = 250;

/// Deadlines, and how often they were missed by how much.
pub(super) struct Cycles {
    next: Instant,
    real_time: Option<RealTime>,
    overload: u32,
    /// Number of cycles by their delay, in steps of [`BIN`].
    bins: [u64; BINS],
    longest: Duration,
}

impl Cycles {
    /// Cycles from a time on, with the scheduling of their thread.
    pub(super) fn from(now: Instant, real_time: Option<RealTime>) -> Self {
        Self {
            next: now + CYCLE,
            real_time,
            overload: 0,
            bins: [0; BINS],
            longest: Duration::ZERO,
        }
    }

    /// Waits until the next deadline. A missed deadline does not shorten the following cycle. If most
    /// cycles are late, other programs need the processor: real-time scheduling is given up.
    pub(super) fn wait(&mut self, timer: &dyn Timer) {
        let left = self.next.saturating_duration_since(timer.now());
        timer.sleep(left.max(PAUSE));
        let now = timer.now();
        let delay = now.saturating_duration_since(self.next);
        let bin = (delay.as_nanos() / BIN.as_nanos()) as usize;
        self.bins[bin.min(BINS - 1)] += 1;
        self.longest = self.longest.max(delay);
        (self.next, self.overload) = match delay < CYCLE {
            true => (self.next + CYCLE, self.overload.saturating_sub(1)),
            false => (now + CYCLE, self.overload + 1),
        };
        if self.overload > OVERLOAD {
            self.real_time = None;
        }
    }

    /// The delay that a part of all cycles does not exceed.
    fn quantile(&self, part: f64) -> Duration {
        let all: u64 = self.bins.iter().sum();
        let most = (part * all as f64).ceil() as u64;
        let mut count = 0;
        let bin = self.bins.iter().position(|bin| {
            count += bin;
            count >= most
        });
        match bin {
            Some(bin) if bin < BINS - 1 => BIN * (bin as u32 + 1),
            _ => self.longest,
        }
    }

    /// The delays as text.
    pub(super) fn summary(&self) -> String {
        let all: u64 = self.bins.iter().sum();
        let milliseconds = |delay: Duration| 1e3 * delay.as_secs_f64();
        format!(
            "{all} cycles of 1 ms: 99.9 % late by at most {:.2} ms, the latest by {:.2} ms",
            milliseconds(self.quantile(0.999)),
            milliseconds(self.longest)
        )
    }
}

/// Real-time scheduling of the calling thread, where the operating system allows it, until this
/// value is dropped.
pub(super) struct RealTime(Option<(ThreadSchedulePolicy, ScheduleParams)>);

impl RealTime {
    /// Asks for it.
    pub(super) fn requested() -> Self {
        let former = thread_schedule_policy_param(thread_native_id()).ok();
        let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        let is_set = priority(PRIORITY).is_some_and(|priority| {
            set_thread_priority_and_policy(thread_native_id(), priority, fifo).is_ok()
        });
        Self(former.filter(|_| is_set))
    }

    /// The scheduling as text.
    pub(super) fn in_words(&self) -> &'static str {
        match self.0 {
            Some(_) => "real-time scheduling (SCHED_FIFO)",
            None => "normal scheduling: the system does not allow SCHED_FIFO",
        }
    }
}

impl Drop for RealTime {
    fn drop(&mut self) {
        if let Some((policy, parameters)) = self.0 {
            let former = priority(parameters.sched_priority as u8).unwrap_or(ThreadPriority::Min);
            // The thread keeps its priority if the system refuses to lower it.
            let _ = set_thread_priority_and_policy(thread_native_id(), former, policy);
        }
    }
}

fn priority(number: u8) -> Option<ThreadPriority> {
    number.try_into().ok().map(ThreadPriority::Crossplatform)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// A timer whose sleeps are longer than requested.
    struct Late {
        now: Cell<Instant>,
        by: Cell<Duration>,
    }

    impl Timer for Late {
        fn now(&self) -> Instant {
            self.now.get()
        }

        fn sleep(&self, time: Duration) {
            self.now.set(self.now.get() + time + self.by.get());
        }
    }

    #[test]
    fn deadlines_do_not_drift_and_delays_are_counted() {
        let begin = Instant::now();
        let timer = Late {
            now: Cell::new(begin),
            by: Cell::new(Duration::from_micros(120)),
        };
        let mut cycles = Cycles::from(begin, Some(RealTime(None)));
        for _ in 0..1998 {
            cycles.wait(&timer);
        }
        let elapsed = timer.now() - begin;
        assert_eq!(elapsed, 1998 * CYCLE + Duration::from_micros(120));
        timer.by.set(Duration::from_micros(3300));
        cycles.wait(&timer);
        timer.by.set(Duration::ZERO);
        cycles.wait(&timer);
        assert_eq!(cycles.quantile(0.9), Duration::from_micros(150));
        let summary = cycles.summary();
        assert_eq!(
            summary,
            "2000 cycles of 1 ms: 99.9 % late by at most 0.15 ms, the latest by 3.30 ms"
        );
        // The cycle after a late one is a whole one.
        let late = timer.now();
        cycles.wait(&timer);
        assert_eq!(timer.now() - late, CYCLE);
        // Work that takes longer than a cycle.
        assert!(cycles.real_time.is_some());
        for _ in 0..=OVERLOAD {
            timer.now.set(timer.now() + 3 * CYCLE);
            let worked = timer.now();
            cycles.wait(&timer);
            assert_eq!(timer.now() - worked, PAUSE);
        }
        assert!(cycles.real_time.is_none());
    }

    #[test]
    fn the_scheduling_of_the_thread_is_restored() {
        let of_thread = || thread_schedule_policy_param(thread_native_id()).unwrap();
        let former = of_thread();
        let real_time = RealTime::requested();
        let (policy, _) = of_thread();
        let is_real_time = matches!(policy, ThreadSchedulePolicy::Realtime(_));
        assert_eq!(is_real_time, real_time.in_words().contains("FIFO)"));
        drop(real_time);
        assert_eq!(of_thread().0, former.0);
    }
}
