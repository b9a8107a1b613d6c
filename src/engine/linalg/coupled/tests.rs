use super::*;
use crate::linalg::{HALF_BANDWIDTH, UNUSED};
use nalgebra::{DMatrix, DVector};

/// A repeatable stream of numbers in [-1, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, bound: usize) -> usize {
        ((self.next() + 1.0) / 2.0 * bound as f64) as usize
    }
}

/// A coupled system and the same system as a dense matrix.
struct Example {
    system: CoupledSystem,
    dense: DMatrix<f64>,
    band: BandedSymmetric,
    matrices: Vec<ElementMatrix>,
}

/// A band of windows of 11 unknowns, pairs of edges as elements, one ring closure and some held
/// unknowns. Without `dominance` the matrix is indefinite.
fn example(dimension: usize, count: usize, symmetric: bool, dominance: f64) -> Example {
    let mut numbers = Numbers(dimension as u64 + 31 * count as u64);
    let mut band = BandedSymmetric::new(dimension);
    for first in (0..dimension).step_by(NODE) {
        let window = first..dimension.min(first + HALF_BANDWIDTH + 1);
        for j in window.clone() {
            band.add(j, j, dominance);
            for i in j..window.end {
                band.add(i, j, numbers.next());
            }
        }
    }
    let mut held = vec![false; dimension];
    for i in [0, 1, 2, 3, 4, 5, 6, 21, dimension - 1] {
        held[i] = true;
    }
    let nodes = dimension / NODE;
    let edge_pair = |a: usize, b: usize| -> Element {
        std::array::from_fn(|k| NODE * [a, a + 1, b, b + 1][k / 3] + k % 3)
    };
    let mut elements = vec![[UNUSED; 12]];
    for place in 0..11 {
        elements[0][place] = (dimension - 4 + place) % dimension;
    }
    for _ in 0..count {
        elements.push(edge_pair(
            numbers.below(nodes - 1),
            numbers.below(nodes - 1),
        ));
    }
    elements.retain(|element| {
        let used: Vec<_> = element.iter().filter(|&&i| i != UNUSED).collect();
        (1..used.len()).all(|k| !used[..k].contains(&used[k]))
    });
    let matrices: Vec<ElementMatrix> = elements
        .iter()
        .map(|_| {
            let mut matrix = [[0.0; 12]; 12];
            for i in 0..12 {
                for j in 0..=i {
                    matrix[i][j] = numbers.next();
                    matrix[j][i] = if symmetric {
                        matrix[i][j]
                    } else {
                        numbers.next()
                    };
                }
                matrix[i][i] += dominance;
            }
            matrix
        })
        .collect();

    let mut dense = DMatrix::from_fn(dimension, dimension, |i, j| band.get(i, j));
    for (element, matrix) in elements.iter().zip(&matrices) {
        for (r, &i) in element.iter().enumerate().filter(|(_, i)| **i != UNUSED) {
            for (c, &j) in element.iter().enumerate().filter(|(_, j)| **j != UNUSED) {
                dense[(i, j)] += matrix[r][c];
            }
        }
    }
    for i in (0..dimension).filter(|&i| held[i]) {
        dense.row_mut(i).fill(0.0);
        dense.column_mut(i).fill(0.0);
        dense[(i, i)] = 1.0;
        band.hold(i..i + 1);
    }
    let system = CoupledSystem::new(dimension, &elements, &held, &[], &[], symmetric);
    Example {
        system,
        dense,
        band,
        matrices,
    }
}

impl Example {
    fn factor(&mut self) -> Result<Option<Inertia>, SingularMatrix> {
        self.system.assemble(&self.band);
        for (index, matrix) in self.matrices.iter().enumerate() {
            self.system.add_element(index, matrix);
        }
        self.system.factor()
    }

