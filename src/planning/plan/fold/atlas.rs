//! Gentle folds all over the workspace, as initial guesses for Newton's method.
//!
//! They are the same for every sheet and take longer to find than any later computation. The
//! program therefore contains them as a table, `atlas.npy`: a NumPy array with a row for each
//! fold. [`FoldAtlas::search`] finds them; a test compares both.

use super::FoldError;
use super::equilibrium::{Fold, between};
use super::search_all::{differ, folds_at};
use rodlab_engine::mechanics::kirchhoff::elastica::Forces;

/// The table.
const TABLE: &[u8] = include_bytes!("atlas.npy");
/// Length of its header, bytes.
const HEADER: usize = 128;
/// Numbers in a row: x̄, z̄, α, l̄_s, H, V and the moment.
const COLUMNS: usize = 7;

/// Suspended lengths of the folds, L_gb: the first and the last, and the ratio of successive
/// lengths.
const LENGTHS: [f64; 2] = [0.1, Fold::LONGEST];
const GROWTH: f64 = 1.15;
/// Angle between neighbours, rad.
const ANGLE: f64 = 0.1;
/// Smallest ratio of successive angles.
const SHORTEST: f64 = 1e-3;
/// Largest pull H l̄_s².
const LARGEST_PULL: f64 = 100.0;
/// Largest differences of two neighbours: ln l̄_s, α, V l̄_s².
const FARTHEST: [f64; 3] = [0.3, 0.4, 6.0];
/// Number of neighbours from which a fold is searched.
const STARTS: usize = 6;
/// Maximum number of steps to a point if a single step fails.
const MOST_PARTS: usize = 64;

/// Folds by suspended length and angle.
#[derive(Clone, Debug)]
pub struct FoldAtlas {
    folds: Vec<Fold>,
}

impl FoldAtlas {
    /// The folds of the table.
    pub fn new() -> Self {
        let (numbers, _) = TABLE[HEADER..].as_chunks();
        let numbers: Vec<f64> = numbers.iter().copied().map(f64::from_le_bytes).collect();
        let (rows, _) = numbers.as_chunks::<COLUMNS>();
        let fold =
            |&[x, z, angle, suspended_length, horizontal, vertical, moment]: &[f64; COLUMNS]| {
                Fold {
                    gripper: [x, z],
                    angle,
                    suspended_length,
                    forces: Forces {
                        horizontal,
                        vertical,
                    },
                    moment,
                }
            };
        Self {
            folds: rows.iter().map(fold).collect(),
        }
    }

    /// Finds the folds of the table. For each suspended length the search starts at the fold
    /// without a push along the table. The search continues to smaller angles until the sheet is
    /// pulled taut, and to larger ones until the edge is back on the table.
    pub fn search() -> Self {
        let mut folds = vec![];
        let mut length = LENGTHS[0];
        let mut freely = Fold::just_lifted(length);
        while let Some(free) = freely {
            folds.push(free);
            for direction in [-1.0, 1.0] {
                // The longest sheets turn over before they reach the table.
                let stable = |fold: &Fold| fold.unstable_modes() == 0;
                folds.extend(angles_from(free, direction).take_while(stable));
            }
            if length >= LENGTHS[1] {
                break;
            }
            let next = (GROWTH * length).min(LENGTHS[1]);
            freely = lengthened(free, next);
            length = next;
        }
        Self { folds }
    }

    /// The gentle fold at a gripper position.
    ///
    /// # Errors
    /// The workspace has no such fold.
    pub fn solve(&self, gripper: [f64; 2]) -> Result<Fold, FoldError> {
        let [x, z] = gripper;
        // The difference is relative, because short folds are similar to each other.
        let distance = |fold: &Fold| {
            let [other_x, other_z] = fold.gripper;
            libm::hypot(x - other_x, z - other_z) / libm::hypot(other_x, other_z)
        };
        let mut nearest: Vec<(f64, &Fold)> = self
            .folds
            .iter()
            .map(|fold| (distance(fold), fold))
            .collect();
        nearest.select_nth_unstable_by(STARTS, |one, other| one.0.total_cmp(&other.0));
        nearest.truncate(STARTS);
        nearest.sort_by(|one, other| one.0.total_cmp(&other.0));
        let found = nearest
            .iter()
            .find_map(|(_, near)| solve_from(near, gripper));
        found.ok_or(FoldError::Unreachable {
            gripper,
            nearest: nearest[0].1.gripper,
        })
    }

    /// All folds found at a gripper position, the gentle one first if it exists.
    ///
    /// # Errors
    /// The workspace has no such fold.
    pub fn solve_all(&self, gripper: [f64; 2]) -> Result<Vec<Fold>, FoldError> {
        let gentle = self.solve(gripper);
        let others = folds_at(gripper).into_iter();
        let others = others
            .filter(|fold| gentle.is_ok_and(|gentle| differ(fold, &gentle)) || gentle.is_err());
        let folds: Vec<Fold> = gentle.iter().copied().chain(others).collect();
        match (folds.is_empty(), gentle) {
            (true, Err(error)) => Err(error),
            _ => Ok(folds),
        }
    }

