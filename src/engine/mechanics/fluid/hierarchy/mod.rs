//! The product with the flow operator at a cost that grows like N log N: a fast multipole method.
//!
//! # The kernel as harmonic potentials
//! With r = x − y and up to terms of ε⁴/r⁴, the regularized Stokeslet is (Tornberg and Greengard 2008 for
//! ε = 0)
//!
//! 8πη u(x) = 2 B − ∇(x·B + B₀),  B = f/r,  B₀ = −f·y/r + (ε²/2) f·∇(1/r),
//!
//! four harmonic functions. They are expanded in solid harmonics about the centres of clusters,
//! with y and x relative to the centres so that nothing cancels. The force density of a node
//! enters with its hat function over its segments, by two Gauss points each.
//!
//! | file | idea |
//! |---|---|
//! | `tree`, `interactions` | clusters of nodes, and which act on which through expansions |
//! | `harmonics` | solid harmonics, regular and irregular |
//! | `sources` | force densities → multipole expansion of a leaf |
//! | `translation` | multipole expansion → that of a parent → local expansion → that of a child |
//! | `evaluation` | local expansion of a leaf → flow at its nodes |
//! | `operator` | all of it, with the exact blocks between leaves that are near |

mod evaluation;
mod harmonics;
mod interactions;
mod operator;
mod sources;
#[cfg(test)]
mod tests;
mod translation;
mod tree;

pub(super) use operator::HierarchicalOperator;
