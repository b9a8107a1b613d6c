//! Knots: shapes from parameters, invariants, measures of a tied rod, and theory.
//!
//! | file | what |
//! |---|---|
//! | `overhand` | centrelines of open overhand knots of any unknotting number |
//! | `determinant` | the knot determinant of an open curve, its ends closed far away |
//! | `silhouette` | height and width of the loop |
//! | `inversion` | where a knot inverts while it is pulled tight |
//! | `circle` | the circle that fits points in space best |
//! | `loop_elastica` | the planar elastica that leaves and enters a braid tangentially |
//! | `traction` | traction laws of Audoly et al. 2007 and Jawed et al. 2015 |
//! | `helical_braid` | bending energy of a braid of two helical strands |
//! | `simplified_knot` | braid and loop together: where the loop must turn over |
//! | `elliptic` | complete elliptic integrals |

mod circle;
mod determinant;
mod elliptic;
mod helical_braid;
mod inversion;
mod loop_elastica;
mod overhand;
mod silhouette;
mod simplified_knot;
mod traction;

pub use circle::{FittedCircle, fit_circle};
pub use determinant::determinant;
pub use helical_braid::HelicalBraid;
pub use inversion::{InversionPoint, LoopWatch, TightenedKnot, inversion_point};
pub use loop_elastica::LoopElastica;
pub use overhand::{Overhand, overhand_nodes};
pub use silhouette::{Silhouette, silhouette};
pub use simplified_knot::{Equilibrium, Fold, RotatedKnot, SimplifiedKnot};
pub use traction::{
    TREFOIL_FRICTION, audoly_traction, braid_and_loop, jawed_shortening, jawed_traction,
    relaxed_loop,
};
