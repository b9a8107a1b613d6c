//! The preset rod for a pattern, where none is named.

use super::prelude::*;
use crate::presets::Preset;
use rodlab_lab::experiment::RodFile;

/// Length of a rod that is not laid, in gravito-bending lengths: what hangs from the gripper at the end, and a straight start.
const BESIDE_PATTERN: f64 = 4.0;

/// The file of the softest of the preset rods that is long enough for a pattern of a length, m; of the longest where none is. Soft rods
/// follow tight curves.
///
/// # Errors
/// The presets cannot be unpacked.
pub fn rod_for(pattern: f64) -> Result<PathBuf, Failure> {
    let mut rods = Vec::new();
    for preset in Preset::of_kind(PresetKind::Rod) {
        let file = preset.file().map_err(Failure::system)?;
        // Rods of other tasks have no [deployment.rod].
        if let Ok(read) = RodFile::read(&file) {
            rods.push((preset, file, read.rod));
        }
    }
    rods.sort_by(|(.., one), (.., other)| {
        let [one, other] = [one, other].map(|rod| rod.gravito_bending_length);
        one.total_cmp(&other)
    });
    let is_long = |length: f64, hanging: f64| length >= pattern + BESIDE_PATTERN * hanging;
    let fitting = rods
        .iter()
        .position(|(.., rod)| is_long(rod.length, rod.gravito_bending_length));
    let longest = || {
        let lengths = rods.iter().enumerate();
        let longest =
            lengths.max_by(|(_, (.., one)), (_, (.., other))| one.length.total_cmp(&other.length));
        longest.map(|(index, _)| index)
    };
    let index = fitting.or_else(longest).expect("there are preset rods");
    let (preset, file, rod) = rods.swap_remove(index);
    let reason = match fitting {
        Some(_) => "the softest preset that is long enough",
        None => "the longest preset",
    };
    tracing::warn!(
        "no --rod: `{}` ({:.2} m long) is taken, {reason} for a pattern of {pattern:.2} m",
        preset.name,
        rod.length
    );
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_softest_rod_that_is_long_enough_is_chosen() {
        // Nothing is long enough for 2 m; the rope is the longest.
        for (pattern, expected) in [(0.3, "pink_vps"), (2.0, "rope")] {
            let file = rod_for(pattern).unwrap();
            assert_eq!(file.file_stem().unwrap(), expected, "{pattern} m");
        }
    }
}
