//! Measurements of a sheet by the camera while it was folded, and the score of the fold.

use serde::Serialize;

/// Measurement of the sheet after a part of its path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Look {
    /// The part, from 1.
    pub part: usize,
    /// Position of the edge from the joint positions of the arm, in the frame of the sheet, m:
    /// along the fold and up.
    pub edge_m: [f64; 2],
    /// Slide of the free end in the direction of the fold, m, if the end is visible.
    pub slid_m: Option<f64>,
    /// Whether the next part is replanned.
    pub is_replanned: bool,
}

/// Score of a fold before the gripper opens. Lengths are `None` if the free end was hidden at the
/// end: it may have slid anywhere under the edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FoldScore {
    /// Slide of the free end in the direction of the fold at the end, m.
    pub sliding_m: Option<f64>,
    /// Slide when the free end was last visible, m.
    pub last_seen_sliding_m: f64,
    /// The part after which the free end was last visible, from 1.
    pub last_seen_part: usize,
    /// Largest observed slide, m.
    pub largest_sliding_m: f64,
    /// Whether the edge covers the free end after the fold, so that the camera no longer sees that end.
    pub is_end_hidden: bool,
    /// Distance by which the edge was moved in the direction of the fold, from the joint positions of the arm, m.
    pub edge_m: f64,
    /// Distance along the sheet from its edge to the crease, m, if the crease is pressed half a
    /// crease target behind the edge.
    pub fold_length_m: Option<f64>,
    /// Difference between the fold length and half the crease target, m.
    pub fold_length_error_m: Option<f64>,
}

impl FoldScore {
    /// Computes the score from the measurements of a sheet and the target of its edge, m; `None`
    /// if the free end was never visible.
    pub fn of(looks: &[Look], target: f64) -> Option<Self> {
        let last = looks.last()?;
        let seen = looks.iter().filter(|look| look.slid_m.is_some());
        let last_seen = seen.clone().next_back()?;
        let slid = seen.filter_map(|look| look.slid_m);
        let [edge_m, _] = last.edge_m;
        let fold_length_m = last.slid_m.map(|slid| edge_m - 0.5 * target - slid);
        Some(Self {
            sliding_m: last.slid_m,
            last_seen_sliding_m: last_seen.slid_m?,
            last_seen_part: last_seen.part,
            largest_sliding_m: slid.map(f64::abs).fold(0.0, f64::max),
            is_end_hidden: last.slid_m.is_none(),
            edge_m,
            fold_length_m,
            fold_length_error_m: fold_length_m.map(|length| length - 0.5 * target),
        })
    }
}

/// Measurements as a table.
pub fn looks_csv(looks: &[Look]) -> String {
    let mut text = String::from("part,edge_x_m,edge_z_m,slid_m,replanned\n");
    for look in looks {
        let [x, z] = look.edge_m;
        let slid = look.slid_m.map(|slid| format!("{slid:.6}"));
        let (part, slid, replanned) = (look.part, slid.unwrap_or_default(), look.is_replanned);
        text += &format!("{part},{x:.6},{z:.6},{slid},{replanned}\n");
    }
    text
}

/// A measurement with the edge on the table at x, m.
#[cfg(test)]
pub fn look(part: usize, x: f64, slid_m: Option<f64>) -> Look {
    Look {
        part,
        edge_m: [x, 0.0],
        slid_m,
        is_replanned: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crease_is_half_a_target_back_from_the_edge_on_a_sheet_that_has_slid() {
        let looks = [
            look(1, 0.1, Some(-1e-3)),
            look(2, 0.2, Some(3e-3)),
            look(3, 0.298, None),
        ];
        let score = FoldScore::of(&looks[..2], 0.296).unwrap();
        assert_eq!(score.sliding_m, Some(3e-3));
        assert_eq!(score.largest_sliding_m, 3e-3);
        assert!((score.fold_length_m.unwrap() - 0.049).abs() < 1e-12);
        assert!((score.fold_length_error_m.unwrap() + 0.099).abs() < 1e-12);
        assert_eq!(FoldScore::of(&looks[2..], 0.296), None);
    }

    #[test]
    fn a_hidden_free_end_has_no_slide_and_the_fold_no_length() {
        // The path was replanned for a slide of 28 mm, so that the edge reaches 28 mm beyond its
        // target, wherever the free end is now.
        let looks = [
            look(1, 0.1, Some(-1e-3)),
            look(2, 0.25, Some(28e-3)),
            look(3, 0.324, None),
        ];
        let score = FoldScore::of(&looks, 0.296).unwrap();
        assert!(score.is_end_hidden && score.sliding_m.is_none());
        assert!(score.fold_length_m.is_none() && score.fold_length_error_m.is_none());
        assert_eq!(
            (score.last_seen_sliding_m, score.last_seen_part),
            (28e-3, 2)
        );
        assert_eq!(score.largest_sliding_m, 28e-3);
    }
}
