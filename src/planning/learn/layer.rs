//! A layer of a network as one operation on the processor: y = max(x Wᵀ + b, 0), or without the
//! bound in the last layer.
//!
//! With the rows of the gradient g = ∂E/∂y, zero where y is bounded, the derivatives are
//! ∂E/∂x = g W, ∂E/∂W = gᵀ x, and ∂E/∂b the sum of the rows of g. Built from single operations, a
//! layer passes over the weights three times more often, once of these in the order of columns.

use candle_core::backend::BackendStorage;
use candle_core::{CpuStorage, CustomOp3, InplaceOp2, Layout, Result, Shape, Tensor, bail};

/// The operation of a layer.
#[derive(Clone, Copy, Debug)]
pub struct Affine {
    /// Whether negative values become zero.
    pub rectified: bool,
    /// Whether the rows are the inputs of the network, which need no derivative.
    pub first: bool,
}

impl CustomOp3 for Affine {
    fn name(&self) -> &'static str {
        "affine"
    }

    fn cpu_fwd(
        &self,
        rows: &CpuStorage,
        rows_layout: &Layout,
        weight: &CpuStorage,
        weight_layout: &Layout,
        bias: &CpuStorage,
        bias_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (count, inputs) = rows_layout.shape().dims2()?;
        let outputs = bias_layout.shape().dims1()?;
        let size = (1, count, outputs, inputs);
        let transposed = weight_layout.transpose(0, 1)?;
        let mut values = rows.matmul(weight, size, rows_layout, &transposed)?;
        let CpuStorage::F32(numbers) = &mut values else {
            bail!("a layer has numbers of 32 bits");
        };
        let bias = contiguous(bias, bias_layout)?;
        let bound = if self.rectified {
            0.0
        } else {
            f32::NEG_INFINITY
        };
        for row in numbers.chunks_exact_mut(outputs) {
            for (number, bias) in row.iter_mut().zip(bias) {
                *number = (*number + bias).max(bound);
            }
        }
        Ok((values, Shape::from((count, outputs))))
    }

    fn bwd(
        &self,
        rows: &Tensor,
        weight: &Tensor,
        _bias: &Tensor,
        values: &Tensor,
        gradient: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>, Option<Tensor>)> {
        let gradient = gradient.copy()?;
        if self.rectified {
            gradient.inplace_op2(values, &ZeroWhereBounded)?;
        }
        let of_rows = if self.first {
            None
        } else {
            Some(gradient.matmul(weight)?)
        };
        let of_weight = gradient.t()?.matmul(rows)?;
        let of_bias = gradient.sum(0)?;
        Ok((of_rows, Some(of_weight), Some(of_bias)))
    }
}

/// Sets a gradient to zero where the value is not positive.
struct ZeroWhereBounded;

impl InplaceOp2 for ZeroWhereBounded {
    fn name(&self) -> &'static str {
        "zero-where-bounded"
    }

    fn cpu_fwd(
        &self,
        gradient: &mut CpuStorage,
        gradient_layout: &Layout,
        values: &CpuStorage,
        values_layout: &Layout,
    ) -> Result<()> {
        let gradient = contiguous_mut(gradient, gradient_layout)?;
        for (slope, value) in gradient.iter_mut().zip(contiguous(values, values_layout)?) {
            *slope = if *value > 0.0 { *slope } else { 0.0 };
        }
        Ok(())
    }
}

/// The numbers of a tensor of 32 bits whose layout is that of its memory.
pub fn contiguous<'storage>(
    storage: &'storage CpuStorage,
    layout: &Layout,
) -> Result<&'storage [f32]> {
    match (storage, layout.contiguous_offsets()) {
        (CpuStorage::F32(numbers), Some((from, to))) => Ok(&numbers[from..to]),
        _ => bail!("not contiguous numbers of 32 bits"),
    }
}

/// As [`contiguous`], to be changed.
pub fn contiguous_mut<'storage>(
    storage: &'storage mut CpuStorage,
    layout: &Layout,
) -> Result<&'storage mut [f32]> {
    match (storage, layout.contiguous_offsets()) {
        (CpuStorage::F32(numbers), Some((from, to))) => Ok(&mut numbers[from..to]),
        _ => bail!("not contiguous numbers of 32 bits"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::training::random_of_phase;
    use super::*;
    use candle_core::{Device, Var};
    use rand_pcg::rand_core::Rng;

    fn numbers(rows: usize, columns: usize, seed: u64) -> Result<Var> {
        let mut random = random_of_phase(seed, 0);
        let number = || random.next_u32() as f32 / u32::MAX as f32 - 0.5;
        let numbers: Vec<f32> = std::iter::repeat_with(number)
            .take(rows * columns)
            .collect();
        Var::from_tensor(&Tensor::from_vec(numbers, (rows, columns), &Device::Cpu)?)
    }

    fn largest_difference(a: &Tensor, b: &Tensor) -> Result<f32> {
        (a - b)?.abs()?.max_all()?.to_scalar::<f32>()
    }

    #[test]
    fn a_layer_and_its_derivatives_are_those_of_single_operations() -> Result<()> {
        for rectified in [true, false] {
            let [rows, weight] = [numbers(7, 5, 1)?, numbers(4, 5, 2)?];
            let bias = Var::from_tensor(&numbers(1, 4, 3)?.squeeze(0)?)?;
            let operation = Affine {
                rectified,
                first: false,
            };
            let values = rows.apply_op3(&weight, &bias, operation)?;
            let plain = rows.matmul(&weight.t()?)?.broadcast_add(&bias)?;
            let plain = if rectified { plain.relu()? } else { plain };
            assert!(largest_difference(&values, &plain)? < 1e-6);
            let slopes = [values, plain].map(|values| values.sqr()?.sum_all()?.backward());
            let [Ok(slopes), Ok(expected)] = slopes else {
                panic!("no derivatives");
            };
            for variable in [&rows, &weight, &bias] {
                let of = |slopes: &candle_core::backprop::GradStore| {
                    slopes.get(variable).cloned().expect("a derivative")
                };
                assert!(largest_difference(&of(&slopes), &of(&expected))? < 1e-5);
            }
        }
        Ok(())
    }
}
