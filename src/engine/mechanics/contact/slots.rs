//! Slots for the data that contacts keep between iterations and between steps.

use super::candidates::carried_over;
use super::contacts::CandidatePair;

/// The slots of a scene: candidate pairs first, then every node over every plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slots {
    /// Candidate pairs.
    pub candidates: usize,
    /// Nodes of all rods.
    pub nodes: usize,
    /// Planes.
    pub planes: usize,
}

impl Slots {
    /// Number of slots.
    pub(crate) fn count(&self) -> usize {
        self.candidates + self.planes * self.nodes
    }

    /// Slot of a node over a plane.
    pub(crate) fn over_plane(&self, plane: usize, node: usize) -> usize {
        self.candidates + plane * self.nodes + node
    }
}

/// Values of some of the slots. At a fine mesh one of ten candidates is in contact, and its linear
/// laws take 350 bytes.
#[derive(Clone, Debug)]
pub(super) struct SlotValues<T> {
    /// Index of the value of each slot plus one; zero if it has none.
    places: Vec<usize>,
    /// The slot of each value.
    slots: Vec<usize>,
    values: Vec<T>,
}

impl<T> Default for SlotValues<T> {
    fn default() -> Self {
        Self {
            places: Vec::new(),
            slots: Vec::new(),
            values: Vec::new(),
        }
    }
}

impl<T: Copy> SlotValues<T> {
    /// Discards all values and sets the number of slots.
    pub(crate) fn clear(&mut self, count: usize) {
        self.forget();
        self.places.resize(count, 0);
    }

    /// Discards all values.
    pub(crate) fn forget(&mut self) {
        for slot in self.slots.drain(..) {
            self.places[slot] = 0;
        }
        self.values.clear();
    }

    /// The value of a slot.
    pub(crate) fn get(&self, slot: usize) -> Option<&T> {
        let place = self.places[slot].checked_sub(1)?;
        Some(&self.values[place])
    }

    /// Gives a slot a value.
    pub(crate) fn set(&mut self, slot: usize, value: T) {
        match self.places[slot].checked_sub(1) {
            Some(place) => self.values[place] = value,
            None => {
                self.slots.push(slot);
                self.values.push(value);
                self.places[slot] = self.values.len();
            }
        }
    }

    /// Carries the values over to a new list of candidates; both lists are sorted.
    pub(crate) fn carry_over(&mut self, old: &[CandidatePair], new: &[CandidatePair]) {
        self.places = carried_over(old, &self.places, new);
        self.slots.clear();
        let mut values = Vec::with_capacity(self.values.len());
        for (slot, place) in self.places.iter_mut().enumerate() {
            if *place > 0 {
                self.slots.push(slot);
                values.push(self.values[*place - 1]);
                *place = values.len();
            }
        }
        self.values = values;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(i: usize, j: usize) -> CandidatePair {
        CandidatePair {
            edges: [i, j],
            nodes: [i, i + 1, j, j + 1],
            side: 0,
            start: 0,
        }
    }

    #[test]
    fn values_follow_their_pairs_and_those_beyond_stay_behind_them() {
        let mut values = SlotValues::default();
        let old = [pair(0, 4), pair(1, 4), pair(2, 7)];
        values.clear(old.len() + 2);
        for (slot, value) in [(4, 'e'), (1, 'b'), (0, 'a'), (2, 'x'), (2, 'c')] {
            values.set(slot, value);
        }
        let new = [pair(0, 3), pair(1, 4), pair(2, 6), pair(2, 7)];
        values.carry_over(&old, &new);
        let found: Vec<_> = (0..6).map(|slot| values.get(slot).copied()).collect();
        assert_eq!(found, [None, Some('b'), None, Some('c'), None, Some('e')]);
        values.set(0, 'n');
        assert_eq!(values.get(0), Some(&'n'));
        values.clear(2);
        assert!((0..2).all(|slot| values.get(slot).is_none()));
    }
}
