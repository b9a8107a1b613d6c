//! The Newton system of rods of which some touch: the rods that elements couple, and the rest,
//! which is factored as a band.

use super::banded::{BandedFactor, BandedSymmetric};
use super::coupled::CoupledSystem;
use super::element::{Element, ElementMatrix, SharedUnknown, UNUSED};
use super::error::{Inertia, SingularMatrix};
use super::node_block::NODE;
use std::ops::Range;

/// Least number of free nodes for which the distinction is worth its code: the sparse factors of rods
/// that are not coupled take a few times as long as those of the band.
const LEAST_FREE: usize = 1000;

/// A system whose pattern contains the coupled rods only.
#[derive(Clone, Debug)]
pub(crate) struct Islands {
    system: CoupledSystem,
    /// Where some rods are free.
    subset: Option<Subset>,
}

/// The coupled rods among all.
#[derive(Clone, Debug)]
struct Subset {
    /// Unknowns of the coupled chains.
    coupled: Vec<Range<usize>>,
    /// Unknowns of the other chains, in parts that are factored together.
    free: Vec<Range<usize>>,
    /// The band of the coupled chains.
    band: BandedSymmetric,
    /// Right-hand side and solution for the coupled chains.
    values: Vec<f64>,
}

/// The unknowns that a system couples: the arguments of [`CoupledSystem::new`].
pub(crate) struct Couplings<'a> {
    pub dimension: usize,
    pub elements: &'a [Element],
    pub held: &'a [bool],
    pub shared: &'a [SharedUnknown],
    /// First node of each part of the band, in order.
    pub chains: &'a [usize],
    pub symmetric: bool,
}

impl Islands {
    /// Determines the pattern of the chains that elements couple, and of those with shared
    /// unknowns.
    pub(crate) fn new(of: &Couplings) -> Self {
        let whole = || Self {
            system: CoupledSystem::new(
                of.dimension,
                of.elements,
                of.held,
                of.shared,
                of.chains,
                of.symmetric,
            ),
            subset: None,
        };
        let mut is_coupled = vec![false; of.chains.len()];
        let mut couple = |unknown: usize| {
            if unknown != UNUSED {
                is_coupled[chain_of(of.chains, unknown)] = true;
            }
        };
        (of.elements.as_flattened().iter().copied()).for_each(&mut couple);
        for one in of.shared {
            couple(one.unknown);
            couple(one.owner);
        }
        let ends = of
            .chains
            .iter()
            .skip(1)
            .copied()
            .chain([of.dimension.div_ceil(NODE)]);
        let ranges = of.chains.iter().zip(ends);
        let unknowns = |(first, end): (&usize, usize)| NODE * first..(NODE * end).min(of.dimension);
        let (coupled, free): (Vec<_>, Vec<_>) =
            (ranges.map(unknowns).zip(&is_coupled)).partition(|(_, is_coupled)| **is_coupled);
        let [coupled, free] = [coupled, free].map(|ranges| {
            ranges
                .into_iter()
                .map(|(range, _)| range)
                .collect::<Vec<_>>()
        });
        let is_regular = of.chains.first() == Some(&0) && of.dimension.is_multiple_of(NODE);
        let free_unknowns: usize = free.iter().map(ExactSizeIterator::len).sum();
        if !is_regular || free_unknowns < NODE * LEAST_FREE {
            return whole();
        }
        let subset = Subset {
            band: BandedSymmetric::new(of.dimension - free_unknowns),
            values: vec![0.0; of.dimension - free_unknowns],
            free: BandedFactor::parts_of(free.into_iter()),
            coupled,
        };
        subset.of(of)
    }

    /// Sets the matrix to `band`, see [`CoupledSystem::assemble`].
    pub(crate) fn assemble(&mut self, band: &BandedSymmetric) {
        let Some(subset) = &mut self.subset else {
            return self.system.assemble(band);
        };
        let mut own = subset.band.columns_mut();
        for range in &subset.coupled {
            let (columns, rest) = own.split_at_mut(range.len());
            columns.copy_from_slice(&band.columns()[range.clone()]);
            own = rest;
        }
        self.system.assemble(&subset.band);
    }

