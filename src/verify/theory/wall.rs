//! Drag of rods beside a wall, from regularised Stokeslets with their images term by term,
//! quadrature and a dense solution; and the drag of a long cylinder in closed form.

use super::stokeslet::{adaptive_integral, regularized_stokeslet};
use nalgebra::{DMatrix, Matrix3, Vector3};
use std::f64::consts::PI;

/// Velocity per force at `x`, times 8πη, of a regularised Stokeslet at `y` above the wall z = 0,
/// with the images listed by Ainley et al. (2008): the Stokeslet at the mirrored point, a dipole
/// of the blob 3ε²/(4π R⁵), a doublet, and the difference of two rotlets.
pub fn stokeslet_at_wall(x: &Vector3<f64>, y: &Vector3<f64>, regularization: f64) -> Matrix3<f64> {
    let height = y.z;
    let v = x - Vector3::new(y.x, y.y, -height);
    let squared = regularization * regularization;
    let inverse = 1.0 / (v.norm_squared() + squared).sqrt();
    let (cubed, fifth) = (inverse.powi(3), inverse.powi(5));
    let up = Vector3::z();
    let image = |f: Vector3<f64>| {
        let g = Vector3::new(-f.x, -f.y, f.z);
        let dipole = g * (3.0 * squared * fifth - cubed) + v * (3.0 * g.dot(&v) * fifth);
        let doublet = up * (-g.dot(&v) * (cubed + 3.0 * squared * fifth))
            + (v * g.z + g * v.z) * cubed
            - v * (3.0 * v.z * g.dot(&v) * fifth);
        let rotlets = (up * g.dot(&v) - g * v.z) * (3.0 * squared * fifth);
        (dipole * height + doublet + rotlets) * (2.0 * height)
    };
    let images = Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(image));
    regularized_stokeslet(&(x - y), regularization) - regularized_stokeslet(&v, regularization)
        + images
}

/// The force that a polyline above the wall z = 0 exerts on the fluid in a rigid motion with unit
/// speed along x, y or z. Each direction is a column, N s/m.
pub fn drag_at_wall(nodes: &[Vector3<f64>], regularization: f64, viscosity: f64) -> Matrix3<f64> {
    let count = nodes.len();
    let mut matrix = DMatrix::zeros(3 * count, 3 * count);
    for (i, x) in nodes.iter().enumerate() {
        for k in 0..count - 1 {
            let [first, second] = adaptive_integral(&nodes[k], &nodes[k + 1], |y| {
                stokeslet_at_wall(x, y, regularization)
            });
            let mut near = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * k);
            near += first;
            let mut far = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * k + 3);
            far += second;
        }
    }
    let motions = DMatrix::from_fn(3 * count, 3, |row, axis| {
        if row % 3 == axis {
            8.0 * PI * viscosity
        } else {
            0.0
        }
    });
    let densities = matrix
        .lu()
        .solve(&motions)
        .expect("the Stokeslet matrix is regular");
    let edge = |k: usize| (nodes[k + 1] - nodes[k]).norm();
    let mut drag = Matrix3::zeros();
    for k in 0..count {
        let before = if k > 0 { edge(k - 1) } else { 0.0 };
        let after = if k + 1 < count { edge(k) } else { 0.0 };
        drag += densities.fixed_view::<3, 3>(3 * k, 0) * (0.5 * (before + after));
    }
    drag
}

/// Drag per length and velocity of a long cylinder that moves along its axis at a height above a
/// wall, N s/m²: 2πη/arcosh(height/radius), exact (Couette flow between a cylinder and a plane in
/// bipolar coordinates).
pub fn gliding_cylinder(viscosity: f64, radius: f64, height: f64) -> f64 {
    2.0 * PI * viscosity / libm::acosh(height / radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fluid_rests_on_the_wall_and_keeps_its_volume() {
        let y = Vector3::new(0.1, -0.3, 0.4);
        for epsilon in [1e-6, 0.1, 1.0] {
            let wall = Vector3::new(0.7, 0.2, 0.0);
            let scale = regularized_stokeslet(&(wall - y), epsilon).norm();
            assert!(stokeslet_at_wall(&wall, &y, epsilon).norm() < 1e-14 * scale);
            let x = Vector3::new(-0.2, 0.5, 0.3);
            let step = 1e-4;
            let slope = |axis: usize| {
                let move_ = Vector3::ith(axis, step);
                let flow = |x: Vector3<f64>| stokeslet_at_wall(&x, &y, epsilon);
                (flow(x + move_) - flow(x - move_)).row(axis) / (2.0 * step)
            };
            let divergence = slope(0) + slope(1) + slope(2);
            assert!(divergence.norm() < 1e-6 * slope(0).norm(), "{divergence}");
        }
    }

    #[test]
    fn a_sphere_of_forces_near_the_wall_is_slowed_as_faxen_found() {
        // The velocity of a blob under a force is reduced by 9a/16h along the wall and 9a/8h
        // across it (Faxén 1922, Lorentz 1907), where a is the radius of a sphere with the same
        // drag: 8πη u = (6πηa)⁻¹ 8πη f = 4/(3a) f.
        let epsilon = 1e-3;
        let radius = 4.0 / 3.0 / (2.0 / epsilon);
        let y = Vector3::new(0.0, 0.0, 50.0 * radius);
        let slowed = stokeslet_at_wall(&y, &y, epsilon) * (epsilon / 2.0);
        for (axis, factor) in [(0, 9.0 / 16.0), (1, 9.0 / 16.0), (2, 9.0 / 8.0)] {
            let loss = (1.0 - slowed[(axis, axis)]) * 50.0;
            assert!((loss / factor - 1.0).abs() < 2e-3, "{axis}: {loss}");
        }
    }
}
