//! Drag of rods by regularised Stokeslet segments, with quadrature instead of closed forms and a
//! dense solution instead of Krylov iterations.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rodlab_engine::mechanics::kirchhoff::numerics::gauss_legendre;
use std::f64::consts::PI;

/// Velocity per force of a regularised Stokeslet, times 8πη (Cortez 2001):
/// S(r) = 1/R + ε²/R³ + r rᵀ/R³, R² = |r|² + ε².
pub fn regularized_stokeslet(r: &Vector3<f64>, regularization: f64) -> Matrix3<f64> {
    let squared = regularization * regularization;
    let inverse = 1.0 / (r.norm_squared() + squared).sqrt();
    let cubed = inverse.powi(3);
    Matrix3::identity() * (inverse + squared * cubed) + r * r.transpose() * cubed
}

/// Integrals of S(x − y(s)) (1 − s/L) and S(x − y(s)) s/L along the segment from `start` to `end`, by
/// adaptive Gauss–Legendre quadrature to a relative error of 1e-13.
pub fn adaptive_segment_integral(
    x: &Vector3<f64>,
    start: &Vector3<f64>,
    end: &Vector3<f64>,
    regularization: f64,
) -> [Matrix3<f64>; 2] {
    adaptive_integral(start, end, |y| {
        regularized_stokeslet(&(x - y), regularization)
    })
}

/// These integrals for any kernel that depends on the place on the segment.
pub fn adaptive_integral(
    start: &Vector3<f64>,
    end: &Vector3<f64>,
    kernel: impl Fn(&Vector3<f64>) -> Matrix3<f64>,
) -> [Matrix3<f64>; 2] {
    let rule = gauss_legendre(15);
    let length = (end - start).norm();
    let panel = |from: f64, to: f64| {
        let mut sums = [Matrix3::zeros(); 2];
        for &(place, weight) in &rule {
            let s = from + (to - from) * place;
            let weighted = kernel(&start.lerp(end, s)) * (weight * (to - from) * length);
            sums[0] += weighted * (1.0 - s);
            sums[1] += weighted * s;
        }
        sums
    };
    let mut total = [Matrix3::zeros(); 2];
    let mut open = vec![(0.0, 1.0)];
    while let Some((from, to)) = open.pop() {
        let middle = 0.5 * (from + to);
        let whole = panel(from, to);
        let halves = [panel(from, middle), panel(middle, to)];
        let both = [halves[0][0] + halves[1][0], halves[0][1] + halves[1][1]];
        let error = (whole[0] - both[0]).amax() + (whole[1] - both[1]).amax();
        if error <= 1e-13 * (both[0] + both[1]).amax() || to - from < 1e-6 {
            total[0] += both[0];
            total[1] += both[1];
        } else {
            open.extend([(from, middle), (middle, to)]);
        }
    }
    total
}

/// Forces of a polyline on the fluid, N per node, for given velocities of its nodes (m/s).
pub fn forces(
    nodes: &[Vector3<f64>],
    velocities: &[Vector3<f64>],
    regularization: f64,
    viscosity: f64,
) -> Vec<Vector3<f64>> {
    forces_of_rods(&[nodes.len()], nodes, velocities, regularization, viscosity)
}

/// Forces of polylines on the fluid, N per node, for given velocities of their nodes (m/s). The
/// method is collocation at the nodes, with force densities that are linear along each edge, and a
/// dense LU decomposition. `rods` contains the number of nodes of each polyline.
pub fn forces_of_rods(
    rods: &[usize],
    nodes: &[Vector3<f64>],
    velocities: &[Vector3<f64>],
    regularization: f64,
    viscosity: f64,
) -> Vec<Vector3<f64>> {
    let count = nodes.len();
    let mut edges = Vec::new();
    let mut first = 0;
    for rod in rods {
        edges.extend(first..first + rod - 1);
        first += rod;
    }
    let mut matrix = DMatrix::zeros(3 * count, 3 * count);
    let mut lengths = vec![0.0; count];
    for &k in &edges {
        let (start, end) = (&nodes[k], &nodes[k + 1]);
        for length in &mut lengths[k..k + 2] {
            *length += 0.5 * (end - start).norm();
        }
        for (i, x) in nodes.iter().enumerate() {
            let [first, second] = adaptive_segment_integral(x, start, end, regularization);
            let mut near = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * k);
            near += first;
            let mut far = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * k + 3);
            far += second;
        }
    }
    let right_hand_side = DVector::from_iterator(
        3 * count,
        velocities
            .iter()
            .flat_map(|v| v.iter().copied().collect::<Vec<_>>()),
    ) * (8.0 * PI * viscosity);
    let densities = matrix
        .lu()
        .solve(&right_hand_side)
        .expect("the Stokeslet matrix is regular");
    (lengths.iter().enumerate())
        .map(|(i, length)| densities.fixed_rows::<3>(3 * i) * *length)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_integral_over_a_distant_segment_is_a_point_force() {
        let (start, end) = (Vector3::zeros(), Vector3::new(0.0, 1e-3, 0.0));
        let x = Vector3::new(3.0, 0.0005, -2.0);
        let [first, second] = adaptive_segment_integral(&x, &start, &end, 1e-3);
        // The centroids of the weights 1 − s/L and s/L are at a third and two thirds of the
        // segment.
        for (integral, centre) in [(first, 1.0 / 3.0), (second, 2.0 / 3.0)] {
            let point = regularized_stokeslet(&(x - start.lerp(&end, centre)), 1e-3) * 0.5e-3;
            assert!((integral - point).amax() < 1e-7 * point.amax());
        }
    }

    #[test]
    fn a_long_rod_feels_nearly_the_drag_of_a_spheroid() {
        // Prolate spheroid of semi-axes 1/2 and 1/100 and eccentricity e, towed along its axis with unit
        // speed in unit viscosity (Chwang & Wu 1975): 8π e³/((1 + e²) ln((1 + e)/(1 − e)) − 2e).
        let e = (1.0 - 0.02f64.powi(2)).sqrt();
        let spheroid =
            8.0 * PI * e.powi(3) / ((1.0 + e * e) * ((1.0 + e) / (1.0 - e)).ln() - 2.0 * e);
        let nodes: Vec<_> = (0..41)
            .map(|k| Vector3::x() * (f64::from(k) / 40.0))
            .collect();
        let along: f64 = forces(&nodes, &[Vector3::x(); 41], 1.02e-2, 1.0)
            .iter()
            .map(|f| f.x)
            .sum();
        assert!((along / spheroid - 1.0).abs() < 0.02, "{along}");
    }
}
