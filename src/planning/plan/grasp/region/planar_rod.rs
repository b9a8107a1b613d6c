//! A suspended rod in the plane. The contact node of the rod is clamped level on the table; the
//! other end is held at a position and turns freely.
//!
//! EI = L_gb = 1, so that the weight per length is 1/2. With the angle θ(s) of the tangent above the table and the force
//! n(s) = (H, V + s/2) that the material beyond s exerts,
//!
//! > θ'' = λ (H sin θ − (V + s/2) cos θ),  λ = 1 + (H cos θ + (V + s/2) sin θ)/k̄_s,  (x, z)' = λ (cos θ, sin θ),
//! > θ(0) = 0,  θ'(l̄_s) = 0,  (x, z)(l̄_s) given.
//!
//! Newton's method on the values of θ at Chebyshev points, with H and V.

use super::super::stability::Element;
use super::super::{GraspProblem, Vector3, WEIGHT};
use super::chebyshev::Chebyshev;
use nalgebra::{DMatrix, DVector};
use std::sync::LazyLock;

/// Degree of the polynomial θ(s).
const DEGREE: usize = 72;
/// Maximum number of Newton iterations.
const ITERATIONS: usize = 60;
/// Largest rotation of a tangent in one iteration.
const LARGEST_TURN: f64 = 0.5;
/// Change for which the next one is below the rounding errors of second derivatives, 1e-9.
const CONVERGED: f64 = 1e-7;
/// Tension of the initial guess of a stretched rod.
const PULL: f64 = 6.0;
/// Number of elements of the second variation between two Chebyshev points.
const ELEMENTS_BETWEEN: usize = 4;

static RULE: LazyLock<Chebyshev> = LazyLock::new(|| Chebyshev::new(DEGREE));

/// A suspended rod in the plane, in equilibrium.
#[derive(Clone, Debug)]
pub struct PlanarRod {
    length: f64,
    compliance: f64,
    /// θ at the Chebyshev points.
    angles: DVector<f64>,
    /// H and V.
    force: [f64; 2],
}

impl PlanarRod {
    /// A nearly straight rod from the contact node to the gripper, if there is one. The curvature
    /// in the problem is ignored, since the clamp provides the moment.
    pub fn stretched(problem: &GraspProblem, gripper: [f64; 2]) -> Option<Self> {
        let length = problem.suspended_length;
        let direction = libm::atan2(gripper[1], gripper[0]);
        let rate = PULL.sqrt() * length;
        let (sine, cosine) = libm::sincos(direction);
        let start = Self {
            length,
            compliance: problem.stretch_compliance,
            angles: RULE
                .points
                .map(|x| direction * (1.0 - libm::exp(-rate * x))),
            force: [PULL * cosine, PULL * sine - 0.5 * WEIGHT * length],
        };
        start.moved(gripper)
    }

    /// The rod near this one for another gripper position; `None` if Newton's method does not find
    /// it.
    pub fn moved(&self, gripper: [f64; 2]) -> Option<Self> {
        self.converged(&End::Place(gripper))
    }

    /// The rod near this one for another force of the table, without a moment at the contact node.
    pub fn without_contact_moment(&self, contact_force: f64) -> Option<Self> {
        self.converged(&End::Free {
            vertical: -contact_force,
        })
    }

    fn converged(&self, end: &End) -> Option<Self> {
        let mut rod = self.clone();
        for _ in 0..ITERATIONS {
            if rod.iterate(end)? < CONVERGED {
                return Some(rod);
            }
        }
        None
    }

    /// Largest rotation of a tangent relative to another rod, rad.
    pub fn largest_turn_from(&self, other: &Self) -> f64 {
        (&self.angles - &other.angles).amax()
    }

    /// H and V.
    pub fn force(&self) -> [f64; 2] {
        self.force
    }

    /// θ'(0), the moment that the lying part must carry.
    pub fn contact_moment(&self) -> f64 {
        (RULE.derivative.row(0) * &self.angles)[0] / self.length
    }

    /// θ(l̄_s).
    pub fn gripper_angle(&self) -> f64 {
        self.angles[DEGREE]
    }

    /// Lowest height above the table away from the contact node, at a local minimum or at the
    /// gripper.
    pub fn lowest(&self) -> f64 {
        let heights = self.heights();
        let rises = |at: usize| libm::sin(self.angles[at]) > 0.0;
        let bottoms = (1..DEGREE).filter(|&at| {
            let is_lowest = heights[at] <= heights[at - 1] && heights[at] <= heights[at + 1];
            is_lowest && !rises(at - 1) && rises(at + 1)
        });
        let bottoms = bottoms.map(|at| {
            let (mut falling, mut rising) = (RULE.points[at - 1], RULE.points[at + 1]);
            for _ in 0..50 {
                let middle = 0.5 * (falling + rising);
                if libm::sin(RULE.interpolated(&self.angles, middle)) > 0.0 {
                    rising = middle;
                } else {
                    falling = middle;
                }
            }
            RULE.interpolated(&heights, rising)
        });
        bottoms.fold(heights[DEGREE], f64::min)
    }

    /// x and z of the gripper.
    pub fn gripper(&self) -> [f64; 2] {
        [libm::cos, libm::sin].map(|part| self.sums(part)[DEGREE])
    }

