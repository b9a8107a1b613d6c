//! A loop of rod held at its two ends only, such as the loop that hangs on the braid of a knot.

use super::numerics::{bisect, runge_kutta};
use crate::mechanics::Vector3;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;

/// Number of integration steps over half of the loop; doubling it changes the energy by less than
/// 1e-7.
const STEPS: usize = 100;
const MOST_ITERATIONS: usize = 40;
/// Largest residual of an accepted solution, relative to the length of the loop.
const TOLERANCE: f64 = 1e-10;
/// Largest change of an unknown in one iteration.
const LARGEST_CHANGE: f64 = 2.0;
/// Step of the difference quotients of the boundary conditions.
const DIFFERENCE: f64 = 1e-6;
/// Number of steps from the circular arc to the requested ends.
const PLANAR_STEPS: usize = 16;

/// Whether the ends of a loop may spin about their tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EndSpin {
    /// The ends may not spin: the loop keeps the twist of an untwisted planar loop that is rotated
    /// with its ends.
    Clamped {
        /// Torsional over bending stiffness GJ/EI: 1/(1 + ν) of a round rod.
        stiffness_ratio: f64,
    },
    /// The ends may spin, so there is no twisting moment.
    Free,
}

/// Supports of the ends of a loop of length 1. The loop is symmetric under half a turn about the y axis.
///
/// The lower end of the loop is at (−a cos θ, −a sin θ, −c/2), with the tangent (sin φ sin θ, −sin
/// φ cos θ, cos φ); the mirrored end is at the top. At θ = 0 and a = 0 the loop is in the half
/// plane y > 0 of x = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopEnds {
    /// Distance c of the ends along the z axis, between 0 and 1.
    pub gap: f64,
    /// Angle φ between tangents and z axis, rad.
    pub tilt: f64,
    /// Angle θ by which the lower end is rotated about the z axis, and the upper one by −θ, rad.
    pub rotation: f64,
    /// Distance a of the ends from the z axis.
    pub offset: f64,
    /// Spin about the tangents.
    pub spin: EndSpin,
}

/// Half of a loop in equilibrium: the inextensible Kirchhoff rod
///
/// ```text
/// r' = t,  t' = M × t/EI,  d' = (M + (EI/GJ − 1) (M·t) t) × d/EI,  M' = −t × n,  n' = 0
/// ```
///
/// from the middle, which is on the y axis, to the lower end, with a material director d. Length
/// and EI are 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuspendedLoop {
    /// Supports of its ends.
    pub ends: LoopEnds,
    unknowns: SVector<f64, 6>,
}

/// Position, tangent, director, moment, and energy from the middle on.
type State = [f64; 13];

fn part(state: &State, first: usize) -> Vector3 {
    Vector3::new(state[first], state[first + 1], state[first + 2])
}

impl LoopEnds {
    /// Position, tangent, and the direction of the director of the lower end.
    fn lower(&self) -> [Vector3; 3] {
        let (sine, cosine) = libm::sincos(self.rotation);
        let turned =
            |x: f64, y: f64, z: f64| Vector3::new(cosine * x - sine * y, sine * x + cosine * y, z);
        [
            turned(-self.offset, 0.0, -0.5 * self.gap),
            turned(0.0, -libm::sin(self.tilt), libm::cos(self.tilt)),
            turned(1.0, 0.0, 0.0),
        ]
    }

    fn twist_compliance(&self) -> f64 {
        match self.spin {
            EndSpin::Clamped { stiffness_ratio } => 1.0 / stiffness_ratio,
            // The twisting moment is zero for any stiffness.
            EndSpin::Free => 1.0,
        }
    }
}

