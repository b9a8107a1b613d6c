//! Cantilevers in space: any section and natural shape, under their weight and loads at the free
//! end.

use super::numerics::runge_kutta;
use crate::mechanics::{Matrix3, UnitQuaternion, Vector3};
use nalgebra::{DMatrix, DVector, Quaternion, Rotation3};

/// Number of pieces of the rod for multiple shooting.
const PIECES: usize = 8;
/// Number of load increments.
const LOAD_PARTS: usize = 10;
const MOST_ITERATIONS: usize = 20;
/// Largest mismatch of an accepted solution: for quaternions as they are, for moments divided by
/// (smallest stiffness)/length.
const TOLERANCE: f64 = 1e-11;
/// Step of the difference quotients of the matching conditions.
const DIFFERENCE: f64 = 1e-6;
/// Unknowns at the start of a piece: orientation as a quaternion, then moment.
const UNKNOWNS: usize = 7;

/// A rod that is clamped at its start and free at its end, where a force and a moment of fixed direction may act.
///
/// With the Darboux vector u = Σ uᵢ dᵢ in the frame of the directors d₁, d₂ and the tangent d₃,
///
/// ```text
/// r' = (1 + n·d₃/EA) d₃,  dᵢ' = u × dᵢ,  m·dᵢ = Kᵢ (uᵢ − ûᵢ),
/// m' = −r' × n,  n = F + (L − s) w,  m(L) = M
/// ```
///
/// over the natural arc length s: Kirchhoff's rod (Antman 2005, Nonlinear Problems of Elasticity, ch. 8; Dill 1992),
/// which may stretch.
#[derive(Clone, Debug)]
pub struct SpatialCantilever<N> {
    /// Natural length L, m.
    pub length: f64,
    /// EI₁ and EI₂ about the directors, and GJ, N m².
    pub stiffness: [f64; 3],
    /// EA, N.
    pub stretching: f64,
    /// Natural curvatures about the directors and natural twist, [û₁, û₂, û₃] in 1/m, at an arc length in m.
    pub natural: N,
    /// First director at the clamp.
    pub director: Vector3,
    /// Tangent at the clamp, normal to the director.
    pub tangent: Vector3,
    /// Load per natural length w, N/m.
    pub load_per_length: Vector3,
    /// Force F at the free end, N.
    pub end_force: Vector3,
    /// Moment M at the free end, N m.
    pub end_moment: Vector3,
}

/// Orientation as a quaternion (w, x, y, z), moment in space over (smallest stiffness)/L, position from the clamp over L.
type State = [f64; 10];

impl<N: Fn(f64) -> [f64; 3]> SpatialCantilever<N> {
    /// Points of the equilibrium at `steps` + 1 equal natural arc lengths from the clamp on, m;
    /// `None` if it is not found. `steps` is a multiple of 8, and the error is of fourth order in
    /// the step size.
    ///
    /// Multiple shooting: Newton's method finds orientation and moment at the starts of eight
    /// pieces, while the load grows from zero. If there are several equilibria, the result is the
    /// one reached in this way.
    ///
    /// # Panics
    /// If `steps` is not a multiple of 8.
    pub fn points(&self, steps: usize) -> Option<Vec<Vector3>> {
        assert!(steps > 0 && steps.is_multiple_of(PIECES), "{steps} steps");
        let mut unknowns = self.unloaded(steps);
        for part in 1..=LOAD_PARTS {
            let load = part as f64 / LOAD_PARTS as f64;
            unknowns = self.newton(unknowns, steps, load)?;
        }
        let mut points = vec![Vector3::zeros()];
        for piece in 0..PIECES {
            let first = points[points.len() - 1];
            let states = self.integrate(&unknowns, piece, steps, 1.0);
            let later = states.iter().skip(1);
            points.extend(later.map(|state| first + self.length * part(state, 7)));
        }
        Some(points)
    }

