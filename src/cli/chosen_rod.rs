//! The default preset rod for a pattern.

use super::prelude::*;
use crate::presets::Preset;
use rodlab_lab::experiment::RodFile;

/// Length of a rod that is not laid, in gravito-bending lengths: the part that hangs from the
/// gripper at the end, and the straight start.
const BESIDE_PATTERN: f64 = 4.0;

/// A preset rod.
struct PresetRod {
    name: &'static str,
    file: PathBuf,
    length: f64,
    gravito_bending_length: f64,
}

/// Returns the file of the softest preset rod that is long enough for a pattern of a given length,
/// m, or else of the longest preset rod. Soft rods follow tight curves.
///
/// # Errors
/// The presets cannot be unpacked.
pub fn rod_for(pattern: f64) -> Result<PathBuf, Failure> {
    let rods = preset_rods()?;
    let is_long =
        |rod: &&PresetRod| rod.length >= pattern + BESIDE_PATTERN * rod.gravito_bending_length;
    let softest = least(rods.iter().filter(is_long), |rod| {
        rod.gravito_bending_length
    });
    let reason = match softest {
        Some(_) => "the softest preset that is long enough for a pattern of",
        None => "the longest preset, for a pattern of",
    };
    let longest = || least(rods.iter(), |rod| -rod.length);
    Ok(chosen(softest.or_else(longest), reason, pattern))
}

/// Returns the file of the longest preset rod that is shorter than the pattern of a knot with the
/// given length, m. The rest of the pattern is the path of the rod's end.
///
/// # Errors
/// The presets cannot be unpacked.
pub fn rod_for_knot(pattern: f64) -> Result<PathBuf, Failure> {
    let rods = preset_rods()?;
    let shorter = rods.iter().filter(|rod| rod.length < pattern);
    let longest = least(shorter, |rod| -rod.length);
    let reason = match longest {
        Some(_) => "the longest preset that is shorter than its pattern of",
        None => "the shortest preset, for a pattern of",
    };
    let shortest = || least(rods.iter(), |rod| rod.length);
    Ok(chosen(longest.or_else(shortest), reason, pattern))
}

fn preset_rods() -> Result<Vec<PresetRod>, Failure> {
    let mut rods = Vec::new();
    for preset in Preset::of_kind(PresetKind::Rod) {
        let file = preset.file().map_err(Failure::system)?;
        // Rods of other tasks have no [deployment.rod].
        if let Ok(read) = RodFile::read(&file) {
            rods.push(PresetRod {
                name: preset.name,
                file,
                length: read.rod.length,
                gravito_bending_length: read.rod.gravito_bending_length,
            });
        }
    }
    Ok(rods)
}

fn least<'a>(
    rods: impl Iterator<Item = &'a PresetRod>,
    by: impl Fn(&PresetRod) -> f64,
) -> Option<&'a PresetRod> {
    rods.min_by(|one, other| by(one).total_cmp(&by(other)))
}

/// Returns the file of the chosen rod, and logs the choice with its reason.
fn chosen(rod: Option<&PresetRod>, reason: &str, pattern: f64) -> PathBuf {
    let rod = rod.expect("there are preset rods");
    tracing::warn!(
        "no --rod: using `{}` ({:.2} m long), {reason} {pattern:.2} m",
        rod.name,
        rod.length
    );
    rod.file.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_softest_rod_that_is_long_enough_is_chosen() {
        // No rod is long enough for 2 m; the rope is the longest.
        for (pattern, expected) in [(0.3, "pink_vps"), (2.0, "rope")] {
            let file = rod_for(pattern).unwrap();
            assert_eq!(file.file_stem().unwrap(), expected, "{pattern} m");
        }
    }

    #[test]
    fn the_longest_rod_that_leaves_a_path_for_its_end_is_chosen_for_a_knot() {
        // No rod is shorter than 0.3 m; the cord is the shortest.
        for (pattern, expected) in [
            (1.0, "rope"),
            (0.86, "thick_pink_vps"),
            (0.3, "silicone_cord"),
        ] {
            let file = rod_for_knot(pattern).unwrap();
            assert_eq!(file.file_stem().unwrap(), expected, "{pattern} m");
        }
    }
}