impl SuspendedLoop {
    /// The planar loop, θ = 0, found from the circular arc over the gap by rotating and shifting
    /// the ends; `None` if it is not found.
    pub fn planar(gap: f64, tilt: f64, offset: f64, spin: EndSpin) -> Option<Self> {
        // Ratio of the chord of an arc with half angle α to its length: sin α/α.
        let half_angle = bisect(1e-6, PI, |angle| libm::sin(angle) / angle - gap);
        let curvature = 2.0 * half_angle;
        let height = (1.0 - libm::cos(half_angle)) / curvature;
        let arc = Self {
            ends: LoopEnds {
                gap,
                tilt: PI - half_angle,
                rotation: 0.0,
                offset: 0.0,
                spin,
            },
            unknowns: SVector::from([height, 0.0, 0.0, 0.0, -curvature, 0.0]),
        };
        (1..=PLANAR_STEPS).try_fold(arc, |solution, step| {
            let part = step as f64 / PLANAR_STEPS as f64;
            solution.moved_to(LoopEnds {
                tilt: arc.ends.tilt + part * (tilt - arc.ends.tilt),
                offset: part * offset,
                ..arc.ends
            })
        })
    }

    /// The equilibrium near this one with other supports; `None` if Newton's method finds none.
    pub fn moved_to(&self, ends: LoopEnds) -> Option<Self> {
        self.corrected(ends, self.unknowns)
    }

    /// As [`Self::moved_to`], but starts from the extrapolation through `before` and this one.
    pub fn continued_to(&self, before: &Self, ends: LoopEnds) -> Option<Self> {
        self.corrected(ends, 2.0 * self.unknowns - before.unknowns)
    }

    fn corrected(&self, ends: LoopEnds, mut unknowns: SVector<f64, 6>) -> Option<Self> {
        for _ in 0..MOST_ITERATIONS {
            let residual = residual(&ends, &unknowns);
            if residual.amax() < TOLERANCE {
                return Some(Self { ends, unknowns });
            }
            let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
            for column in 0..6 {
                let step = DIFFERENCE * (1.0 + unknowns[column].abs());
                let at = |sign: f64| {
                    let mut moved = unknowns;
                    moved[column] += sign * step;
                    self::residual(&ends, &moved)
                };
                jacobian.set_column(column, &((at(1.0) - at(-1.0)) / (2.0 * step)));
            }
            let change = jacobian.lu().solve(&residual)?;
            let largest = change.amax();
            if !largest.is_finite() {
                return None;
            }
            unknowns -= change * (LARGEST_CHANGE / largest).min(1.0);
        }
        None
    }

    /// Energy of the whole loop, over EI/length: ½ ∫ (κ² + M_t²/GJ) ds.
    pub fn energy(&self) -> f64 {
        2.0 * self.lower_end()[12]
    }

    /// dE/dθ, over EI/length: the moment about the z axis on the lower end, doubled to include
    /// both ends.
    pub fn turning_moment(&self) -> f64 {
        let end = self.lower_end();
        let force = Vector3::new(self.unknowns[2], 0.0, self.unknowns[3]);
        2.0 * (part(&end, 9) + part(&end, 0).cross(&force)).z
    }

    /// Distance of the middle from the z axis, over the length; negative on the other side of the axis.
    pub fn height(&self) -> f64 {
        self.unknowns[0]
    }

    /// Points at equal steps from the upper end to the lower, in units of the length.
    #[cfg(test)]
    pub(crate) fn points(&self) -> Vec<Vector3> {
        let lower = shoot(&self.ends, &self.unknowns);
        let upper = lower.iter().skip(1).rev().map(|state| {
            let point = part(state, 0);
            Vector3::new(-point.x, point.y, -point.z)
        });
        upper
            .chain(lower.iter().map(|state| part(state, 0)))
            .collect()
    }

    fn lower_end(&self) -> State {
        shoot(&self.ends, &self.unknowns)[STEPS]
    }
}

