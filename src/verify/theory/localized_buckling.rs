//! The localised helical buckle of a long twisted rod whose ends approach each other.
//!
//! The homoclinic solution of van der Heijden & Thompson 2000 (Nonlinear Dynamics 21:71) for an
//! isotropic rod of infinite length. With m = M/(2 √(B T)), the angle φ between tangent and axis
//! satisfies (cos φ − cos φ₀)/(1 − cos φ₀) = tanh²(s/s*), cos φ₀ = 2 m² − 1, s* = √(B/T)/√(1 −
//! m²). Bergou et al. 2008 (Discrete elastic rods, sec. 8) compare a discrete rod with it.

use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};
use std::f64::consts::FRAC_1_SQRT_2;

/// Half the number of integration steps of the shape.
const HALF_STEPS: usize = 4000;

/// The buckle of a rod of given stiffness, length, end rotation and end shortening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalizedBuckle {
    /// Axial tension T, N.
    pub tension: f64,
    /// Twisting moment M about the axis, N m.
    pub moment: f64,
    /// Bending stiffness B, N m².
    pub bending: f64,
    /// Length of the rod, m.
    pub length: f64,
}

impl LocalizedBuckle {
    /// Solves the equations for the end shortening, D = √(16 B/T − 4 M²/T²), and the end rotation,
    /// R = M L/C + 4 acos m, for tension and moment. Of the two solutions, returns the stable one,
    /// which has the larger m.
    pub fn new(bending: f64, twisting: f64, length: f64, rotation: f64, shortening: f64) -> Self {
        let at = |m: f64| {
            let tension = 16.0 * bending * (1.0 - m * m) / shortening.powi(2);
            (tension, 2.0 * m * (bending * tension).sqrt())
        };
        let m = bisect(FRAC_1_SQRT_2, 1.0, |m| {
            at(m).1 * length / twisting + 4.0 * libm::acos(m) - rotation
        });
        let (tension, moment) = at(m);
        Self {
            tension,
            moment,
            bending,
            length,
        }
    }

    /// Dimensionless load m = M/(2 √(B T)).
    fn load(&self) -> f64 {
        self.moment / (2.0 * (self.bending * self.tension).sqrt())
    }

    /// cos φ₀ in the middle of the buckle.
    pub fn cosine_in_the_middle(&self) -> f64 {
        2.0 * self.load().powi(2) - 1.0
    }

    /// The envelope tanh²(s/s*) at arc length s from the middle.
    pub fn envelope(&self, s: f64) -> f64 {
        let decay = (self.tension / self.bending * (1.0 - self.load().powi(2))).sqrt();
        libm::tanh(s * decay).powi(2)
    }

    /// cos φ at arc length s from the middle.
    pub fn cosine(&self, s: f64) -> f64 {
        let middle = self.cosine_in_the_middle();
        middle + (1.0 - middle) * self.envelope(s)
    }

    /// Centreline at `nodes` equally spaced arc lengths from one end to the other, with the axis
    /// along x. The tangent of the centreline turns about the axis at the rate M/(B (1 + cos φ)).
    pub fn centreline(&self, nodes: usize) -> Vec<[f64; 3]> {
        let half = 0.5 * self.length;
        let path = runge_kutta(0.0, half, [0.0; 4], HALF_STEPS, |s, &[_, _, _, azimuth]| {
            let cosine = self.cosine(s);
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            let (sin, cos) = libm::sincos(azimuth);
            let turning = self.moment / (self.bending * (1.0 + cosine));
            [cosine, sine * cos, sine * sin, turning]
        });
        (0..nodes)
            .map(|k| {
                let s = self.length * k as f64 / (nodes - 1) as f64 - half;
                let place = (s.abs() / half * HALF_STEPS as f64).round() as usize;
                let [x, y, z, _] = path[place];
                // The azimuth is odd in s: half a turn about y maps one half onto the other.
                if s < 0.0 { [-x, -y, z] } else { [x, y, z] }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn bergou() -> LocalizedBuckle {
        LocalizedBuckle::new(1.345, 0.789, 9.29, 27.0 * TAU, 0.3)
    }

    #[test]
    fn tension_and_moment_give_the_shortening_and_the_rotation() {
        let LocalizedBuckle {
            tension, moment, ..
        } = bergou();
        let shortening = (16.0 * 1.345 / tension - (2.0 * moment / tension).powi(2)).sqrt();
        let m = moment / (2.0 * (1.345 * tension).sqrt());
        assert!((shortening - 0.3).abs() < 1e-12);
        assert!((moment * 9.29 / 0.789 + 4.0 * m.acos() - 27.0 * TAU).abs() < 1e-10);
    }

    #[test]
    fn the_shape_agrees_with_the_reference_solution() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../shared/reference/beams/localized_helical_buckling_bergou2008.csv"
        );
        let Ok(text) = std::fs::read_to_string(file) else {
            println!("skipped: {file} is not here");
            return;
        };
        let rows = text.lines().filter_map(|line| {
            let row: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
            row.ok()
        });
        let mut count = 0;
        for row in rows {
            assert!((bergou().cosine(row[0]) - row[2]).abs() < 1e-9);
            assert!((bergou().envelope(row[0]) - row[3]).abs() < 1e-9);
            count += 1;
        }
        assert!(count > 100);
    }

    #[test]
    fn the_centreline_is_shortened_as_asked_and_has_unit_speed() {
        let line = bergou().centreline(201);
        let chord = line[200][0] - line[0][0];
        // Since the length is finite, the tails of the envelope contribute a shortening of about
        // 1e-9.
        assert!((9.29 - chord - 0.3).abs() < 1e-8, "{chord}");
        let edge = |k: usize| -> f64 {
            let difference = std::array::from_fn::<f64, 3, _>(|i| line[k + 1][i] - line[k][i]);
            difference.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        for k in 0..200 {
            assert!(edge(k) < 9.29 / 200.0 * (1.0 + 1e-9) && edge(k) > 0.99 * 9.29 / 200.0);
        }
    }
}
