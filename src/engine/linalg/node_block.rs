//! Dense 4×4 blocks, one per coupled pair of nodes, and the few operations of a node-by-node
//! elimination. Columns are contiguous, so that four rows run in the lanes of a register.

/// Unknowns per node.
pub(super) const NODE: usize = 4;

/// A 4×4 block, column by column: entry (r, c) is `0[4 c + r]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Block(pub(super) [f64; NODE * NODE]);

/// A matrix as the blocks of nodes and of pairs of nodes.
pub(super) struct BlockMatrix<'a> {
    /// Diagonal blocks, node by node.
    pub(super) diagonal: &'a [Block],
    /// Blocks of the node graph's pairs below the diagonal.
    pub(super) lower: &'a [Block],
    /// Blocks right of the diagonal, transposed; not read if the matrix is symmetric.
    pub(super) upper: &'a [Block],
}

/// The unknowns of one node.
pub(super) type NodeVector = [f64; NODE];

impl Block {
    pub(super) const ZERO: Self = Self([0.0; NODE * NODE]);

    #[inline(always)]
    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        self.0[NODE * column + row]
    }

    #[inline(always)]
    pub(super) fn transposed(&self) -> Self {
        let mut result = Self::ZERO;
        for c in 0..NODE {
            for r in 0..NODE {
                result.0[NODE * c + r] = self.0[NODE * r + c];
            }
        }
        result
    }

    /// Copies the entries below the diagonal to those above it.
    #[inline(always)]
    pub(super) fn mirror_lower_triangle(&mut self) {
        for c in 0..NODE {
            for r in c + 1..NODE {
                self.0[NODE * r + c] = self.0[NODE * c + r];
            }
        }
    }

    /// `self` −= X.
    #[inline(always)]
    pub(super) fn subtract(&mut self, x: &Self) {
        for (own, x) in self.0.iter_mut().zip(&x.0) {
            *own -= x;
        }
    }

    /// `target` −= B v.
    #[inline(always)]
    pub(super) fn subtract_from(&self, v: &NodeVector, target: &mut NodeVector) {
        for k in 0..NODE {
            for r in 0..NODE {
                target[r] -= self.0[NODE * k + r] * v[k];
            }
        }
    }

    /// `target` −= Bᵀ v.
    #[inline(always)]
    pub(super) fn subtract_transposed_from(&self, v: &NodeVector, target: &mut NodeVector) {
        for c in 0..NODE {
            let mut sum = self.0[NODE * c] * v[0];
            for r in 1..NODE {
                sum += self.0[NODE * c + r] * v[r];
            }
            target[c] -= sum;
        }
    }

    /// `target` += |B| |v|.
    #[inline(always)]
    pub(super) fn add_magnitudes_to(&self, v: &NodeVector, target: &mut NodeVector) {
        for k in 0..NODE {
            for r in 0..NODE {
                target[r] += (self.0[NODE * k + r] * v[k]).abs();
            }
        }
    }

    /// `target` += |Bᵀ| |v|.
    #[inline(always)]
    pub(super) fn add_transposed_magnitudes_to(&self, v: &NodeVector, target: &mut NodeVector) {
        for c in 0..NODE {
            for r in 0..NODE {
                target[c] += (self.0[NODE * c + r] * v[r]).abs();
            }
        }
    }
}

/// Σⱼ Xⱼ Yⱼᵀ for several rows X of blocks and one row Y. An elimination spends most of its time
/// here, so the sums stay in registers.
#[inline(always)]
pub(super) fn product<const ROWS: usize>(x: [&[Block]; ROWS], y: &[Block]) -> [Block; ROWS] {
    let x = x.map(|x| &x[..y.len()]);
    let mut sums = [[[0.0; NODE]; NODE]; ROWS];
    for (j, y) in y.iter().enumerate() {
        for k in 0..NODE {
            for c in 0..NODE {
                let factor = y.0[NODE * k + c];
                for (sum, x) in sums.iter_mut().zip(&x) {
                    for r in 0..NODE {
                        sum[c][r] = x[j].0[NODE * k + r].mul_add(factor, sum[c][r]);
                    }
                }
            }
        }
    }
    sums.map(|columns| Block(std::array::from_fn(|i| columns[i / NODE][i % NODE])))
}

/// The factors P D = L U of a diagonal block, rows exchanged within the block.
#[derive(Clone, Copy, Debug)]
pub(super) struct DiagonalFactor {
    /// L below the diagonal, U above it, 1/U on it.
    factors: Block,
    /// Row k of P D is row `rows[k]` of D.
    rows: [usize; NODE],
}

impl DiagonalFactor {
    pub(super) const EMPTY: Self = Self {
        factors: Block::ZERO,
        rows: [0; NODE],
    };

    /// Factors a block by Gaussian elimination with partial pivoting. The error holds the row in
    /// which no pivot was found, and the pivot.
    #[inline(always)]
    pub(super) fn new(block: &Block) -> Result<Self, (usize, f64)> {
        let mut factor = Self {
            factors: *block,
            rows: [0, 1, 2, 3],
        };
        factor.eliminate::<0>()?;
        factor.eliminate::<1>()?;
        factor.eliminate::<2>()?;
        factor.eliminate::<3>()?;
        Ok(factor)
    }