/// The half loop given by the unknowns [y, β, n_x, n_z, M_x, M_z] at its middle. There the tangent
/// is (sin β, 0, −cos β), and by symmetry n_y = M_y = 0.
fn shoot(ends: &LoopEnds, unknowns: &SVector<f64, 6>) -> Vec<State> {
    let [y, angle, force_x, force_z, moment_x, moment_z] = (*unknowns).into();
    let (sine, cosine) = libm::sincos(angle);
    let force = Vector3::new(force_x, 0.0, force_z);
    let compliance = ends.twist_compliance();
    let middle = [
        0.0, y, 0.0, sine, 0.0, -cosine, cosine, 0.0, sine, moment_x, 0.0, moment_z, 0.0,
    ];
    runge_kutta(0.0, 0.5, middle, STEPS, |_, state| {
        let [tangent, director, moment] = [3, 6, 9].map(|first| part(state, first));
        let twisting = moment.dot(&tangent);
        let darboux = moment + (compliance - 1.0) * twisting * tangent;
        let bending = moment - twisting * tangent;
        let energy = 0.5 * (bending.norm_squared() + compliance * twisting * twisting);
        let slopes = [
            tangent,
            moment.cross(&tangent),
            darboux.cross(&director),
            -tangent.cross(&force),
        ];
        std::array::from_fn(|i| {
            if i == 12 {
                energy
            } else {
                slopes[i / 3][i % 3]
            }
        })
    })
}

/// Errors at the lower end: three of the position, two of the tangent, one of the spin.
fn residual(ends: &LoopEnds, unknowns: &SVector<f64, 6>) -> SVector<f64, 6> {
    let end = shoot(ends, unknowns)[STEPS];
    let [position, tangent, director] = ends.lower();
    let across = tangent.cross(&director);
    let [actual, reached, spun, moment] = [0, 3, 6, 9].map(|first| part(&end, first));
    let spin = match ends.spin {
        EndSpin::Clamped { .. } => spun.dot(&across),
        EndSpin::Free => moment.dot(&reached),
    };
    let off = actual - position;
    SVector::from([
        off.x,
        off.y,
        off.z,
        reached.dot(&director),
        reached.dot(&across),
        spin,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::test_support::assert_close;
    use std::f64::consts::FRAC_PI_3;

    const CLAMPED: EndSpin = EndSpin::Clamped {
        stiffness_ratio: 2.0 / 3.0,
    };

    fn turned(spin: EndSpin, offset: f64, rotation: f64) -> SuspendedLoop {
        let mut solution = SuspendedLoop::planar(0.7, FRAC_PI_3, offset, spin).unwrap();
        let steps = 20;
        for step in 1..=steps {
            let ends = LoopEnds {
                rotation: rotation * f64::from(step) / f64::from(steps),
                ..solution.ends
            };
            solution = solution.moved_to(ends).unwrap();
        }
        solution
    }

    #[test]
    fn the_moment_is_the_derivative_of_the_energy() {
        for spin in [CLAMPED, EndSpin::Free] {
            for (offset, rotation) in [(0.0, 0.4), (0.02, 1.0), (-0.02, 1.3)] {
                let at = turned(spin, offset, rotation);
                let energy = |rotation| {
                    let ends = LoopEnds {
                        rotation,
                        ..at.ends
                    };
                    at.moved_to(ends).unwrap().energy()
                };
                let step = 1e-3;
                let difference = (energy(rotation + step) - energy(rotation - step)) / (2.0 * step);
                let moment = at.turning_moment();
                assert_close(moment, difference, 1e-5);
            }
        }
    }

    #[test]
    fn an_arc_stays_an_arc() {
        // A chord of sin α/α with the tangents of the arc has the energy ½ (2α)² and no moment
        // about the axis.
        let half_angle = 1.2f64;
        let gap = half_angle.sin() / half_angle;
        let arc = SuspendedLoop::planar(gap, PI - half_angle, 0.0, CLAMPED).unwrap();
        assert!((arc.energy() - 2.0 * half_angle.powi(2)).abs() < 1e-9);
        assert!(arc.turning_moment().abs() < 1e-9);
        let points = arc.points();
        assert_eq!(points.len(), 2 * STEPS + 1);
        let chord = points[0] - points[2 * STEPS];
        assert!((chord - Vector3::new(0.0, 0.0, gap)).norm() < 1e-9);
    }

    #[test]
    fn the_energy_is_even_in_the_rotation() {
        for spin in [CLAMPED, EndSpin::Free] {
            let [here, mirrored] = [0.6, -0.6].map(|rotation| turned(spin, 0.0, rotation));
            assert!((here.energy() - mirrored.energy()).abs() < 1e-8);
            assert!((here.turning_moment() + mirrored.turning_moment()).abs() < 1e-7);
        }
    }
}