    /// The natural shape, without any moment.
    fn unloaded(&self, steps: usize) -> DVector<f64> {
        let frame = Matrix3::from_columns(&[
            self.director,
            self.tangent.cross(&self.director),
            self.tangent,
        ]);
        let clamp = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(frame));
        let mut unknowns = DVector::zeros(PIECES * UNKNOWNS);
        unknowns[0] = clamp.w;
        unknowns.rows_mut(1, 3).copy_from(&clamp.imag());
        for piece in 1..PIECES {
            let end = self.end_of_piece(&unknowns, piece - 1, steps, 0.0);
            unknowns
                .rows_mut(piece * UNKNOWNS, UNKNOWNS)
                .copy_from_slice(&end[..UNKNOWNS]);
        }
        unknowns
    }

    /// The orientation at the clamp is given, so the first four unknowns are fixed.
    fn newton(&self, mut unknowns: DVector<f64>, steps: usize, load: f64) -> Option<DVector<f64>> {
        let count = PIECES * UNKNOWNS - 4;
        for _ in 0..MOST_ITERATIONS {
            let mut residual = DVector::zeros(count);
            let mut jacobian = DMatrix::zeros(count, count);
            for piece in 0..PIECES {
                let end = self.end_of_piece(&unknowns, piece, steps, load);
                let row = piece * UNKNOWNS;
                if piece + 1 < PIECES {
                    for (k, end) in end.iter().take(UNKNOWNS).enumerate() {
                        let next = row + UNKNOWNS + k;
                        residual[row + k] = end - unknowns[next];
                        jacobian[(row + k, next - 4)] = -1.0;
                    }
                } else {
                    let moment = self.end_moment * (load / self.unit_of_moment());
                    let mismatch = part(&end, 4) - moment;
                    residual.rows_mut(row, 3).copy_from(&mismatch);
                }
                let free = if piece == 0 { 4 } else { 0 };
                for k in free..UNKNOWNS {
                    let column = row + k;
                    let moved = |by: f64| {
                        let mut moved = unknowns.clone();
                        moved[column] += by;
                        self.end_of_piece(&moved, piece, steps, load)
                    };
                    let (more, less) = (moved(DIFFERENCE), moved(-DIFFERENCE));
                    let (first, rows) = if piece + 1 < PIECES { (0, 7) } else { (4, 3) };
                    for i in 0..rows {
                        jacobian[(row + i, column - 4)] +=
                            (more[first + i] - less[first + i]) / (2.0 * DIFFERENCE);
                    }
                }
            }
            if residual.amax() < TOLERANCE {
                return Some(unknowns);
            }
            let change = jacobian.lu().solve(&residual)?;
            if !change.amax().is_finite() {
                return None;
            }
            let mut free = unknowns.rows_mut(4, count);
            free -= change;
        }
        None
    }

    fn end_of_piece(
        &self,
        unknowns: &DVector<f64>,
        piece: usize,
        steps: usize,
        load: f64,
    ) -> State {
        let states = self.integrate(unknowns, piece, steps, load);
        states[states.len() - 1]
    }

    /// The states along a piece; positions count from its start.
    fn integrate(
        &self,
        unknowns: &DVector<f64>,
        piece: usize,
        steps: usize,
        load: f64,
    ) -> Vec<State> {
        let start = std::array::from_fn(|k| {
            if k < UNKNOWNS {
                unknowns[piece * UNKNOWNS + k]
            } else {
                0.0
            }
        });
        let at = |piece: usize| piece as f64 / PIECES as f64;
        let steps = steps / PIECES;
        runge_kutta(at(piece), at(piece + 1), start, steps, |s, state| {
            self.slope(s, state, load)
        })
    }

    fn slope(&self, s: f64, state: &State, load: f64) -> State {
        let [w, x, y, z, ..] = *state;
        let quaternion = Quaternion::new(w, x, y, z);
        let orientation = UnitQuaternion::new_normalize(quaternion);
        let moment = orientation.inverse_transform_vector(&part(state, 4)) * self.unit_of_moment();
        let natural = (self.natural)(s * self.length);
        let darboux = Vector3::from_fn(|k, _| natural[k] + moment[k] / self.stiffness[k]);
        let force = (self.end_force + self.load_per_length * ((1.0 - s) * self.length)) * load;
        let tangent = orientation * Vector3::z();
        let along = tangent * (1.0 + force.dot(&tangent) / self.stretching);
        let turning = quaternion * Quaternion::from_imag(darboux * (0.5 * self.length));
        let moment = -along.cross(&force) * (self.length / self.unit_of_moment());
        [
            turning.w, turning.i, turning.j, turning.k, moment.x, moment.y, moment.z, along.x,
            along.y, along.z,
        ]
    }

    fn unit_of_moment(&self) -> f64 {
        let [first, second, twisting] = self.stiffness;
        first.min(second).min(twisting) / self.length
    }
}

