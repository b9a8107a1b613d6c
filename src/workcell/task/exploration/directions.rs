//! Lists of unit directions (κ, τ, ω).

use rodlab_robot::{TableError, read_table};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// Largest number of directions of a list.
const MOST: usize = 100_000;
/// Least κ of a unit direction. A straight rod carries a force that depends on its stretch only,
/// and clamps cannot set the stretch exactly enough.
const LEAST_CURVATURE: f64 = 1e-3;

/// Reads directions from a table with the columns `kappa`, `tau` and `omega`, and returns unit
/// vectors. A row may have any length except zero. Other columns are ignored. `boundary.csv` of
/// the experiment `helix-stability` is such a table.
///
/// # Errors
/// A column is missing, a number is invalid, a direction has no length or no curvature, or the
/// number of directions is zero or too large.
pub fn read_directions(path: &Path) -> Result<Vec<[f64; 3]>, TableError> {
    let fault = |line: Option<u64>, message: String| TableError {
        path: path.to_owned(),
        line,
        message,
    };
    let table = read_table(path)?;
    let mut columns = [0; 3];
    for (slot, name) in columns.iter_mut().zip(["kappa", "tau", "omega"]) {
        let found = table.header.iter().position(|header| header == name);
        *slot = found.ok_or_else(|| {
            fault(
                Some(1),
                format!("no column `{name}`; needed: kappa, tau, omega"),
            )
        })?;
    }
    if table.rows.is_empty() || table.rows.len() > MOST {
        let count = table.rows.len();
        return Err(fault(
            None,
            format!("{count} directions; allowed: 1 to {MOST}"),
        ));
    }
    let rows = table.rows.iter().zip(&table.lines);
    rows.map(|(row, line)| {
        let direction = columns.map(|column| row[column]);
        let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !(length > 1e-9 && length.is_finite()) {
            return Err(fault(
                Some(*line),
                "a direction needs a length above 0".into(),
            ));
        }
        let direction = direction.map(|part| part / length);
        if direction[0] < LEAST_CURVATURE {
            return Err(fault(
                Some(*line),
                format!(
                    "`kappa` is {} of the direction's length, but must be {LEAST_CURVATURE} or \
                     more: the clamps of a straight rod do not determine its tension",
                    direction[0]
                ),
            ));
        }
        Ok(direction)
    })
    .collect()
}

/// Evenly spread directions with κ > 0 and τ > 0, as in the thesis, in which (κ, −τ, −ω) is the
/// mirror image of (κ, τ, ω).
///
/// To cover equal areas, the height κ is uniformly distributed, and the angle about its axis
/// follows the golden section.
pub fn quarter_sphere(count: usize) -> Vec<[f64; 3]> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let direction = |k: usize| {
        let kappa = 1.0 - (k as f64 + 0.5) / count as f64;
        let across = (1.0 - kappa * kappa).sqrt();
        let (sine, cosine) = libm::sincos(PI * ((k as f64 + 0.5) * golden).fract() - FRAC_PI_2);
        [kappa, across * cosine, across * sine]
    };
    (0..count).map(direction).collect()
}

/// Directions with ω = 0, κ > 0 and τ > 0, at even angles.
pub fn section(count: usize) -> Vec<[f64; 3]> {
    let direction = |k: usize| {
        let (sine, cosine) = libm::sincos(FRAC_PI_2 * (k as f64 + 0.5) / count as f64);
        [sine, cosine, 0.0]
    };
    (0..count).map(direction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_evenly_spread_over_the_quarter_sphere() {
        let directions = quarter_sphere(328);
        for [kappa, tau, omega] in &directions {
            assert!((kappa * kappa + tau * tau + omega * omega - 1.0).abs() < 1e-12);
            assert!(*kappa > 0.0 && *tau > 0.0);
        }
        // The mean of a quarter of a sphere is (1/2, 1/2, 0).
        let mean = [0, 1, 2].map(|k| directions.iter().map(|d| d[k]).sum::<f64>() / 328.0);
        assert!(
            (mean[0] - 0.5).abs() < 1e-3 && (mean[1] - 0.5).abs() < 5e-3,
            "{mean:?}"
        );
        assert!(mean[2].abs() < 5e-3, "{mean:?}");
        // No two directions are close: the spacing of as many points on a square grid would be
        // 0.098.
        let near = |k: usize, other: usize| {
            let pairs = directions[k].iter().zip(&directions[other]);
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let least = (0..328).flat_map(|k| (0..k).map(move |other| near(k, other)));
        assert!(least.fold(f64::INFINITY, f64::min) > 0.04);
    }

    #[test]
    fn faults_of_a_list_name_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("list.csv");
        for (text, words) in [
            ("kappa,tau\n1,0\n", "no column `omega`"),
            ("kappa,tau,omega\n", "0 directions"),
            (
                "kappa,tau,omega\n1,0,0\n0,0,0\n",
                ":3: a direction needs a length",
            ),
            ("kappa,tau,omega\n-1,0,0\n", ":2: `kappa` is -1 "),
            ("kappa,tau,omega\n1,x,0\n", "not a finite number"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = read_directions(&path).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        std::fs::write(&path, "kappa,tau,omega,why\n3,0,4,1\n").unwrap();
        assert_eq!(read_directions(&path).unwrap(), [[0.6, 0.0, 0.8]]);
    }
}