    /// Adds the matrix of an element.
    #[inline]
    pub(crate) fn add_element(&mut self, index: usize, matrix: &ElementMatrix) {
        self.system.add_element(index, matrix);
    }

    /// Factors the assembled matrix, and the other chains of `band` into `factor`; returns the
    /// inertia of a symmetric system.
    ///
    /// # Errors
    /// A pivot that is zero or not finite.
    pub(crate) fn factor(
        &mut self,
        band: &BandedSymmetric,
        factor: &mut BandedFactor,
    ) -> Result<Option<Inertia>, SingularMatrix> {
        let Some(subset) = &self.subset else {
            return self.system.factor();
        };
        let free = factor.factor_parts(band, &subset.free)?;
        let coupled = self.system.factor().map_err(|error| subset.named(error))?;
        Ok(coupled.map(|coupled| free.and(coupled)))
    }

    /// Solves A x = b in place with the factors of the last [`Self::factor`].
    ///
    /// # Errors
    /// A residual that stays large, see [`CoupledSystem::solve`].
    pub(crate) fn solve(
        &mut self,
        right_hand_side: &mut [f64],
        factor: &BandedFactor,
    ) -> Result<(), SingularMatrix> {
        let Some(subset) = &mut self.subset else {
            return self.system.solve(right_hand_side);
        };
        subset.values.clear();
        for range in &subset.coupled {
            subset
                .values
                .extend_from_slice(&right_hand_side[range.clone()]);
        }
        let solved = self.system.solve(&mut subset.values);
        solved.map_err(|error| subset.named(error))?;
        let mut values = &subset.values[..];
        for range in &subset.coupled {
            let (own, rest) = values.split_at(range.len());
            right_hand_side[range.clone()].copy_from_slice(own);
            values = rest;
        }
        factor.solve_parts(right_hand_side, &subset.free);
        Ok(())
    }
}

impl Subset {
    /// The system of the coupled chains.
    fn of(self, of: &Couplings) -> Islands {
        let mut number = vec![UNUSED; of.dimension];
        let all = self.coupled.iter().flat_map(Range::clone);
        all.enumerate()
            .for_each(|(own, unknown)| number[unknown] = own);
        let numbered = |unknown: usize| number.get(unknown).copied().unwrap_or(UNUSED);
        let elements: Vec<Element> = (of.elements.iter())
            .map(|element| element.map(numbered))
            .collect();
        let shared: Vec<SharedUnknown> = (of.shared.iter())
            .map(|one| SharedUnknown {
                unknown: number[one.unknown],
                owner: number[one.owner],
            })
            .collect();
        let held: Vec<bool> = self
            .coupled
            .iter()
            .flat_map(|range| &of.held[range.clone()])
            .copied()
            .collect();
        let chains: Vec<usize> = (self.coupled.iter())
            .map(|range| number[range.start] / NODE)
            .collect();
        Islands {
            system: CoupledSystem::new(
                held.len(),
                &elements,
                &held,
                &shared,
                &chains,
                of.symmetric,
            ),
            subset: Some(self),
        }
    }

    /// An error with the number of its unknown among all.
    fn named(&self, error: SingularMatrix) -> SingularMatrix {
        let mut all = self.coupled.iter().flat_map(Range::clone);
        let unknown = all.nth(error.unknown).unwrap_or(error.unknown);
        SingularMatrix { unknown, ..error }
    }
}

