//! Work on consecutive parts of arrays in all threads of the pool.

use rayon::prelude::*;
use std::ops::Range;

/// Number of entries of an array that are processed together: waking a thread takes as long as
/// thousands of sums.
const CHUNK: usize = 8192;

/// Consecutive entries of an array.
pub(crate) struct Span<'a, T> {
    pub entries: &'a mut [T],
    /// Index of the first of them.
    pub first: usize,
}

impl<'a, T> Span<'a, T> {
    pub(crate) fn all(entries: &'a mut [T]) -> Self {
        Self { entries, first: 0 }
    }

    /// Cuts before the entry of an index.
    pub(crate) fn cut(self, index: usize) -> (Self, Self) {
        let (before, after) = self.entries.split_at_mut(index - self.first);
        let before = Self {
            entries: before,
            first: self.first,
        };
        let after = Self {
            entries: after,
            first: index,
        };
        (before, after)
    }

    /// The entries of a range.
    pub(crate) fn of(&mut self, range: &Range<usize>) -> &mut [T] {
        &mut self.entries[range.start - self.first..range.end - self.first]
    }

    pub(crate) fn reborrow(&mut self) -> Span<'_, T> {
        Span {
            entries: self.entries,
            first: self.first,
        }
    }
}

/// Calls `work` once for each of the consecutive `parts` of a `whole`, in parallel, and returns
/// `both` of all results, in their order. `cut` divides at the start of a part, which is not the
/// first. A single part is processed in the calling thread.
///
/// # Panics
/// Without parts.
pub(crate) fn in_parts<P: Sync, T: Send, R: Send>(
    parts: &[P],
    whole: T,
    cut: &(impl Fn(T, &P) -> (T, T) + Sync),
    work: &(impl Fn(&P, T) -> R + Sync),
    both: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if let [part] = parts {
        return work(part, whole);
    }
    let (before, after) = parts.split_at(parts.len() / 2);
    let (of_before, of_after) = cut(whole, &after[0]);
    let first = || in_parts(before, of_before, cut, work, both);
    let second = || in_parts(after, of_after, cut, work, both);
    let (one, other) = match rayon::current_num_threads() {
        1 => (first(), second()),
        _ => rayon::join(first, second),
    };
    both(one, other)
}

/// Calls `work` for consecutive pieces of an array, in parallel if it is large, with the index of
/// the first entry of each piece.
pub(crate) fn in_chunks<T: Send>(entries: &mut [T], work: &(impl Fn(usize, &mut [T]) + Sync)) {
    if entries.len() <= CHUNK || rayon::current_num_threads() == 1 {
        return work(0, entries);
    }
    let chunks = entries.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(chunk, own)| work(CHUNK * chunk, own));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_processed_once_and_results_keep_their_order() {
        for count in 1..9 {
            let starts: Vec<usize> = (0..count).map(|part| part * part).collect();
            let mut whole = vec![0; 80];
            let order = in_parts(
                &starts,
                Span::all(&mut whole),
                &|span, start| span.cut(*start),
                &|start, own| {
                    assert_eq!(*start, own.first);
                    own.entries.iter_mut().for_each(|entry| *entry += 1 + start);
                    vec![*start]
                },
                &|one, other| [one, other].concat(),
            );
            assert_eq!(order, starts);
            let start_of = |k: usize| starts.iter().rev().find(|start| **start <= k).unwrap();
            assert!((whole.iter().enumerate()).all(|(k, entry)| *entry == 1 + start_of(k)));
        }
    }
}
