//! Arrays of [`Lanes`] aligned to cache lines: registers of 64 bytes load and store an aligned
//! entry at once; an unaligned one takes two halves.

use super::instruction_set::{LANES, Lanes};
use std::ops::{Deref, DerefMut};

/// Bytes of a cache line.
const LINE: usize = 64;

/// Entries that begin at cache lines.
#[derive(Debug)]
pub(crate) struct LaneVector {
    storage: Vec<f64>,
    /// Index in the storage of the first number used.
    first: usize,
    length: usize,
}

impl LaneVector {
    /// A vector of `length` zeros in every lane.
    pub(crate) fn new(length: usize) -> Self {
        let storage = vec![0.0; LANES * (length + 1)];
        // If the alignment cannot be determined, results are the same, only slower.
        let first = storage.as_ptr().align_offset(LINE).min(LANES);
        Self {
            storage,
            first,
            length,
        }
    }
}

impl Deref for LaneVector {
    type Target = [Lanes];

    fn deref(&self) -> &[Lanes] {
        let (entries, _) = self.storage[self.first..].as_chunks();
        &entries[..self.length]
    }
}

impl DerefMut for LaneVector {
    fn deref_mut(&mut self) -> &mut [Lanes] {
        let (entries, _) = self.storage[self.first..].as_chunks_mut();
        &mut entries[..self.length]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_begin_at_lines_of_the_cache() {
        for length in [0, 1, 5, 300] {
            let mut vector = LaneVector::new(length);
            assert_eq!(vector.len(), length);
            assert_eq!(vector.as_ptr().align_offset(LINE), 0);
            for entry in vector.iter_mut() {
                assert_eq!(*entry, [0.0; LANES]);
                *entry = [1.0; LANES];
            }
            assert!(vector.iter().all(|entry| *entry == [1.0; LANES]));
        }
    }
}
