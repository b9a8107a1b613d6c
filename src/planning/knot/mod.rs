//! Knots: shapes from parameters, invariants, measures of a tied rod, and theory.
//!
//! | file | what |
//! |---|---|
//! | `overhand` | centrelines of open overhand knots of any unknotting number |
//! | `figure_eight` | the open figure-eight knot |
//! | `two_throws` | reef, granny and surgeon's knot of two rods |
//! | `fisherman` | the fisherman's knot of two rods |
//! | `size`, `polyline` | the size of a knot that fits the rod; length and equal steps of curves |
//! | `determinant`, `signature` | the knot determinant; the signature, which distinguishes a knot from its mirror image |
//! | `invariants` | both |
//! | `projection`, `closure` | crossings of closed curves; ends of open ones, joined far away |
//! | `silhouette` | height and width of the loop |
//! | `inversion` | inversion of a knot while it is pulled tight |
//! | `circle` | the best-fit circle of points in space |
//! | `loop_elastica` | the planar elastica that leaves and enters a braid tangentially |
//! | `traction` | traction laws of Audoly et al. 2007 and Jawed et al. 2015 |
//! | `helical_braid` | bending energy of a braid of two helical strands |
//! | `simplified_knot` | braid and loop together, and their inversion |
//! | `elliptic` | complete elliptic integrals |

mod circle;
mod closure;
mod determinant;
mod elliptic;
mod figure_eight;
mod fisherman;
mod helical_braid;
mod invariants;
mod inversion;
mod loop_elastica;
mod overhand;
mod polyline;
mod projection;
mod signature;
mod silhouette;
mod simplified_knot;
mod size;
mod traction;
mod two_throws;

pub use circle::{FittedCircle, fit_circle};
pub use closure::closed_far_away;
pub use determinant::{determinant, determinant_of_closed, determinant_of_pair, fewest_crossings};
pub use figure_eight::{FIGURE_EIGHT_DETERMINANT, figure_eight_nodes};
pub use fisherman::{FISHERMAN_DETERMINANT, fisherman_nodes};
pub use helical_braid::HelicalBraid;
pub use invariants::KnotInvariants;
pub use inversion::{InversionPoint, InversionWatch, TightenedKnot};
pub use loop_elastica::LoopElastica;
pub use overhand::{Overhand, overhand_nodes};
pub use signature::signature_of_closed;
pub use silhouette::{Silhouette, silhouette};
pub use simplified_knot::{Equilibrium, Fold, RotatedKnot, SimplifiedKnot};
pub use size::KnotSize;
pub use traction::{
    TREFOIL_FRICTION, audoly_traction, braid_and_loop, jawed_shortening, jawed_traction,
    relaxed_loop,
};
pub use two_throws::TwoThrows;

/// Smallest distance between nodes of rods. Nodes of the same rod closer than `apart` (m) along it
/// are excluded.
#[cfg(test)]
fn least_distance(rods: &[&[rodlab_engine::mechanics::Vector3]], apart: f64) -> f64 {
    let mut least = f64::INFINITY;
    for (index, rod) in rods.iter().enumerate() {
        let step = (rod[1] - rod[0]).norm();
        for (i, node) in rod.iter().enumerate() {
            let later = &rod[rod.len().min(i + 1 + (apart / step) as usize)..];
            let others = later
                .iter()
                .chain(rods[index + 1..].iter().copied().flatten());
            for other in others {
                least = least.min((node - other).norm());
            }
        }
    }
    least
}