/// The chain of an unknown.
fn chain_of(chains: &[usize], unknown: usize) -> usize {
    chains.partition_point(|first| *first <= unknown / NODE) - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::HALF_BANDWIDTH;

    const NODES: usize = 15;
    const CHAINS: usize = 100;
    const DIMENSION: usize = NODE * NODES * CHAINS;

    /// Chains whose nodes are coupled up to two apart.
    fn band() -> BandedSymmetric {
        let mut band = BandedSymmetric::new(DIMENSION);
        let columns = band.columns_mut().chunks_mut(NODE * NODES);
        for (chain, columns) in columns.enumerate() {
            for j in 0..columns.len() {
                let reach = (HALF_BANDWIDTH + 1).min(3 * NODE - j % NODE);
                for r in 1..reach.min(columns.len() - j) {
                    columns[j][r] = ((7 * chain + 3 * j + r) as f64).sin();
                }
                columns[j][0] = if j % 9 == 4 { -30.0 } else { 30.0 };
            }
        }
        band
    }

    /// The positions of the nodes `at` of four chains.
    fn element(chains: [usize; 4], at: usize) -> Element {
        std::array::from_fn(|k| NODE * (NODES * chains[k / 3] + at) + k % 3)
    }

    fn matrix(seed: usize) -> ElementMatrix {
        let entry = |i: usize, j: usize| ((seed + 5 * (i + j) + i * j) as f64).cos();
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    #[test]
    fn a_pattern_of_the_coupled_chains_gives_the_solution_of_all() {
        let band = band();
        let elements = [
            element([3, 4, 50, 99], 2),
            element([4, 8, 9, 10], NODES - 1),
            element([20, 21, 50, 3], 7),
        ];
        let held: Vec<bool> = (0..DIMENSION)
            .map(|k| k % NODE == 3 && k % 5 == 0)
            .collect();
        let mut held_band = band.clone();
        (0..DIMENSION)
            .filter(|k| held[*k])
            .for_each(|k| held_band.hold(k..k + 1));
        let shared = [SharedUnknown {
            unknown: NODE * NODES * 70 + 1,
            owner: NODE * NODES * 71 + 1,
        }];
        let chains: Vec<usize> = (0..CHAINS).map(|chain| NODES * chain).collect();
        let right: Vec<f64> = (0..DIMENSION).map(|k| (0.3 * k as f64).sin()).collect();
        for symmetric in [true, false] {
            let couplings = Couplings {
                dimension: DIMENSION,
                elements: &elements,
                held: &held,
                shared: &shared,
                chains: &chains,
                symmetric,
            };
            let mut factor = BandedFactor::new(DIMENSION);
            let mut all =
                CoupledSystem::new(DIMENSION, &elements, &held, &shared, &chains, symmetric);
            let mut islands = Islands::new(&couplings);
            for active in [&[1][..], &[0, 1, 2]] {
                assert!(islands.subset.as_ref().unwrap().free.len() > 1);
                all.assemble(&held_band);
                islands.assemble(&held_band);
                for &index in active {
                    all.add_element(index, &matrix(index));
                    islands.add_element(index, &matrix(index));
                }
                let expected = all.factor().unwrap();
                let found = islands.factor(&held_band, &mut factor).unwrap();
                let signs = |inertia: Inertia| [inertia.positive, inertia.negative];
                assert_eq!(found.map(signs), expected.map(signs));
                let [mut x, mut y] = [right.clone(), right.clone()];
                for (k, held) in held.iter().enumerate() {
                    if *held || k == shared[0].unknown {
                        (x[k], y[k]) = (0.0, 0.0);
                    }
                }
                all.solve(&mut x).unwrap();
                islands.solve(&mut y, &factor).unwrap();
                let error = x
                    .iter()
                    .zip(&y)
                    .map(|(x, y)| (x - y).abs())
                    .fold(0.0, f64::max);
                assert!(error < 1e-13, "{error}");
            }
        }
    }

    #[test]
    fn a_singular_chain_is_named_by_its_own_unknown() {
        let mut band = band();
        let unknown = NODE * NODES * 60 + 5;
        band.hold(unknown..unknown + 1);
        band.columns_mut()[unknown][0] = 0.0;
        let chains: Vec<usize> = (0..CHAINS).map(|chain| NODES * chain).collect();
        for coupled in [60, 61] {
            let elements = [element([coupled, 10, 11, 12], 2)];
            let couplings = Couplings {
                dimension: DIMENSION,
                elements: &elements,
                held: &[false; DIMENSION],
                shared: &[],
                chains: &chains,
                symmetric: true,
            };
            let mut factor = BandedFactor::new(DIMENSION);
            let mut islands = Islands::new(&couplings);
            islands.assemble(&band);
            let error = islands.factor(&band, &mut factor).unwrap_err();
            assert_eq!(error.unknown, unknown);
        }
    }
}