    fn solve(&mut self) -> (Vec<f64>, DVector<f64>) {
        let expected = DVector::from_fn(self.dense.nrows(), |i, _| (0.3 * i as f64).cos());
        let mut x = (&self.dense * &expected).as_slice().to_vec();
        self.system.solve(&mut x).unwrap();
        (x, expected)
    }
}

#[test]
fn agrees_with_the_dense_matrix() {
    for symmetric in [true, false] {
        for (dimension, count, dominance) in [
            (40, 0, 20.0),
            (40, 8, 20.0),
            (122, 30, 20.0),
            (271, 60, 20.0),
            (122, 30, 0.0),
        ] {
            let mut example = example(dimension, count, symmetric, dominance);
            // The second assembly must not see the first.
            for _ in 0..2 {
                example.factor().unwrap();
                let (x, expected) = example.solve();
                let error = (DVector::from_vec(x) - expected).amax();
                let bound = if dominance > 0.0 { 1e-13 } else { 1e-8 };
                assert!(error < bound, "{dimension} {count} {symmetric}: {error:e}");
            }
        }
    }
}

#[test]
fn inertia_counts_the_eigenvalues() {
    for dominance in [0.0, 3.0, 20.0] {
        let mut example = example(122, 20, true, dominance);
        let inertia = example.factor().unwrap().expect("symmetric");
        let eigenvalues = example.dense.symmetric_eigenvalues();
        let negative = eigenvalues.iter().filter(|&&value| value < 0.0).count();
        assert_eq!(inertia.negative, negative);
        assert_eq!(inertia.positive, 122 - negative);
    }
}

/// Second differences have stiff and soft directions that rotate from node to node. They involve
/// three consecutive nodes, but not the fourth unknown of the last one, which keeps them in the
/// band.
#[test]
fn a_stiff_ring_on_weak_springs_is_positive() {
    let (nodes, spring) = (120, 1e-3);
    let dimension = NODE * nodes;
    let mut band = BandedSymmetric::new(dimension);
    let mut dense = DMatrix::from_diagonal_element(dimension, dimension, spring);
    (0..dimension).for_each(|k| band.add(k, k, spring));
    // Three unknowns of each node, so that an element holds a whole vertex.
    let elements: Vec<Element> = [nodes - 2, nodes - 1]
        .map(|k| {
            std::array::from_fn(|place| {
                let unknown = (NODE * k + place) % dimension;
                if place < 11 { unknown } else { UNUSED }
            })
        })
        .to_vec();
    let mut matrices = vec![[[0.0; 12]; 12]; 2];
    for k in 0..nodes {
        let angle = 0.7 * k as f64;
        let (sin, cos) = angle.sin_cos();
        let axes = [
            [cos, sin, 0.1, 0.0],
            [-sin, cos, 0.0, 0.2],
            [0.1 * cos, 0.0, 1.0, sin],
            [0.0, 0.1, -sin, 1.0],
        ];
        for (axis, stiffness) in axes.iter().zip([1e6, 1e6, 1e4, 1e2]) {
            let strain: [f64; 11] =
                std::array::from_fn(|i| [1.0, -2.0, 1.0][i / NODE] * axis[i % NODE]);
            let unknown = |i: usize| (NODE * k + i) % dimension;
            for i in 0..11 {
                for j in 0..11 {
                    let value = stiffness * strain[i] * strain[j];
                    dense[(unknown(i), unknown(j))] += value;
                    if k + 2 >= nodes {
                        matrices[k + 2 - nodes][i][j] += value;
                    } else if i >= j {
                        band.add(unknown(i), unknown(j), value);
                    }
                }
            }
        }
    }
    let system = CoupledSystem::new(
        dimension,
        &elements,
        &vec![false; dimension],
        &[],
        &[],
        true,
    );
    let mut example = Example {
        system,
        dense,
        band,
        matrices,
    };
    assert_eq!(example.factor().unwrap().unwrap().negative, 0);
    let (x, expected) = example.solve();
    let error = (DVector::from_vec(x) - expected).amax();
    assert!(error < 1e-5, "{error:e}");
}

