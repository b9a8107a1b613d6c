//! A slender filament that swims by waves of its natural curvature in viscous fluid, for small
//! amplitudes and a finite length.
//!
//! A filament along x with the bending stiffness B and the natural curvature Re K e^{i(kx − ωt)}
//! moves transversely by y = Re Y(x) e^{−iωt}. The drag per length, ζ_⊥ ẏ, balances elasticity:
//!
//! ```text
//! −iω ζ_⊥ Y + B (Y'' − K e^{ikx})'' = 0,     Y'' = K e^{ikx} and Y''' = ik K e^{ikx} at both free ends
//! ```
//!
//! The solution is the forced wave P e^{ikx}, P (B k⁴ − iω ζ_⊥) = −B k² K, and four free waves
//! e^{βx}, β⁴ = iω ζ_⊥/B. To second order, the force of the fluid along x per length is −ζ_∥ ẋ +
//! (ζ_⊥ − ζ_∥) ẏ y'. Since the total force on the filament vanishes, it swims with the velocity
//!
//! ```text
//! U = (ζ_⊥/ζ_∥ − 1) 1/L ∫ ⟨ẏ y'⟩ dx,     ⟨ẏ y'⟩ = ½ Re(−iω Y Y'*)
//! ```
//!
//! averaged over a cycle. The wave y = b sin(kx − ωt) alone gives −½ (ζ_⊥/ζ_∥ − 1) b² kω (Gray and
//! Hancock 1955).

use nalgebra::{Complex, Matrix4, Vector4};

/// A filament and its wave.
#[derive(Clone, Copy, Debug)]
pub struct Swimmer {
    /// L, m.
    pub length: f64,
    /// B, N m².
    pub bending_stiffness: f64,
    /// ζ_⊥, N s/m².
    pub drag_across: f64,
    /// ζ_∥, N s/m².
    pub drag_along: f64,
    /// K, 1/m.
    pub curvature: f64,
    /// k, rad/m.
    pub wave_number: f64,
    /// ω, rad/s.
    pub angular_frequency: f64,
}

/// Number of intervals of the quadrature over the length; must be even.
const PIECES: usize = 2000;

impl Swimmer {
    /// Swimming speed U, m/s; positive in the direction of the wave. `None` if the free waves
    /// cannot satisfy the end conditions.
    pub fn speed(&self) -> Option<f64> {
        let i = Complex::i();
        let (k, omega) = (self.wave_number, self.angular_frequency);
        let stiffness = self.bending_stiffness;
        let drag = i * (omega * self.drag_across);
        let forced = Complex::from(-stiffness * k * k * self.curvature)
            / (Complex::from(stiffness * k.powi(4)) - drag);
        let root = (drag / stiffness).powf(0.25);
        let roots = [root, i * root, -root, -i * root];
        // Each free wave is scaled to 1 at the end at which it is largest.
        let free = |beta: Complex<f64>, x: f64| {
            let from = if beta.re > 0.0 { self.length } else { 0.0 };
            (beta * (x - from)).exp()
        };
        let rows = [(0.0, 2), (0.0, 3), (self.length, 2), (self.length, 3)];
        let matrix = Matrix4::from_fn(|row, column| {
            let (x, order) = rows[row];
            roots[column].powi(order) * free(roots[column], x)
        });
        let right = Vector4::from_fn(|row, _| {
            let (x, order) = rows[row];
            let natural = Complex::from(self.curvature) * (i * k).powi(order - 2);
            (natural - forced * (i * k).powi(order)) * (i * k * x).exp()
        });
        // Rows of third derivatives are larger by the factor |β|.
        let scales = [1.0, root.norm()].map(|scale| 1.0 / scale);
        let scale = |row: usize| Complex::from(scales[row % 2]);
        let matrix = Matrix4::from_fn(|row, column| matrix[(row, column)] * scale(row));
        let right = Vector4::from_fn(|row, _| right[row] * scale(row));
        let amplitudes = matrix.lu().solve(&right)?;
        let wave = |x: f64, order: i32| {
            let free: Complex<f64> = (roots.iter().zip(&amplitudes))
                .map(|(&beta, amplitude)| amplitude * beta.powi(order) * free(beta, x))
                .sum();
            free + forced * (i * k).powi(order) * (i * k * x).exp()
        };
        let product = |x: f64| 0.5 * (-i * omega * wave(x, 0) * wave(x, 1).conj()).re;
        let step = self.length / PIECES as f64;
        let simpson = |piece: usize| match piece {
            0 | PIECES => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let sum: f64 = (0..=PIECES)
            .map(|piece| simpson(piece) * product(piece as f64 * step))
            .sum();
        let mean = sum * step / 3.0 / self.length;
        Some((self.drag_across / self.drag_along - 1.0) * mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_do_not_matter_for_many_waves() {
        let filament = |waves: f64| Swimmer {
            length: 0.04 * waves,
            bending_stiffness: 8e-7,
            drag_across: 13.0,
            drag_along: 8.0,
            curvature: 8.0,
            wave_number: std::f64::consts::TAU / 0.04,
            angular_frequency: 6.0,
        };
        let Swimmer {
            bending_stiffness,
            drag_across,
            curvature,
            wave_number: k,
            angular_frequency: omega,
            ..
        } = filament(1.0);
        let elastic = bending_stiffness * k.powi(4);
        let squared = (elastic * curvature / (k * k)).powi(2)
            / (elastic * elastic + (omega * drag_across).powi(2));
        let endless = -0.5 * (13.0 / 8.0 - 1.0) * squared * k * omega;
        let off = |waves: f64| filament(waves).speed().unwrap() / endless - 1.0;
        println!("{} {} {}", off(2.5), off(25.0), off(50.0));
        // The effect of the ends does not depend on the length of the filament.
        assert!(off(50.0).abs() < 0.05 && off(2.5).abs() > 0.05);
        assert!((off(25.0) / off(50.0) - 2.0).abs() < 0.05);
    }
}
