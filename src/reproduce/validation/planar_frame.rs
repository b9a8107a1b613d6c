//! Limit loads of planar frames by shooting, a method independent of the discrete rods.

use nalgebra::{Matrix3x4, Matrix4, Vector3, Vector4};
use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};

/// Steps of the Runge–Kutta method on each segment.
const STEPS: usize = 400;
/// Step of difference quotients.
const DIFFERENCE: f64 = 1e-6;
/// Largest arclength of a step along the path of equilibria, in the unknowns.
const PATH_STEP: f64 = 0.1;
/// Least cosine of the angle by which the path turns in a step.
const LEAST_COSINE: f64 = 0.9;
/// Maximum number of steps along the path.
const MOST_STEPS: usize = 2000;
const MOST_ITERATIONS: usize = 30;
/// Norm of the residual below which a solution has converged.
const TOLERANCE: f64 = 1e-11;

/// Support of the frame at its start, with the direction of its tangent there, rad from x towards
/// z.
pub(super) enum Start {
    /// The tangent is held.
    Clamped(f64),
    /// Hinge: the frame turns freely; the direction is that of the unloaded frame.
    Hinged(f64),
}

/// A piece of the frame.
pub(super) struct Segment {
    /// Natural length.
    pub length: f64,
    /// Natural curvature.
    pub curvature: f64,
    /// Angle of the corner before the piece, rad.
    pub corner: f64,
    /// Whether the load acts at the start of the piece.
    pub is_loaded: bool,
}

/// Support of the frame at its end.
pub(super) enum End {
    /// The tangent is held in this direction, rad from x towards z.
    Clamped(f64),
    /// Hinge.
    Hinged,
}

/// A frame with EI = 1 in the plane of x and z whose ends are supported; the load P acts along −z.
///
/// ```text
/// r' = (1 + n·t/EA) t,  t = (cos θ, sin θ),  θ' = κ + m,  m' = n_x r_z' − n_z r_x'
/// ```
///
/// with the force n and the moment m that the material behind s exerts, n constant except for a
/// jump by (0, P) at the load. The unknowns are P, the force at the start, and the moment there,
/// or the direction of the tangent if the start is hinged. The end must be at its place, without a
/// moment or in its direction.
pub(super) struct PlanarFrame<'a> {
    /// The start.
    pub start: Start,
    /// The pieces, from the start.
    pub segments: &'a [Segment],
    /// Place of the end from the start.
    pub end: [f64; 2],
    /// Support of the end.
    pub support: End,
    /// EA.
    pub stretching: f64,
}

impl PlanarFrame<'_> {
    /// Returns the loads at the first folds of the path of equilibria; `None` if there are fewer.
    pub fn limit_loads<const N: usize>(&self) -> Option<[f64; N]> {
        let angle = match self.start {
            Start::Clamped(_) => 0.0,
            Start::Hinged(angle) => angle,
        };
        let mut here = Vector4::new(angle, 0.0, 0.0, 0.0);
        let mut tangent = self.tangent(&here, &Vector4::w())?;
        let mut loads = Vec::new();
        let mut step = PATH_STEP;
        for _ in 0..MOST_STEPS {
            let next = self.beyond(&here, &tangent, step);
            let after = next.and_then(|next| self.tangent(&next, &tangent));
            let is_smooth = |after: &Vector4<f64>| after.dot(&tangent) > LEAST_COSINE;
            let Some((next, after)) = next.zip(after.filter(is_smooth)) else {
                step *= 0.5;
                continue;
            };
            if after.w * tangent.w <= 0.0 {
                let rate = |step: f64| {
                    let there = self.beyond(&here, &tangent, step);
                    let along = there.and_then(|there| self.tangent(&there, &tangent));
                    along.map_or(f64::NAN, |along| along.w)
                };
                let fold = bisect(0.0, step, rate);
                loads.push(self.beyond(&here, &tangent, fold)?.w);
                if loads.len() == N {
                    return loads.try_into().ok();
                }
            }
            (here, tangent) = (next, after);
            step = PATH_STEP.min(2.0 * step);
        }
        None
    }

    /// Finds the point of the path at a distance along its tangent.
    fn beyond(
        &self,
        here: &Vector4<f64>,
        tangent: &Vector4<f64>,
        step: f64,
    ) -> Option<Vector4<f64>> {
        let predicted = here + step * tangent;
        let mut unknowns = predicted;
        for _ in 0..MOST_ITERATIONS {
            let misfit = self.misfit(&unknowns);
            let residual = misfit.push(tangent.dot(&(unknowns - predicted)));
            if residual.norm() < TOLERANCE {
                return Some(unknowns);
            }
            unknowns -= self.bordered(&unknowns, tangent).lu().solve(&residual)?;
        }
        None
    }

    /// Unit tangent of the path, in the same sense as the previous one.
    fn tangent(&self, unknowns: &Vector4<f64>, before: &Vector4<f64>) -> Option<Vector4<f64>> {
        let tangent = self.bordered(unknowns, before).lu().solve(&Vector4::w())?;
        Some(tangent.normalize())
    }

    /// Jacobian of the misfit, with another row below it.
    fn bordered(&self, unknowns: &Vector4<f64>, row: &Vector4<f64>) -> Matrix4<f64> {
        let columns: [Vector3<f64>; 4] = std::array::from_fn(|axis| {
            let change = DIFFERENCE * Vector4::ith(axis, 1.0);
            let [ahead, behind] = [unknowns + change, unknowns - change].map(|u| self.misfit(&u));
            (ahead - behind) / (2.0 * DIFFERENCE)
        });
        let jacobian = Matrix3x4::from_columns(&columns);
        Matrix4::from_fn(|i, j| if i < 3 { jacobian[(i, j)] } else { row[j] })
    }

    /// Deviation of the end from its prescribed place, and the moment or deviation of the angle there.
    fn misfit(&self, unknowns: &Vector4<f64>) -> Vector3<f64> {
        let [free, mut force, load] = [unknowns.x, 0.0, unknowns.w];
        let (angle, moment) = match self.start {
            Start::Clamped(angle) => (angle, free),
            Start::Hinged(_) => (free, 0.0),
        };
        let across = unknowns.y;
        force += unknowns.z;
        let mut state = [0.0, 0.0, angle, moment];
        for segment in self.segments {
            if segment.is_loaded {
                force += load;
            }
            state[2] += segment.corner;
            let slope = |_: f64, [_, _, angle, moment]: &[f64; 4]| {
                let (sin, cos) = libm::sincos(*angle);
                let stretch = 1.0 + (across * cos + force * sin) / self.stretching;
                let [x, z] = [stretch * cos, stretch * sin];
                [x, z, segment.curvature + moment, across * z - force * x]
            };
            let states = runge_kutta(0.0, segment.length, state, STEPS, slope);
            state = states[states.len() - 1];
        }
        let [x, z, angle, moment] = state;
        let free = match self.support {
            End::Clamped(held) => angle - held,
            End::Hinged => moment,
        };
        Vector3::new(x - self.end[0], z - self.end[1], free)
    }
}
