//! Checks that a lens model fits the observed corners. Residuals that depend on the distance from
//! the middle of the picture are not noise, but show a different kind of lens.

use super::Point;
use serde::Serialize;

/// Number of groups of corners by their distance from the principal point.
const GROUPS: usize = 10;
/// Smallest number of corners in each group.
const LEAST: usize = 8;
/// Mean of the squared radial errors of the groups, relative to their standard errors, above which
/// the model does not fit. For noise alone the mean is about 1, and exceeds this bound once in a
/// million calibrations.
const MOST: f64 = 4.5;

/// Radial errors of a lens model that noise does not explain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LensMisfit {
    /// Largest mean radial error of a group of corners, pixels.
    pub radial_error_px: f64,
    /// Mean distance of that group from the principal point, pixels.
    pub at_radius_px: f64,
    /// Mean of the squared errors of the groups, relative to their standard errors; about 1 if the
    /// model fits.
    pub excess: f64,
}

impl LensMisfit {
    /// Computes the misfit of a lens from its principal point and the observed corners, each with
    /// the residual of the model, pixels. `None` if noise explains the residuals, or there are too
    /// few corners.
    pub fn of(centre: Point, corners: &[(Point, Point)]) -> Option<Self> {
        let mut radial: Vec<(f64, f64)> = corners
            .iter()
            .map(|(corner, residual)| {
                let outwards = corner - centre;
                let radius = outwards.norm();
                (radius, residual.dot(&outwards) / radius.max(1e-9))
            })
            .collect();
        radial.sort_by(|a, b| a.0.total_cmp(&b.0));
        let groups = GROUPS.min(radial.len() / LEAST);
        if groups < 3 {
            return None;
        }
        let (mut excess, mut largest) = (0.0, (0.0, 0.0));
        for group in 0..groups {
            let ends = [group, group + 1].map(|k| k * radial.len() / groups);
            let members = &radial[ends[0]..ends[1]];
            let count = members.len() as f64;
            let mean = members.iter().map(|(_, error)| error).sum::<f64>() / count;
            let square: f64 = members
                .iter()
                .map(|(_, error)| (error - mean).powi(2))
                .sum();
            let variance = (square / (count - 1.0) / count).max(ROUNDING * ROUNDING);
            excess += mean * mean / variance / groups as f64;
            if mean.abs() > largest.1 {
                let radius = members.iter().map(|(radius, _)| radius).sum::<f64>() / count;
                largest = (radius, mean.abs());
            }
        }
        (excess > MOST).then_some(Self {
            radial_error_px: largest.1,
            at_radius_px: largest.0,
            excess,
        })
    }

    /// Factor that corrects standard deviations that were computed as if all errors were noise.
    pub fn inflation(&self) -> f64 {
        self.excess.sqrt()
    }
}

/// Rounding errors, pixels.
const ROUNDING: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::super::trace_tests::Dice;
    use super::*;

    /// Corners on a grid with a reproducible noise of about 0.05 pixels, and a radial error.
    fn corners(radial: impl Fn(f64) -> f64) -> Vec<(Point, Point)> {
        let mut dice = Dice(1);
        let mut noise = || 0.1 * (dice.roll() - 0.5) * 1.7;
        let mut found = Vec::new();
        for u in 0..30 {
            for v in 0..20 {
                let corner = Point::new(25.0 * f64::from(u), 25.0 * f64::from(v));
                let outwards = corner - CENTRE;
                let error = outwards.normalize() * radial(outwards.norm());
                found.push((corner, error + Point::new(noise(), noise())));
            }
        }
        found
    }

    const CENTRE: Point = Point::new(370.0, 240.0);

    #[test]
    fn noise_is_not_a_misfit_but_a_radial_wave_is() {
        assert_eq!(LensMisfit::of(CENTRE, &corners(|_| 0.0)), None);
        let wave = |radius: f64| 0.1 * libm::sin(radius / 50.0);
        let misfit = LensMisfit::of(CENTRE, &corners(wave)).expect("a misfit");
        assert!((0.05..0.12).contains(&misfit.radial_error_px), "{misfit:?}");
        assert!(misfit.inflation() > 3.0, "{misfit:?}");
        assert_eq!(LensMisfit::of(CENTRE, &corners(wave)[..20]), None);
    }
    /// Errors e outwards in noise of the deviation σ: means of the n corners of a group are σ/√n accurate, and e is so many of
    /// these. An error at some radius is found there.
    #[test]
    fn an_error_is_measured_in_the_noise_of_its_group_and_located() {
        let error = 0.05;
        let noise = 0.17 / 12.0_f64.sqrt();
        let misfit = LensMisfit::of(CENTRE, &corners(|_| error)).expect("a misfit");
        let expected = error / (noise / 60.0_f64.sqrt());
        assert!(
            (misfit.inflation() / expected - 1.0).abs() < 0.1,
            "{} {expected}",
            misfit.inflation()
        );
        let bump = |radius: f64| 0.3 * libm::exp(-((radius - 150.0) / 30.0).powi(2));
        let misfit = LensMisfit::of(CENTRE, &corners(bump)).expect("a misfit");
        assert!(
            (misfit.at_radius_px - 150.0).abs() < 20.0,
            "{}",
            misfit.at_radius_px
        );
    }
}
