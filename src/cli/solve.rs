//! `rodlab solve`: exact solutions as JSON.

use super::prelude::*;
use super::solve_arm::{ForwardArguments, InverseArguments};
use super::solve_fold::FoldArguments;
use super::solve_grasp::GraspArguments;
use super::solve_knot::KnotInversionArguments;
use rodlab_engine::mechanics::kirchhoff::{HangingStrip, HeavyLoop, Helix, critical_distance};
use rodlab_lab::experiment::{HelixStability, estimated_critical_distance};

/// Largest number of edges of a discrete rod. Beyond it, round-off exceeds the error of the mesh.
const MOST_EDGES: usize = 2000;

const POSTURES: [&str; 2] = help!(
    "\
Examples:
  rodlab solve ik --cell two_sawyers --arm right --pose=0.5,0.2,0.2,0,1,0,0
  rodlab solve ik --cell six_joints --pose=0.4,0.1,0.2,0,1,0,0 --all",
    "\
The pose x, y, z, qw, qx, qy, qz is that of the hand in the frame of the base of the arm. Without
--all the answer is one posture, near `home` if a path leads from there. With --all it is every
posture of an arm of up to six joints, and samples of the curves of postures of an arm with more.
Exit code 3: no posture within the limits reaches the pose; the message gives the nearest pose that
can be reached."
);

const FOLD: [&str; 2] = help!(
    "\
Examples:
  rodlab solve fold --x 3.4 --z 1.7
  rodlab solve fold --x 3.4 --z 1.7 --method der --edges 200
  rodlab solve fold --x 1.386061835 --z 1.173187179 --all",
    "\
A sheet lies flat on a table; a gripper holds its edge without a moment (thesis sec. 4.3). --x and
--z give its position: x̄ from where the edge lay, towards the sheet, and z̄ above the table, both
over L_gb = (E h²/(24 ρ g))^(1/3). `alpha` is the angle in rad by which the edge is turned;
`suspended_length` is in L_gb. At the touchdown point the suspended part exerts `horizontal_force` H
and `vertical_force` V on the lying part, in EI/L_gb² per width. H below 0 pushes the lying part
away, V below 0 presses it down; `lambda` is |H|/|V| (Eq. 4.6). `stable` means stable with the
gripper in its place, free to turn. Without --all the answer is the gentle fold, which belongs to
the family that begins with the flat sheet."
);

const GRASP: [&str; 2] = help!(
    "\
Examples:
  rodlab solve grasp --suspended-length 10 --curvature 0.5
  rodlab solve grasp --suspended-length 10 --curvature 0.5 --stretch 2087 --method der --edges 200
  rodlab solve grasp --suspended-length 17.68 --curvature 0 --all",
    "\
Lengths are in gravito-bending lengths L_gb, forces in EI/L_gb². The frame: the contact node is the
origin, its tangent x, z points up, and positive curvature turns to y. `position` is that of the
gripper; `rotation_vector` and `quaternion` (w, x, y, z) turn the frame of the contact node into
that of the gripper, without twist; `contact_force` is the force of the lying part on the suspended
part. `stable` means stable with both ends held. `branch` 1 is the gentle grasp, the local minimum 1
of thesis Fig. 5.4. `feasible` means that the rod stays above the table and presses on it."
);

/// Arguments of `rodlab solve`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab solve helix --direction=1,1,-1
  rodlab solve helix --direction=1,1,-1 --method der --edges 100
  rodlab solve knot-inversion --unknotting-number 3 --radius \"1.6 mm\"
  rodlab solve loop-height --gravito-bending-length \"3 cm\"
  rodlab solve hanging-plate --length 0.2 --gravito-bending-length 0.1
  rodlab solve grasp --suspended-length 10 --curvature 0.5 --stretch 2087
  rodlab solve fold --x 3.4 --z 1.7
  rodlab solve ik --cell scenarios/cells/six_joints.toml --pose=0.4,0.1,0.2,0,1,0,0 --all

The gravito-bending length L_gb of a rod of radius h is (E h²/(8 ρ g))^(1/3); that of a strip of
thickness h is (E h²/(24 ρ g))^(1/3): bending stiffness / weight per length = 2 L_gb³.")]
pub struct SolveArguments {
    /// Problem to solve
    #[command(subcommand)]
    problem: Problem,
}