/// A shared unknown equals its owner: the system is that of the dense matrix Pᵀ A P, where P maps
/// own unknowns to all unknowns.
#[test]
fn shared_unknowns_are_solved_as_one() {
    for symmetric in [true, false] {
        let mut numbers = Numbers(7);
        let dimension = 120;
        let plain = example(dimension, 10, symmetric, 20.0);
        let mut held = vec![false; dimension];
        for i in [0, 1, 2, 3, 4, 5, 6, 21, dimension - 1] {
            held[i] = true;
        }
        // Two positions shared with distant nodes, one with the second next node, and one with a
        // held node.
        let shared: Vec<SharedUnknown> = [(60, 20), (84, 20), (100, 92), (112, 4)]
            .into_iter()
            .flat_map(|(unknown, owner)| {
                (0..3).map(move |axis| SharedUnknown {
                    unknown: unknown + axis,
                    owner: owner + axis,
                })
            })
            .collect();
        let mut elements = vec![[UNUSED; 12]; 6];
        let mut matrices = vec![[[0.0; 12]; 12]; 6];
        let nodes = dimension / NODE;
        for (element, matrix) in elements.iter_mut().zip(&mut matrices) {
            let (a, b) = (numbers.below(nodes - 1), numbers.below(nodes - 3));
            let b = if b.abs_diff(a) < 2 { b + 3 } else { b } % (nodes - 1);
            if a.abs_diff(b) < 2 {
                continue;
            }
            *element = std::array::from_fn(|k| NODE * [a, a + 1, b, b + 1][k / 3] + k % 3);
            for i in 0..12 {
                for j in 0..=i {
                    matrix[i][j] = numbers.next();
                    matrix[j][i] = if symmetric {
                        matrix[i][j]
                    } else {
                        numbers.next()
                    };
                }
            }
        }
        let owner = |i: usize| {
            let found = shared.iter().find(|one| one.unknown == i);
            found.map_or(i, |one| one.owner)
        };
        let mut dense = DMatrix::zeros(dimension, dimension);
        for i in 0..dimension {
            for j in 0..dimension {
                dense[(owner(i), owner(j))] += plain.band.get(i, j);
            }
        }
        for (element, matrix) in elements.iter().zip(&matrices) {
            for (r, &i) in element.iter().enumerate().filter(|(_, i)| **i != UNUSED) {
                for (c, &j) in element.iter().enumerate().filter(|(_, j)| **j != UNUSED) {
                    dense[(owner(i), owner(j))] += matrix[r][c];
                }
            }
        }
        let gone = |i: usize| held[i] || owner(i) != i;
        for i in (0..dimension).filter(|&i| gone(i)) {
            dense.row_mut(i).fill(0.0);
            dense.column_mut(i).fill(0.0);
            dense[(i, i)] = 1.0;
        }
        let mut system = CoupledSystem::new(dimension, &elements, &held, &shared, &[], symmetric);
        // The second assembly must not see the first.
        for _ in 0..2 {
            system.assemble(&plain.band);
            for (index, matrix) in matrices.iter().enumerate() {
                system.add_element(index, matrix);
            }
            system.factor().unwrap();
            let expected = DVector::from_fn(dimension, |i, _| (0.3 * i as f64).cos());
            let mut x = (&dense * &expected).as_slice().to_vec();
            system.solve(&mut x).unwrap();
            let error = (DVector::from_vec(x) - expected).amax();
            assert!(error < 1e-12, "{symmetric}: {error:e}");
        }
    }
}

#[test]
fn held_unknowns_keep_their_right_hand_side() {
    let mut example = example(80, 10, true, 20.0);
    example.factor().unwrap();
    let mut x: Vec<f64> = (0..80).map(|i| i as f64).collect();
    example.system.solve(&mut x).unwrap();
    for i in [0, 1, 2, 3, 4, 5, 6, 21, 79] {
        assert_eq!(x[i], i as f64);
    }
}

