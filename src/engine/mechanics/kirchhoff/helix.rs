//! Helical equilibria of a naturally straight Kirchhoff rod and the linearised equations about them.

use super::numerics::bisect;
use crate::mechanics::{Matrix3, Vector3};
use nalgebra::SMatrix;
use std::f64::consts::{PI, TAU};

/// Rotation θ and displacement ρ of a cross-section, then the changes μ and ν of moment and force.
pub(crate) type StateMatrix = SMatrix<f64, 12, 12>;

/// A helical equilibrium: a point of the (κ, τ, ω) space of Borum & Bretl 2020.
///
/// Lengths are in a unit L, moments in EI/L and forces in EI/L². In the frame (tangent, binormal,
/// tangent × binormal), which follows the centreline, Darboux vector, moment and force are constant:
/// u = (τ, κ, 0), m = (ω, κ, 0) and n = (ω − τ) u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Helix {
    /// Curvature κ of the centreline.
    pub curvature: f64,
    /// Torsion τ of the centreline.
    pub torsion: f64,
    /// Twisting moment ω.
    pub twisting_moment: f64,
}

impl From<[f64; 3]> for Helix {
    /// The helix of (κ, τ, ω).
    fn from([curvature, torsion, twisting_moment]: [f64; 3]) -> Self {
        Self {
            curvature,
            torsion,
            twisting_moment,
        }
    }
}

impl Helix {
    /// Norm of (κ, τ, ω): the distance from the straight rod without twist.
    pub fn distance(&self) -> f64 {
        let Self {
            curvature,
            torsion,
            twisting_moment,
        } = self;
        Vector3::new(*curvature, *torsion, *twisting_moment).norm()
    }

