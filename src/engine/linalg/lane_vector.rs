//! Arrays of [`Lanes`] whose every entry fills one line of the cache: registers of 64 bytes load and store such entries at once,
//! others by two halves.

use super::instruction_set::{LANES, Lanes};
use std::ops::{Deref, DerefMut};

/// Bytes of a line of the cache.
const LINE: usize = 64;

/// Entries that begin at lines of the cache.
#[derive(Debug)]
pub(crate) struct LaneVector {
    storage: Vec<f64>,
    /// Place of the first number in the storage.
    first: usize,
    length: usize,
}

impl LaneVector {
    /// So many zeros in every lane.
    pub(crate) fn new(length: usize) -> Self {
        let storage = vec![0.0; LANES * (length + 1)];
        // Where the place of the storage is unknown, its entries are right, and slower.
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