fn part(state: &State, first: usize) -> Vector3 {
    Vector3::from_column_slice(&state[first..first + 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::kirchhoff::{Cantilever, CantileverLoad, Helix};

    /// A strip that is pulled and twisted obliquely; m and N.
    fn askew<N>(natural: N) -> SpatialCantilever<N> {
        SpatialCantilever {
            length: 1.3,
            stiffness: [0.7, 3.1, 0.9],
            stretching: 1e4,
            natural,
            director: Vector3::new(0.0, 0.6, 0.8),
            tangent: Vector3::x(),
            load_per_length: Vector3::zeros(),
            end_force: Vector3::new(-1.0, 1.4, -2.0),
            end_moment: Vector3::new(0.3, -0.2, 0.5),
        }
    }

    #[test]
    fn errors_are_of_fourth_order() {
        let rod = SpatialCantilever {
            load_per_length: Vector3::new(0.5, 0.0, -3.0),
            ..askew(|s: f64| [0.8, (2.0 * s).sin(), 1.7 - s])
        };
        let tip = |steps| rod.points(steps).unwrap()[steps];
        let exact = tip(1280);
        let error = |steps| (tip(steps) - exact).norm();
        let order = (error(40) / error(80)).log2();
        assert!((order - 4.0).abs() < 0.3, "{order}");
        assert!(error(320) < 1e-9, "{:e}", error(320));
    }

    #[test]
    fn a_flat_rod_is_the_elastica() {
        let rod = SpatialCantilever {
            length: 1.0,
            stiffness: [1.0, 5.0, 2.0],
            stretching: 1e15,
            natural: |_| [0.0; 3],
            director: Vector3::y(),
            load_per_length: Vector3::new(0.0, 0.0, -15.0),
            end_force: Vector3::zeros(),
            end_moment: Vector3::zeros(),
            tangent: Vector3::x(),
        };
        let elastica = Cantilever::new(CantileverLoad::OwnWeight(15.0));
        let points = rod.points(400).unwrap();
        for (k, point) in points.iter().enumerate() {
            let [x, drop] = elastica.position(k as f64 / 400.0);
            assert!((point - Vector3::new(x, 0.0, -drop)).norm() < 1e-8, "{k}");
        }
    }

    #[test]
    fn without_load_it_has_its_natural_shape() {
        // Tangent, binormal and their product are x, y and z: u = (τ, κ, 0), and m₁ acts along the
        // binormal.
        let helix = Helix::from([2.0, -3.0, 0.0]);
        let rod = SpatialCantilever {
            length: 1.0,
            director: Vector3::y(),
            end_force: Vector3::zeros(),
            end_moment: Vector3::zeros(),
            ..askew(|_| [2.0, 0.0, -3.0])
        };
        for (k, point) in rod.points(800).unwrap().iter().enumerate() {
            let expected = helix.position(k as f64 / 800.0);
            assert!((point - expected).norm() < 1e-9, "{point} {expected}");
        }
    }

    /// If the natural strains are uniform and only the end is loaded, the Hamiltonian Σ mᵢ
    /// (mᵢ/2Kᵢ + ûᵢ) + n·d₃ + (n·d₃)²/2EA is constant along the rod, and so is m + r × n.
    #[test]
    fn integrals_of_the_equations_are_kept() {
        let rod = askew(|_| [0.8, -0.5, 1.7]);
        let steps = 800;
        let unknowns = (1..=LOAD_PARTS).fold(rod.unloaded(steps), |unknowns, part| {
            let load = part as f64 / LOAD_PARTS as f64;
            rod.newton(unknowns, steps, load).unwrap()
        });
        let force = rod.end_force;
        let mut position = Vector3::zeros();
        let mut integrals = Vec::new();
        for piece in 0..PIECES {
            let states = rod.integrate(&unknowns, piece, steps, 1.0);
            for state in &states {
                let [w, x, y, z, ..] = *state;
                let frame = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
                let moment = part(state, 4) * rod.unit_of_moment();
                let own = frame.inverse_transform_vector(&moment);
                let natural = (rod.natural)(0.0);
                let tension = force.dot(&(frame * Vector3::z()));
                let bending: f64 = (0..3)
                    .map(|k| own[k] * (0.5 * own[k] / rod.stiffness[k] + natural[k]))
                    .sum();
                let energy = bending + tension + 0.5 * tension * tension / rod.stretching;
                let at = position + rod.length * part(state, 7);
                integrals.push((energy, moment + at.cross(&force)));
            }
            position += rod.length * part(&states[states.len() - 1], 7);
        }
        let (energy, moment) = integrals[0];
        assert!(energy.abs() > 0.1 && moment.norm() > 0.1);
        for (other, turned) in &integrals {
            assert!((other - energy).abs() < 1e-7, "{other} {energy}");
            assert!((turned - moment).norm() < 1e-7, "{turned} {moment}");
        }
        let end = integrals[integrals.len() - 1].1 - position.cross(&force);
        assert!((end - rod.end_moment).norm() < 1e-9);
    }
}