    /// The helix whose (κ, τ, ω) is `factor` times this one's.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            curvature: factor * self.curvature,
            torsion: factor * self.torsion,
            twisting_moment: factor * self.twisting_moment,
        }
    }

    /// Radius κ/(κ² + τ²); 0 for a straight rod.
    pub fn radius(&self) -> f64 {
        if self.curvature == 0.0 {
            0.0
        } else {
            self.curvature / (self.curvature.powi(2) + self.torsion.powi(2))
        }
    }

    /// Tangent at arc length `s`. At s = 0 tangent and binormal are the x and the y axis.
    pub fn tangent(&self, s: f64) -> Vector3 {
        let (axis, rate) = self.axis();
        let along = axis.dot(&Vector3::x()) * axis;
        let (sine, cosine) = libm::sincos(rate * s);
        along + cosine * (Vector3::x() - along) + sine * axis.cross(&Vector3::x())
    }

    /// Point of the centreline at arc length `s`: the integral of [`tangent`](Self::tangent) from 0.
    pub fn position(&self, s: f64) -> Vector3 {
        let (axis, rate) = self.axis();
        if rate == 0.0 {
            return s * Vector3::x();
        }
        let along = axis.dot(&Vector3::x()) * axis;
        let (sine, cosine) = libm::sincos(rate * s);
        s * along
            + (sine * (Vector3::x() - along) + (1.0 - cosine) * axis.cross(&Vector3::x())) / rate
    }

    /// Smallest distance between points of the centreline, of length 1, that are at least half a
    /// turn apart; `None` if the centreline makes less than half a turn or is straight.
    ///
    /// Points at an angle φ from each other about the axis have the distance √(2a²(1 − cos φ) +
    /// (bφ)²), with a = κ/(κ² + τ²) and b = τ/(κ² + τ²). The distance is least within the first
    /// turn.
    pub(crate) fn self_distance(&self) -> Option<f64> {
        let rate = libm::hypot(self.curvature, self.torsion);
        if self.curvature == 0.0 {
            return None;
        }
        let (a, b) = (self.curvature / (rate * rate), self.torsion / (rate * rate));
        let distance =
            |angle: f64| libm::hypot((2.0 * a * a * (1.0 - libm::cos(angle))).sqrt(), b * angle);
        let last = rate.min(TAU);
        if last < PI {
            return None;
        }
        // The derivative a² sin φ + b² φ is positive at half a turn and may have two zeros up to a
        // whole turn. If it is negative at its minimum, cos φ = −b²/a², the smallest distance is
        // beyond that angle.
        let steepest = TAU - libm::acos((-(b / a).powi(2)).max(-1.0));
        let derivative = |angle: f64| a * a * libm::sin(angle) + b * b * angle;
        let minimum = if steepest < last && derivative(steepest) < 0.0 && derivative(last) > 0.0 {
            bisect(steepest, last, derivative)
        } else {
            last
        };
        Some(distance(PI).min(distance(minimum)))
    }

    /// Distance ‖(κ, τ, ω)‖ along this direction at which a rod of length 1 first touches itself;
    /// `None` if it does not up to `farthest`.
    ///
    /// The rod of length 1 at distance S is, scaled, one of length S at distance 1: its points
    /// come nearer as S grows.
    pub fn contact_distance(&self, radius: f64, farthest: f64) -> Option<f64> {
        let direction = self.scaled(1.0 / self.distance());
        let gap = |distance: f64| {
            let nearest = direction.scaled(distance).self_distance();
            nearest.map_or(1.0, |nearest| nearest - 2.0 * radius)
        };
        (gap(farthest) < 0.0).then(|| bisect(0.0, farthest, gap))
    }

    /// Unit vector along which the helix winds, and the rate √(κ² + τ²) of turning about it.
    pub fn axis(&self) -> (Vector3, f64) {
        let rate = libm::hypot(self.curvature, self.torsion);
        if rate == 0.0 {
            (Vector3::x(), rate)
        } else {
            (Vector3::new(self.torsion, self.curvature, 0.0) / rate, rate)
        }
    }

    /// Matrix A of the linearised equations y' = A y, y = (θ, ρ, μ, ν), in the frame of the centreline.
    ///
    /// A cross-section that rotates by θ and moves by ρ changes the moment by μ and the force by
    /// ν. With d/ds = ( )' + u × ( ) in the rotating frame, t = (1, 0, 0) and the stiffness K =
    /// diag(c, 1, 1),
    ///
    /// - θ' + u × θ = K⁻¹ (μ − θ × m): bending and twist change by μ without the part due to
    ///   rotation,
    /// - ρ' + u × ρ = θ × t: no stretch, no shear,
    /// - μ' + u × μ = −(θ × t) × n − t × ν: balance of moments,
    /// - ν' + u × ν = 0: balance of forces.
    ///
    /// The rod is isotropic, so the rotation of the material frame about the tangent does not
    /// appear. The conjugate points do not depend on c = GJ/EI either, which is 1 here.
    pub(crate) fn linearised_equations(&self) -> StateMatrix {
        let darboux = Vector3::new(self.torsion, self.curvature, 0.0);
        let moment = Vector3::new(self.twisting_moment, self.curvature, 0.0);
        let force = (self.twisting_moment - self.torsion) * darboux;
        let across_tangent = -Vector3::x().cross_matrix();
        let turning = -darboux.cross_matrix();
        let mut matrix = StateMatrix::zeros();
        let mut set = |row: usize, column: usize, block: Matrix3| {
            matrix
                .fixed_view_mut::<3, 3>(3 * row, 3 * column)
                .copy_from(&block);
        };
        let [rotation, displacement, moment_change, force_change] = [0, 1, 2, 3];
        set(rotation, rotation, turning + moment.cross_matrix());
        set(rotation, moment_change, Matrix3::identity());
        set(displacement, rotation, across_tangent);
        set(displacement, displacement, turning);
        set(
            moment_change,
            rotation,
            force.cross_matrix() * across_tangent,
        );
        set(moment_change, moment_change, turning);
        set(moment_change, force_change, across_tangent);
        set(force_change, force_change, turning);
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with the end of the rod in the thesis, Eq. 6.2 without its misprints.
    #[test]
    fn the_centreline_is_a_helix() {
        let helix = Helix {
            curvature: 2.0,
            torsion: -3.0,
            twisting_moment: 0.0,
        };
        let rate = 13f64.sqrt();
        let (sine, cosine) = rate.sin_cos();
        let lengthwise = 9.0 / 13.0 + 4.0 * sine / 13.0 / rate;
        let binormal = -6.0 * (1.0 - sine / rate) / 13.0;
        let normal = 2.0 * (cosine - 1.0) / 13.0;
        let end = helix.position(1.0);
        assert!((end - Vector3::new(lengthwise, binormal, normal)).norm() < 1e-14);
        let step = 1e-5;
        let slope = (helix.position(0.7 + step) - helix.position(0.7 - step)) / (2.0 * step);
        assert!((slope - helix.tangent(0.7)).norm() < 1e-9);
    }

    #[test]
    fn the_rod_is_nearest_to_itself_where_sampling_says() {
        for (curvature, torsion) in [(6.5, 0.1), (6.5, 2.0), (5.0, 4.0), (12.0, 1.0), (3.3, 0.0)] {
            let helix = Helix::from([curvature, torsion, 0.0]);
            let rate: f64 = curvature.hypot(torsion);
            let steps = 100_000;
            let sampled = (0..=steps)
                .map(|k| PI / rate + (1.0 - PI / rate) * f64::from(k) / f64::from(steps))
                .map(|arc| (helix.position(arc) - helix.position(0.0)).norm())
                .fold(f64::INFINITY, f64::min);
            let found = helix.self_distance().unwrap();
            assert!(
                (found - sampled).abs() < 1e-6,
                "{curvature} {torsion}: {found} {sampled}"
            );
        }
        assert_eq!(Helix::from([2.0, 2.0, 0.0]).self_distance(), None);
    }

    /// The ends of a rod bent towards a circle touch before it is closed, because of its
    /// thickness.
    #[test]
    fn a_ring_touches_itself_at_its_ends() {
        let radius = 1e-3;
        let found = Helix::from([1.0, 0.0, 0.0]).contact_distance(radius, 7.0);
        let gap = TAU - found.unwrap();
        // The chord of the gap: 2 sin(gap/2)/κ = 2h.
        assert!((gap - 2.0 * radius * TAU).abs() < 1e-4, "{gap}");
        assert_eq!(
            Helix::from([0.0, 1.0, 1.0]).contact_distance(radius, 20.0),
            None
        );
    }

    /// exp(A s) preserves the symplectic form of (θ, ρ) and their momenta (μ − ½ θ × m, ν).
    #[test]
    fn the_equations_are_hamiltonian() {
        let helix = Helix {
            curvature: 0.7,
            torsion: -0.4,
            twisting_moment: 1.3,
        };
        let moment = Vector3::new(1.3, 0.7, 0.0);
        let mut to_momenta = StateMatrix::identity();
        to_momenta
            .fixed_view_mut::<3, 3>(6, 0)
            .copy_from(&(0.5 * moment.cross_matrix()));
        let back = to_momenta.try_inverse().unwrap();
        let canonical = to_momenta * helix.linearised_equations() * back;
        let mut form = StateMatrix::zeros();
        for k in 0..6 {
            form[(k, k + 6)] = 1.0;
            form[(k + 6, k)] = -1.0;
        }
        let product = form * canonical;
        assert!((product - product.transpose()).abs().max() < 1e-14);
    }
}