    /// A sheet that is lifted without a push along the table, from nearly flat to a suspended
    /// length, in equal steps of the length.
    pub fn lift(longest: f64, steps: usize) -> Vec<Fold> {
        let length = |step: usize| longest * step as f64 / steps as f64;
        let mut lift: Vec<Fold> = vec![];
        for step in 1..=steps {
            let next = match lift.last() {
                Some(last) => lengthened(*last, length(step)),
                None => Fold::just_lifted(length(step)),
            };
            lift.extend(next);
        }
        lift
    }

    /// All folds.
    pub fn folds(&self) -> &[Fold] {
        &self.folds
    }
}

impl Default for FoldAtlas {
    fn default() -> Self {
        Self::new()
    }
}

/// The gentle fold at a gripper position, found from another fold in as many steps as needed.
pub fn solve_from(start: &Fold, gripper: [f64; 2]) -> Option<Fold> {
    in_parts(start, gripper, MOST_PARTS, |fold, place| {
        Fold::at(place, fold).filter(|next| is_near(next, fold))
    })
}

/// A fold at another gripper position, found in one step or, if that fails, in ever smaller steps.
pub(super) fn in_parts(
    start: &Fold,
    gripper: [f64; 2],
    most: usize,
    step: impl Fn(&Fold, [f64; 2]) -> Option<Fold>,
) -> Option<Fold> {
    let counts = std::iter::successors(Some(1_usize), |parts| Some(4 * parts));
    let mut counts = counts.take_while(|parts| *parts <= most);
    counts.find_map(|parts| {
        (1..=parts).try_fold(*start, |fold, part| {
            step(
                &fold,
                between(start.gripper, gripper, part as f64 / parts as f64),
            )
        })
    })
}

/// The fold without a push with a larger suspended length.
pub(super) fn lengthened(fold: Fold, length: f64) -> Option<Fold> {
    const STEP: f64 = 0.1;
    let mut free = fold;
    while free.suspended_length < length {
        let next = (free.suspended_length + STEP).min(length);
        let small = next < 1.0;
        free = if small {
            Fold::just_lifted(next)?
        } else {
            Fold::without_push(next, free.forces)?
        };
    }
    Some(free)
}

/// Folds of one suspended length, starting at the one without a push. With direction -1 the angles
/// decrease until the sheet is pulled taut; with 1 they increase until the edge is back on the
/// table, and the last fold is beyond.
pub(super) fn angles_from(free: Fold, direction: f64) -> impl Iterator<Item = Fold> {
    Angles {
        last: free,
        before: free,
        direction,
        step: ANGLE,
    }
}

/// Folds of one suspended length at successive angles.
struct Angles {
    last: Fold,
    before: Fold,
    direction: f64,
    step: f64,
}

impl Iterator for Angles {
    type Item = Fold;

    fn next(&mut self) -> Option<Fold> {
        let (last, before) = (self.last, self.before);
        // The steps decrease towards zero, where the forces grow without bound.
        let largest = if self.direction < 0.0 {
            ANGLE.min(0.2 * last.angle)
        } else {
            ANGLE
        };
        let mut step = largest.min(2.0 * self.step);
        while step > SHORTEST * largest {
            let angle = last.angle + self.direction * step;
            let done = last.angle - before.angle;
            let ratio = if done == 0.0 {
                0.0
            } else {
                (angle - last.angle) / done
            };
            let guess = last.forces.towards(&before.forces, -ratio);
            let fold = Fold::at_angle(last.suspended_length, angle, guess);
            if let Some(fold) = fold.filter(|fold| is_near(fold, &last)) {
                let pull = fold.forces.horizontal * fold.suspended_length.powi(2);
                if last.gripper[1] < 0.0 || pull > LARGEST_PULL {
                    return None;
                }
                (self.before, self.last, self.step) = (last, fold, step);
                return Some(fold);
            }
            step *= 0.5;
        }
        None
    }
}

