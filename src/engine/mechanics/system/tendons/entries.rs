//! Elements of the unknowns of a tendon.
//!
//! Its unknowns are grouped by six. Every two groups that the tendon couples share one element.

use crate::linalg::{Element, ElementMatrix, UNUSED};
use std::collections::BTreeSet;

/// Unknowns of a group: half of an element.
const GROUP: usize = 6;
/// No element.
const NONE: usize = usize::MAX;

/// The unknowns of a tendon, and the elements to which its derivatives are added.
#[derive(Clone, Debug)]
pub(super) struct TendonEntries {
    /// Sorted.
    unknowns: Vec<usize>,
    /// The two groups of each element.
    pairs: Vec<[usize; 2]>,
    /// Number of groups.
    groups: usize,
    /// Element of two groups, by `row * groups + column`.
    element_of: Vec<usize>,
}

impl TendonEntries {
    /// Numbers the unknowns of eyelets, which are coupled to those of the neighbouring eyelets, or
    /// of all. Returns the indices of the unknowns of each eyelet among those of the tendon.
    pub(super) fn new(of_eyelets: &[Vec<usize>], couples_all: bool) -> (Self, Vec<Vec<usize>>) {
        let unknowns: BTreeSet<usize> = of_eyelets.iter().flatten().copied().collect();
        let unknowns: Vec<usize> = unknowns.into_iter().collect();
        let slot = |unknown: &usize| unknowns.binary_search(unknown).expect("listed above");
        let slots = of_eyelets.iter().map(|own| own.iter().map(slot).collect());
        let slots: Vec<Vec<usize>> = slots.collect();
        let groups = unknowns.len().div_ceil(GROUP);
        let mut coupled: BTreeSet<[usize; 2]> = BTreeSet::new();
        let mut couple = |slots: &[usize]| {
            let own: BTreeSet<usize> = slots.iter().map(|slot| slot / GROUP).collect();
            for &one in &own {
                coupled.extend(own.range(one..).map(|&other| [one, other]));
            }
        };
        if couples_all {
            couple(&slots.concat());
        } else {
            slots.windows(2).for_each(|ends| couple(&ends.concat()));
        }
        // A group that is coupled to another has its own block in an element of both.
        let alone = |&[one, other]: &[usize; 2]| {
            let mut others = coupled.iter();
            one != other || !others.any(|pair| pair[0] != pair[1] && pair.contains(&one))
        };
        let pairs: Vec<[usize; 2]> = coupled.iter().copied().filter(alone).collect();
        let mut element_of = vec![NONE; groups * groups];
        for (element, &[one, other]) in pairs.iter().enumerate() {
            for [row, column] in [[one, other], [other, one]] {
                element_of[row * groups + column] = element;
            }
            for group in [one, other] {
                element_of[group * groups + group] = element;
            }
        }
        let entries = Self {
            unknowns,
            pairs,
            groups,
            element_of,
        };
        (entries, slots)
    }

    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.pairs.len()
    }

    /// The elements.
    pub(super) fn elements(&self) -> impl Iterator<Item = Element> {
        self.pairs.iter().map(|&[one, other]| {
            let mut element = [UNUSED; 2 * GROUP];
            for (half, group) in [one, other].into_iter().enumerate() {
                if half == 1 && one == other {
                    continue;
                }
                let own = self.unknowns.iter().skip(GROUP * group).take(GROUP);
                for (place, unknown) in element[GROUP * half..].iter_mut().zip(own) {
                    *place = *unknown;
                }
            }
            element
        })
    }

    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.unknowns.len()
    }

    /// An unknown by its index among those of the tendon.
    pub(super) fn unknown(&self, slot: usize) -> usize {
        self.unknowns[slot]
    }

    /// Adds a derivative over two unknowns, by their indices, to the matrices of the elements.
    pub(super) fn add(
        &self,
        matrices: &mut [ElementMatrix],
        row: usize,
        column: usize,
        value: f64,
    ) {
        let element = self.element_of[row / GROUP * self.groups + column / GROUP];
        let [one, _] = self.pairs[element];
        let place = |slot: usize| {
            let half = usize::from(slot / GROUP != one);
            GROUP * half + slot % GROUP
        };
        matrices[element][place(row)][place(column)] += value;
    }
}
