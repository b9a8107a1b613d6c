//! Rigid helices in viscous flow by a dense method, independent of the discrete rods.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Points within a regularisation length.
const POINTS_IN_LENGTH: f64 = 2.0;

/// A right-handed helix about the axis z from (radius, 0, 0), in a fluid of unit viscosity.
pub(super) struct RigidHelix {
    /// Radius of the helix.
    pub radius: f64,
    /// Pitch.
    pub pitch: f64,
    /// Number of turns.
    pub turns: f64,
    /// Regularisation length ε of the point forces.
    pub regularization: f64,
}

impl RigidHelix {
    /// Returns the resistances A, B and D: the helix that moves along its axis at the speed U and
    /// turns about it at the rate Ω needs the force A U + B Ω and the torque B U + D Ω.
    ///
    /// Point forces f along the centreline move the fluid by 8π u = Σ ((1/R + ε²/R³) f + (f·r) r/R³),
    /// R² = r² + ε² (Cortez 2001), which is the motion of the helix at all points, both ends included.
    ///
    /// # Panics
    /// Never: the matrix is positive definite.
    pub fn resistances(&self) -> [f64; 3] {
        let round = std::f64::consts::TAU * self.radius;
        let length = self.turns * libm::hypot(round, self.pitch);
        let intervals = (length / self.regularization * POINTS_IN_LENGTH) as usize;
        let points = intervals + 1;
        let place = |k: usize| {
            let part = k as f64 / intervals as f64 * self.turns;
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * part);
            Vector3::new(self.radius * cos, self.radius * sin, self.pitch * part)
        };
        let places: Vec<Vector3<f64>> = (0..points).map(place).collect();
        let mut flow = DMatrix::zeros(3 * points, 3 * points);
        for (i, here) in places.iter().enumerate() {
            for (j, there) in places.iter().enumerate() {
                let apart = here - there;
                let squared = self.regularization * self.regularization;
                let distance = (apart.norm_squared() + squared).sqrt();
                let cubed = distance.powi(3);
                let block = Matrix3::identity() * (1.0 / distance + squared / cubed)
                    + apart * apart.transpose() / cubed;
                flow.fixed_view_mut::<3, 3>(3 * i, 3 * j).copy_from(&block);
            }
        }
        let along = places.iter().flat_map(|_| [0.0, 0.0, 1.0]);
        let around = places.iter().flat_map(|x| [-x.y, x.x, 0.0]);
        let motions: [DVector<f64>; 2] = [
            DVector::from_iterator(3 * points, along),
            DVector::from_iterator(3 * points, around),
        ];
        let factor = flow.cholesky().expect("the flow of forces dissipates");
        let [moved, turned] = motions.each_ref().map(|motion| factor.solve(motion));
        let unit = 8.0 * std::f64::consts::PI;
        let products = [
            moved.dot(&motions[0]),
            moved.dot(&motions[1]),
            turned.dot(&motions[1]),
        ];
        products.map(|product| unit * product)
    }
}
