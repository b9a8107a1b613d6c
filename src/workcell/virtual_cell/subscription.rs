//! Subscriptions of a client: the rate of messages of a topic, and the queue of waiting messages.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Largest number of messages of a topic that wait for a client.
const MOST_WAITING: usize = 100;
/// Largest number of bytes of these messages.
const MOST_BYTES: usize = 8 << 20;

/// Subscription of a client to a topic.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wish {
    /// Id of the subscription, for clients with several subscriptions to one topic.
    pub id: Option<String>,
    /// Least time between two messages.
    pub throttle: Duration,
    /// Number of messages that may wait until that time has passed; with 0 they are dropped.
    pub queue: usize,
}

/// The subscriptions of one client to one topic. As in rosbridge, the shortest time and the
/// shortest queue of them apply.
#[derive(Default)]
pub struct Subscription {
    wishes: Vec<Wish>,
    last: Option<Instant>,
    waiting: VecDeque<String>,
}

impl Subscription {
    /// Adds a subscription, or replaces the one with the same id.
    pub fn add(&mut self, wish: Wish) {
        self.wishes.retain(|known| known.id != wish.id);
        self.wishes.push(wish);
    }

    /// Removes the subscription with an id, or all without one; returns whether any is left.
    pub fn remove(&mut self, id: Option<&str>) -> bool {
        self.wishes
            .retain(|known| id.is_some() && known.id.as_deref() != id);
        !self.wishes.is_empty()
    }

    /// Number of subscriptions.
    pub fn count(&self) -> usize {
        self.wishes.len()
    }

    /// Whether a message may be sent now.
    pub fn is_due(&self) -> bool {
        let throttle = self.wishes.iter().map(|wish| wish.throttle).min();
        let throttle = throttle.unwrap_or_default();
        self.last.is_none_or(|last| last.elapsed() >= throttle)
    }

    /// Accepts a message; returns the one to send now, if any, which may be an earlier one from
    /// the queue.
    pub fn take(&mut self, text: &str) -> Option<String> {
        let queue = self.wishes.iter().map(|wish| wish.queue).min();
        let queue = queue.unwrap_or_default().min(MOST_WAITING);
        if self.waiting.is_empty() && self.is_due() {
            self.last = Some(Instant::now());
            return Some(text.to_owned());
        }
        if queue > 0 {
            self.waiting.push_back(text.to_owned());
        }
        let bytes = |waiting: &VecDeque<String>| waiting.iter().map(String::len).sum::<usize>();
        while self.waiting.len() > queue || bytes(&self.waiting) > MOST_BYTES {
            self.waiting.pop_front();
        }
        self.next()
    }

    /// The message that has waited longest, once it may be sent.
    pub fn next(&mut self) -> Option<String> {
        if !self.is_due() {
            return None;
        }
        let next = self.waiting.pop_front()?;
        self.last = Some(Instant::now());
        Some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subscribed(milliseconds: u64, queue: usize) -> Subscription {
        let mut subscription = Subscription::default();
        subscription.add(Wish {
            id: None,
            throttle: Duration::from_millis(milliseconds),
            queue,
        });
        subscription
    }

    #[test]
    fn messages_are_dropped_or_wait_until_their_time_has_come() {
        let mut all = subscribed(0, 0);
        assert!((0..10).all(|k| all.take(&k.to_string()).is_some()));
        let mut dropping = subscribed(3_600_000, 0);
        assert_eq!(dropping.take("first").as_deref(), Some("first"));
        assert!((0..10).all(|_| dropping.take("later").is_none()));
        assert!(dropping.waiting.is_empty());
        let mut queued = subscribed(3_600_000, 3);
        (0..10).for_each(|k| drop(queued.take(&k.to_string())));
        assert_eq!(queued.waiting, ["7", "8", "9"]);
        queued.last = None;
        assert_eq!(queued.next().as_deref(), Some("7"));
        assert_eq!(queued.next(), None);
    }

    #[test]
    fn waiting_messages_are_bounded() {
        let mut greedy = subscribed(3_600_000, usize::MAX);
        (0..1000).for_each(|_| drop(greedy.take("x")));
        assert_eq!(greedy.waiting.len(), MOST_WAITING);
        let large = "x".repeat(1 << 20);
        (0..20).for_each(|_| drop(greedy.take(&large)));
        let bytes: usize = greedy.waiting.iter().map(String::len).sum();
        assert!(bytes <= MOST_BYTES, "{bytes}");
    }

    #[test]
    fn the_shortest_time_of_several_subscriptions_counts_and_each_ends_by_its_name() {
        let wish = |id: &str, milliseconds: u64| Wish {
            id: Some(id.into()),
            throttle: Duration::from_millis(milliseconds),
            queue: 0,
        };
        let mut both = Subscription::default();
        both.add(wish("slow", 3_600_000));
        both.add(wish("fast", 0));
        assert!(both.take("a").is_some() && both.take("b").is_some());
        assert!(both.remove(Some("fast")));
        assert!(both.take("c").is_none());
        both.add(wish("slow", 0));
        assert_eq!(both.count(), 1);
        assert!(!both.remove(None));
    }
}