#[test]
fn chains_that_nothing_couples_fill_nothing_between_them() {
    // Forty rods of ten nodes; entries between consecutive rods are zero.
    let (rods, nodes) = (40, 10);
    let dimension = NODE * rods * nodes;
    let mut band = BandedSymmetric::new(dimension);
    for j in 0..dimension {
        band.add(j, j, 20.0);
        for i in j + 1..dimension.min(j + HALF_BANDWIDTH + 1) {
            let is_inside = i / (NODE * nodes) == j / (NODE * nodes) && i / NODE <= j / NODE + 2;
            if is_inside {
                band.add(i, j, (0.7 * (i + 3 * j) as f64).sin());
            }
        }
    }
    let elements: Vec<Element> = (0..rods)
        .map(|k| {
            let (a, b) = (nodes * k + 4, nodes * ((7 * k + 3) % rods) + 6);
            std::array::from_fn(|place| NODE * [a, a + 1, b, b + 1][place / 3] + place % 3)
        })
        .collect();
    let chains: Vec<usize> = (0..rods).map(|rod| nodes * rod).collect();
    let held = vec![false; dimension];
    let solve = |chains: &[usize]| {
        let mut system = CoupledSystem::new(dimension, &elements, &held, &[], chains, true);
        system.assemble(&band);
        for index in 0..rods {
            system.add_element(index, &[[0.1; 12]; 12]);
        }
        system.factor().unwrap();
        let mut x: Vec<f64> = (0..dimension).map(|k| (0.3 * k as f64).cos()).collect();
        system.solve(&mut x).unwrap();
        (x, system.factor_blocks())
    };
    let ((one, joined), (other, apart)) = (solve(&[]), solve(&chains));
    assert!(apart < joined, "{apart} of {joined}");
    assert!(one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-13));
}

#[test]
fn without_elements_it_solves_as_the_band_does() {
    let Example { band, .. } = example(120, 0, true, 15.0);
    let mut factor = crate::linalg::BandedFactor::new(120);
    let mut system = CoupledSystem::new(120, &[], &[false; 120], &[], &[], true);
    system.assemble(&band);
    assert_eq!(
        factor.factor(&band).unwrap().positive,
        system.factor().unwrap().unwrap().positive
    );
    let mut x = vec![1.0; 120];
    let mut y = x.clone();
    factor.solve(&mut x);
    system.solve(&mut y).unwrap();
    for i in 0..120 {
        assert!((x[i] - y[i]).abs() < 1e-15);
    }
}

#[test]
fn a_singular_system_is_an_error() {
    let mut example = example(60, 6, false, 20.0);
    for matrix in &mut example.matrices {
        *matrix = [[0.0; 12]; 12];
    }
    for j in 40..44 {
        example.band.hold(j..j + 1);
        example.band.columns_mut()[j][0] = 0.0;
    }
    let error = example.factor().unwrap_err();
    assert_eq!(error.unknown / NODE, 10);
}

#[test]
fn refinement_repairs_an_elimination_without_pivoting() {
    let mut band = BandedSymmetric::new(8);
    for i in 0..8 {
        band.add(i, i, if i < 4 { 1e-20 } else { 1.0 });
        if i < 4 {
            band.add(i + 4, i, 1.0);
        }
    }
    let mut system = CoupledSystem::new(8, &[], &[false; 8], &[], &[], true);
    system.assemble(&band);
    system.factor().unwrap();
    let mut x = [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0];
    system.solve(&mut x).unwrap();
    assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-15), "{x:?}");
    assert!(system.solve(&mut [f64::NAN; 8]).is_err());
}

#[test]
fn the_same_matrix_gives_the_same_bytes() {
    for symmetric in [true, false] {
        let solve = || {
            let mut example = example(271, 60, symmetric, 5.0);
            example.factor().unwrap();
            example.solve().0
        };
        let (first, second) = (solve(), solve());
        assert!(
            first
                .iter()
                .zip(&second)
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }
}