    /// Eliminates column `K`. It is a constant so that the compiler unrolls all loops.
    #[inline(always)]
    fn eliminate<const K: usize>(&mut self) -> Result<(), (usize, f64)> {
        let Self { factors: a, rows } = self;
        let mut best = K;
        for r in K + 1..NODE {
            if a.get(r, K).abs() > a.get(best, K).abs() {
                best = r;
            }
        }
        let pivot = a.get(best, K);
        if !(pivot.abs() > 0.0 && pivot.abs() < f64::INFINITY) {
            return Err((rows[best], pivot));
        }
        if best != K {
            rows.swap(K, best);
            for c in 0..NODE {
                a.0.swap(NODE * c + K, NODE * c + best);
            }
        }
        let inverse = 1.0 / pivot;
        a.0[NODE * K + K] = inverse;
        for r in K + 1..NODE {
            a.0[NODE * K + r] *= inverse;
        }
        for c in K + 1..NODE {
            let factor = a.get(K, c);
            for r in K + 1..NODE {
                a.0[NODE * c + r] -= a.0[NODE * K + r] * factor;
            }
        }
        Ok(())
    }

    /// D⁻¹ v.
    #[inline(always)]
    pub(super) fn solve(&self, v: &NodeVector) -> NodeVector {
        let f = &self.factors;
        let mut x = [0.0; NODE];
        for k in 0..NODE {
            x[k] = v[self.rows[k]];
        }
        for k in 0..NODE {
            for r in k + 1..NODE {
                x[r] -= f.get(r, k) * x[k];
            }
        }
        for k in (0..NODE).rev() {
            x[k] *= f.get(k, k);
            for r in 0..k {
                x[r] -= f.get(r, k) * x[k];
            }
        }
        x
    }

    /// A D⁻¹ = A U⁻¹ L⁻¹ P, column by column.
    #[inline(always)]
    pub(super) fn divide(&self, a: &Block) -> Block {
        let f = &self.factors;
        let mut x = *a;
        for c in 0..NODE {
            for k in 0..c {
                let factor = f.get(k, c);
                for r in 0..NODE {
                    x.0[NODE * c + r] -= x.0[NODE * k + r] * factor;
                }
            }
            let inverse = f.get(c, c);
            for r in 0..NODE {
                x.0[NODE * c + r] *= inverse;
            }
        }
        for c in (0..NODE).rev() {
            for k in c + 1..NODE {
                let factor = f.get(k, c);
                for r in 0..NODE {
                    x.0[NODE * c + r] -= x.0[NODE * k + r] * factor;
                }
            }
        }
        let mut result = Block::ZERO;
        for k in 0..NODE {
            let column = NODE * self.rows[k];
            for r in 0..NODE {
                result.0[column + r] = x.0[NODE * k + r];
            }
        }
        result
    }
}

/// The pivots of the LDLᵀ factorisation of a symmetric block without row exchanges.
#[inline(always)]
pub(super) fn symmetric_pivots(block: &Block) -> NodeVector {
    let mut a = *block;
    let mut pivots = [0.0; NODE];
    for k in 0..NODE {
        pivots[k] = a.get(k, k);
        let inverse = 1.0 / pivots[k];
        for c in k + 1..NODE {
            let factor = a.get(c, k) * inverse;
            for r in c..NODE {
                a.0[NODE * c + r] -= a.get(r, k) * factor;
            }
        }
    }
    pivots
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;

    fn dense(block: &Block) -> Matrix4<f64> {
        Matrix4::from_column_slice(&block.0)
    }

    fn blocks() -> impl Strategy<Value = Block> {
        prop::array::uniform16(-1.0..1.0f64).prop_map(Block)
    }

    proptest! {
        #[test]
        fn operations_agree_with_dense_matrices(x in blocks(), y in blocks(), c in blocks(), v in prop::array::uniform4(-1.0..1.0f64)) {
            let mut product = c;
            let [xy] = super::product([&[x]], &[y]);
            product.subtract(&xy);
            prop_assert!((dense(&product) - (dense(&c) - dense(&x) * dense(&y).transpose())).amax() < 1e-14);
            let mut target = [1.0; 4];
            x.subtract_from(&v, &mut target);
            x.subtract_transposed_from(&v, &mut target);
            let expected = Vector4::repeat(1.0) - (dense(&x) + dense(&x).transpose()) * Vector4::from(v);
            prop_assert!((Vector4::from(target) - expected).amax() < 1e-14);
        }

        #[test]
        fn a_diagonal_factor_divides(d in blocks(), a in blocks(), v in prop::array::uniform4(-1.0..1.0f64)) {
            let matrix = dense(&d);
            prop_assume!(matrix.determinant().abs() > 1e-3);
            let factor = DiagonalFactor::new(&d).unwrap();
            prop_assert!((matrix * Vector4::from(factor.solve(&v)) - Vector4::from(v)).amax() < 1e-11);
            prop_assert!((dense(&factor.divide(&a)) * matrix - dense(&a)).amax() < 1e-11);
        }
    }
}