#[derive(Debug, Subcommand)]
enum Problem {
    /// The first loss of stability of a helical rod with clamped ends
    #[command(after_help = "\
A rod of length 1 and bending stiffness 1, naturally straight, is held at both ends in the shape of
a helix of curvature κ and torsion τ with the twisting moment ω. `critical` is the norm of (κ, τ, ω)
along the direction at which it ceases to be stable (Borum & Bretl 2020): null if it is stable up to
100. With --method der, `critical` is that of the discrete rod. It is null if the rod is still
stable at a norm of half its number of edges.")]
    Helix(HelixArguments),
    /// The size at which a tightened overhand knot inverts, by the model of a braid and a loop
    #[command(after_help = "\
A braid of two helices and the loop between its ends (thesis 3.6), without friction.
`length_normalized` is l̄_k = (L − l_c)/h, the length of braid and loop over the radius of the rod,
at which the knot loses its equilibrium. `rotation_rad` is the angle by which each end of the braid
has turned back there. The defaults are φ = π/3 and ε = 0.7, as in the thesis.")]
    KnotInversion(KnotInversionArguments),
    /// The height of the loop of a heavy rod folded over onto itself on a table
    LoopHeight {
        /// Gravito-bending length, in metres or with a unit
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        gravito_bending_length: f64,
    },
    /// Drop of the free end of a strip whose other end is held horizontally
    HangingPlate {
        /// Length beyond the holder, in metres or with a unit
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        length: f64,
        /// Gravito-bending length, in metres or with a unit
        #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
        gravito_bending_length: f64,
    },
    /// Pose at which a gripper must hold a rod that it lays on a table
    #[command(after_help = GRASP[0], after_long_help = GRASP[1])]
    Grasp(GraspArguments),
    /// Shape and forces of a sheet that is folded by its edge
    #[command(after_help = FOLD[0], after_long_help = FOLD[1])]
    Fold(FoldArguments),
    /// Pose of the hand of an arm for given joint positions
    #[command(after_help = "\
Example:
  rodlab solve fk --cell two_sawyers --arm right --joints=0,-1.18,0,2.18,0,0.57,3.3161

`position`, m, and `quaternion` (w, x, y, z) are those of the hand in the frame of the arm's base.")]
    Fk(ForwardArguments),
    /// Joint positions that bring the hand of an arm to a pose
    #[command(after_help = POSTURES[0], after_long_help = POSTURES[1])]
    Ik(InverseArguments),
}

#[derive(Debug, Args)]
struct HelixArguments {
    /// Direction; its length does not matter
    #[arg(long, value_name = "κ,τ,ω", value_parser = direction, allow_hyphen_values = true)]
    direction: Helix,
    /// Method of solution
    #[arg(long, default_value = "theory")]
    method: HelixMethod,
    /// Edges of the discrete rod; a second solution with twice as many gives the error estimate
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = edges(HelixStability::FEWEST_EDGES..=MOST_EDGES))]
    edges: usize,
}

/// Methods for the critical distance of a helix.
#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum HelixMethod {
    /// Conjugate points of the continuous rod.
    Theory,
    /// Signs of the pivots of the discrete elastic rod.
    Der,
}

#[derive(Serialize)]
struct HelixAnswer {
    critical: Option<f64>,
    kappa: f64,
    tau: f64,
    omega: f64,
    method: HelixMethod,
    error_estimate: Option<f64>,
}

#[derive(Serialize)]
struct LoopAnswer {
    height_m: f64,
    free_length_m: f64,
    gravito_bending_length_m: f64,
}

#[derive(Serialize)]
struct StripAnswer {
    drop_m: f64,
    reach_m: f64,
    length_m: f64,
    gravito_bending_length_m: f64,
}

/// Solves a problem and prints the answer.
pub fn solve(arguments: &SolveArguments) -> Result<(), Failure> {
    match &arguments.problem {
        Problem::Helix(arguments) => print_json(&helix(arguments)?),
        Problem::KnotInversion(arguments) => print_json(&arguments.solve()?),
        Problem::Grasp(arguments) => print_json(&arguments.solve()?),
        Problem::Fold(arguments) => print_json(&arguments.solve()?),
        Problem::Fk(arguments) => print_json(&arguments.solve()?),
        Problem::Ik(arguments) => print_json(&arguments.solve()?),
        Problem::LoopHeight {
            gravito_bending_length,
        } => {
            let heavy_loop = HeavyLoop::new();
            print_json(&LoopAnswer {
                height_m: heavy_loop.height * gravito_bending_length,
                free_length_m: heavy_loop.length * gravito_bending_length,
                gravito_bending_length_m: *gravito_bending_length,
            })
        }
        Problem::HangingPlate {
            length,
            gravito_bending_length,
        } => {
            let strip = HangingStrip::of_length(length / gravito_bending_length).or_input()?;
            print_json(&StripAnswer {
                drop_m: strip.drop * length,
                reach_m: strip.reach * length,
                length_m: *length,
                gravito_bending_length_m: *gravito_bending_length,
            })
        }
    }
}

/// Solves with the direction as a unit vector; the boundary is at `critical` times this vector (κ,
/// τ, ω).
fn helix(arguments: &HelixArguments) -> Result<HelixAnswer, Failure> {
    let HelixArguments {
        direction,
        method,
        edges,
    } = arguments;
    let unit = direction.scaled(1.0 / direction.distance());
    let critical = match method {
        HelixMethod::Theory => critical_distance(&unit),
        HelixMethod::Der => estimated_critical_distance(&unit, *edges)
            .map_err(|error| Failure::Unreachable(error.to_string()))?,
    };
    Ok(HelixAnswer {
        critical: critical.map(|critical| critical.distance),
        kappa: unit.curvature,
        tau: unit.torsion,
        omega: unit.twisting_moment,
        method: *method,
        error_estimate: critical.map(|critical| critical.error_estimate),
    })
}

fn direction(text: &str) -> Result<Helix, String> {
    let Some(&[curvature, torsion, twisting_moment]) = numbers(text).as_deref() else {
        return Err("expected three numbers with commas between them, as in 1,1,-1".into());
    };
    let helix = Helix {
        curvature,
        torsion,
        twisting_moment,
    };
    if !helix.distance().is_finite() || helix.distance() == 0.0 {
        return Err("the direction must be finite and not zero".into());
    }
    if helix.curvature < 0.0 {
        return Err(
            "the curvature κ must not be negative: turn the rod about its axis instead".into(),
        );
    }
    Ok(helix)
}
