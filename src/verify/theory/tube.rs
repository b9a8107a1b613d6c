//! A heavy rod pushed into a horizontal tube. The rod has the angle θ(x) in the tube, the bending
//! stiffness EI, the weight w per length and the clearance r. Lengths are in units of (EI r/w)^¼,
//! and the push f is in units of √(EI w/r). For small slopes, the difference between its energy and
//! that of the straight rod under the same push, per length and divided by w r, is
//!
//! ```text
//! e = ½ θ″² + ½ θ′⁴ − ½ f θ′² + 1 − cos θ
//! ```

use rodlab_engine::mechanics::kirchhoff::numerics::bisect;

/// Push at which the straight rod begins to snake (Dawson and Paslay 1984). The snake θ = a sin kx
/// has the energy e = ¼ a² (k⁴ − f k² + 1), which first becomes negative for k = 1 and f = 2.
pub const SNAKE: f64 = 2.0;

/// Push at which a uniform helix, θ = kx, has the energy of the straight rod (Chen, Lin and
/// Cheatham 1990). The energy e = ½ k⁴ − ½ f k² + 1 first becomes zero for k⁴ = 2 and f = 2√2.
pub const EVEN_HELIX: f64 = 2.0 * std::f64::consts::SQRT_2;

/// Push at which a helix, θ = kx + a sin kx, has the energy of the straight rod. The helix has the
/// wave number k and turns faster near the top. To second order in a
///
/// ```text
/// e = ½ k⁴ − ½ f k² + 1 + ½ a + q a²,     q = (7 k⁴ − f k²)/4
/// ```
///
/// The energy is least for a = −1/4q, which reduces it by 1/16q.
pub fn uneven_helix(wave_number: f64) -> f64 {
    let square = wave_number * wave_number;
    bisect(2.0, 4.0, |push| {
        let stiffness = 0.25 * square * (7.0 * square - push);
        0.5 * square * (square - push) + 1.0 - 1.0 / (16.0 * stiffness)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// The mean energy of θ = kx + a sin kx over a turn.
    fn energy(wave_number: f64, uneven: f64, push: f64) -> f64 {
        const POINTS: usize = 400;
        let of = |point: usize| {
            let phase = TAU * (point as f64 + 0.5) / POINTS as f64;
            let (sine, cosine) = libm::sincos(phase);
            let slope = wave_number * (1.0 + uneven * cosine);
            let bend = -wave_number * wave_number * uneven * sine;
            0.5 * bend * bend + 0.5 * slope.powi(4) - 0.5 * push * slope * slope + 1.0
                - libm::cos(phase + uneven * sine)
        };
        (0..POINTS).map(of).sum::<f64>() / POINTS as f64
    }

    #[test]
    fn helices_have_no_energy_at_their_pushes() {
        let wave_number = libm::pow(2.0, 0.25);
        assert!(energy(wave_number, 0.0, EVEN_HELIX).abs() < 1e-12);
        for beside in [0.9, 1.1] {
            assert!(energy(beside * wave_number, 0.0, EVEN_HELIX) > 0.01);
            let push = uneven_helix(beside * wave_number);
            let least = (-200..0).map(|k| energy(beside * wave_number, 1e-3 * f64::from(k), push));
            let least = least.fold(f64::INFINITY, f64::min);
            // The remainder is of fourth order in a.
            assert!(least.abs() < 1e-3, "{least}");
        }
        assert!(uneven_helix(wave_number) < EVEN_HELIX);
    }
}