    /// Positions (x, z) at equal arc lengths, from the contact node to the gripper.
    pub fn places(&self, edges: usize) -> Vec<[f64; 2]> {
        let sums = [libm::cos, libm::sin].map(|part| self.sums(part));
        let place = |edge: usize| {
            let x = edge as f64 / edges as f64;
            [0, 1].map(|axis| RULE.interpolated(&sums[axis], x))
        };
        (0..=edges).map(place).collect()
    }

    /// Elements of its second variation.
    pub fn elements(&self) -> Vec<Element> {
        let slopes = &RULE.derivative * &self.angles / self.length;
        let between = RULE.points.as_slice().windows(2).flat_map(|ends| {
            let width = (ends[1] - ends[0]) / ELEMENTS_BETWEEN as f64;
            let start = ends[0];
            (0..ELEMENTS_BETWEEN).map(move |part| (start + (part as f64 + 0.5) * width, width))
        });
        let element = |(x, width): (f64, f64)| {
            let (sine, cosine) = libm::sincos(RULE.interpolated(&self.angles, x));
            let [h, v] = self.force;
            Element {
                length: width * self.length,
                tangent: Vector3::new(cosine, 0.0, sine),
                moment: -RULE.interpolated(&slopes, x) * Vector3::y(),
                force: Vector3::new(h, 0.0, v + WEIGHT * self.length * x),
            }
        };
        between.map(element).collect()
    }

    fn heights(&self) -> DVector<f64> {
        self.sums(libm::sin)
    }

    /// x or z at the Chebyshev points.
    fn sums(&self, part: fn(f64) -> f64) -> DVector<f64> {
        let slopes = DVector::from_fn(DEGREE + 1, |index, _| {
            let Load { along, .. } = self.load(index);
            (1.0 + self.compliance * along) * part(self.angles[index])
        });
        &RULE.integral * slopes * self.length
    }

    fn load(&self, index: usize) -> Load {
        let [h, v] = self.force;
        let v = v + WEIGHT * self.length * RULE.points[index];
        let (sine, cosine) = libm::sincos(self.angles[index]);
        Load {
            sine,
            cosine,
            across: h * sine - v * cosine,
            along: h * cosine + v * sine,
        }
    }

    /// Performs one Newton iteration; returns the largest change of an angle or force.
    fn iterate(&mut self, end: &End) -> Option<f64> {
        let count = DEGREE + 1;
        let (length, compliance) = (self.length, self.compliance);
        let square = length * length;
        let mut matrix = DMatrix::zeros(count + 2, count + 2);
        let mut right = DVector::zeros(count + 2);
        let [x, z] = [count, count + 1];
        matrix
            .view_mut((0, 0), (count, count))
            .copy_from(&RULE.second_derivative);
        let bend = &RULE.second_derivative * &self.angles;
        for at in 0..count {
            let Load {
                sine,
                cosine,
                across,
                along,
            } = self.load(at);
            // The derivatives with respect to θ are across' = along and along' = −across.
            let stretch = 1.0 + compliance * along;
            right[at] = square * stretch * across - bend[at];
            matrix[(at, at)] -= square * (stretch * along - compliance * across * across);
            matrix[(at, x)] = -square * (stretch * sine + compliance * cosine * across);
            matrix[(at, z)] = -square * (compliance * sine * across - stretch * cosine);
            let weight = length * RULE.weights[at];
            matrix[(x, at)] = -weight * (compliance * across * cosine + stretch * sine);
            matrix[(z, at)] = weight * (stretch * cosine - compliance * across * sine);
            let soft = weight * compliance;
            matrix[(x, x)] += soft * cosine * cosine;
            matrix[(x, z)] += soft * cosine * sine;
            matrix[(z, x)] += soft * cosine * sine;
            matrix[(z, z)] += soft * sine * sine;
            right[x] -= weight * stretch * cosine;
            right[z] -= weight * stretch * sine;
        }
        match end {
            End::Place(gripper) => {
                right[x] += gripper[0];
                right[z] += gripper[1];
            }
            End::Free { vertical } => {
                let slope = RULE.derivative.row(0);
                matrix.rows_mut(x, 2).fill(0.0);
                matrix.view_mut((x, 0), (1, count)).copy_from(&slope);
                right[x] = -(slope * &self.angles)[0];
                matrix[(z, z)] = 1.0;
                right[z] = vertical - self.force[1];
            }
        }
        // At the two ends the conditions θ(0) = 0 and θ'(l̄_s) = 0 replace the equation.
        matrix.row_mut(0).fill(0.0);
        matrix[(0, 0)] = 1.0;
        right[0] = -self.angles[0];
        let slope = RULE.derivative.row(DEGREE);
        matrix.row_mut(DEGREE).fill(0.0);
        matrix.view_mut((DEGREE, 0), (1, count)).copy_from(&slope);
        right[DEGREE] = -(slope * &self.angles)[0];

        let change = matrix.lu().solve(&right)?;
        let largest = change.amax();
        if !largest.is_finite() {
            return None;
        }
        let turn = change.rows(0, count).amax();
        let factor = (LARGEST_TURN / turn.max(1e-300)).min(1.0);
        self.angles += factor * change.rows(0, count);
        self.force[0] += factor * change[x];
        self.force[1] += factor * change[z];
        Some(largest)
    }
}

/// Additional conditions on a rod.
enum End {
    /// x and z of the gripper.
    Place([f64; 2]),
    /// θ'(0) = 0 and V.
    Free { vertical: f64 },
}

/// The components of the force in the rod, across it and along it, and its direction.
struct Load {
    sine: f64,
    cosine: f64,
    across: f64,
    along: f64,
}