/// Whether a fold may belong to the same family as another: their length, angle and forces are
/// close.
pub(super) fn is_near(fold: &Fold, last: &Fold) -> bool {
    let length = libm::log(fold.suspended_length / last.suspended_length).abs();
    let turn = (fold.angle - last.angle).abs();
    let unit = last.suspended_length.powi(2);
    let vertical = unit * (fold.forces.vertical - last.forces.vertical).abs();
    length < FARTHEST[0] && turn < FARTHEST[1] && vertical < FARTHEST[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;

    /// The table of the folds that were found.
    fn table(folds: &[Fold]) -> Vec<u8> {
        let shape = format!("({}, {COLUMNS})", folds.len());
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        let magic = b"\x93NUMPY\x01\x00";
        let length = HEADER - magic.len() - 2;
        let mut table = magic.to_vec();
        table.extend((length as u16).to_le_bytes());
        table.extend(format!("{header:<width$}\n", width = length - 1).into_bytes());
        for fold in folds {
            let [x, z] = fold.gripper;
            let Forces {
                horizontal,
                vertical,
            } = fold.forces;
            let row = [
                x,
                z,
                fold.angle,
                fold.suspended_length,
                horizontal,
                vertical,
                fold.moment,
            ];
            table.extend(row.iter().flat_map(|number| number.to_le_bytes()));
        }
        table
    }

    /// `RODLAB_WRITE_TABLES=1` writes the table.
    #[test]
    fn the_table_holds_the_folds_that_are_found() {
        let found = table(FoldAtlas::search().folds());
        if std::env::var_os("RODLAB_WRITE_TABLES").is_some() {
            let place = concat!(env!("CARGO_MANIFEST_DIR"), "/plan/fold/atlas.npy");
            std::fs::write(place, &found).unwrap();
            return;
        }
        assert_eq!(found[..HEADER], TABLE[..HEADER]);
        let numbers = |table: &[u8]| {
            let (numbers, rest) = table[HEADER..].as_chunks();
            assert!(rest.is_empty());
            numbers
                .iter()
                .copied()
                .map(f64::from_le_bytes)
                .collect::<Vec<f64>>()
        };
        for (found, kept) in numbers(&found).iter().zip(numbers(TABLE)) {
            assert!(
                (found - kept).abs() <= 1e-9 * kept.abs().max(1.0),
                "{found} {kept}"
            );
        }
    }

    fn off(fold: &Fold, row: &[f64]) -> f64 {
        let found = [fold.force_ratio(), fold.angle, fold.suspended_length];
        let pairs = found.iter().zip(&row[2..5]);
        pairs.fold(0.0, |most: f64, (found, row)| {
            most.max((found - row).abs() / row.abs().max(1.0))
        })
    }

    /// If the reference is not the gentle solution, it is unstable and among all folds.
    #[test]
    fn folds_agree_with_the_reference() {
        let atlas = FoldAtlas::new();
        let mut others = 0;
        // x̄, z̄, λ, α, l̄_s, H, V.
        for row in reference::rows("folding/folding_manifold.csv") {
            let gripper = [row[0], row[1]];
            let gentle = atlas.solve(gripper).unwrap();
            assert_eq!(gentle.unstable_modes(), 0, "{gentle:?}");
            if off(&gentle, &row) > 1e-6 {
                others += 1;
                let all = atlas.solve_all(gripper).unwrap();
                let found = all.iter().find(|fold| off(fold, &row) < 1e-6);
                let found = found.unwrap_or_else(|| panic!("{row:?} is not among {all:?}"));
                assert!(found.unstable_modes() > 0, "{found:?}");
            }
        }
        assert!(others < 12, "{others}");
    }

    /// In L_gb: a beam that is lifted at its end without a horizontal force has z̄ = l̄⁴/48 and α = l̄³/24.
    #[test]
    fn a_sheet_lifted_a_little_is_a_beam() {
        let fold = Fold::just_lifted(0.2).unwrap();
        assert!((fold.gripper[1] - 0.2f64.powi(4) / 48.0).abs() < 1e-10);
        assert!((fold.angle - 0.2f64.powi(3) / 24.0).abs() < 1e-9);
        let found = FoldAtlas::new().solve(fold.gripper).unwrap();
        assert!((found.suspended_length - 0.2).abs() < 1e-8, "{found:?}");
    }

    /// The table force |V| and the gripper together carry the weight of the sheet; and moments
    /// about the touchdown point vanish.
    #[test]
    fn forces_and_moments_balance() {
        let fold = FoldAtlas::new().solve([3.4, 1.7]).unwrap();
        let length = fold.suspended_length;
        let lift = fold.forces.vertical + 0.5 * length;
        let shape = fold.shape(2000);
        let ds = length / 2000.0;
        let weight: f64 = shape
            .windows(2)
            .map(|pair| 0.5 * ds * (length - 0.5 * (pair[0][0] + pair[1][0])))
            .sum();
        let [x, z] = [length - fold.gripper[0], fold.gripper[1]];
        let moment = x * lift - z * fold.forces.horizontal - weight;
        assert!(moment.abs() < 1e-5, "{moment}");
    }

    /// At (9.625, 0.175) the longest sheets overhang before they reach the table. The atlas once
    /// returned one of these unstable folds.
    #[test]
    fn gentle_folds_are_stable_where_long_sheets_turn_over() {
        let atlas = FoldAtlas::new();
        assert!(atlas.folds().iter().all(|fold| fold.unstable_modes() == 0));
        for x in [9.425, 9.525, 9.625, 9.725] {
            for z in [0.125, 0.175, 0.225] {
                let fold = atlas.solve([x, z]).unwrap();
                assert_eq!(fold.unstable_modes(), 0, "{fold:?}");
                assert!(fold.suspended_length < 6.4, "{fold:?}");
            }
        }
    }

    #[test]
    fn places_out_of_reach_are_refused() {
        let atlas = FoldAtlas::new();
        for gripper in [[-1.0, 1.0], [3.0, 9.0], [14.0, 0.5], [1.0, -0.5]] {
            let refused = atlas.solve(gripper);
            assert!(
                matches!(refused, Err(FoldError::Unreachable { .. })),
                "{refused:?}"
            );
        }
    }
}
