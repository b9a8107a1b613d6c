//! Centrelines to sub-pixel accuracy: the middle between the two edges of a strand, smoothed along
//! it.

use super::Point;
use super::beside::{Beside, is_double};
use super::chord::Chord;
use super::contrast::Contrast;
use super::path_energy::distorted_pixels;
use super::skeleton::{Arm, Skeleton, median};
use super::smoothing::{resample, smooth};
use super::strand::Path;
use super::strand_end::{EndStops, extend_ends, normal};

/// A strand of an image: the curve along its middle, and its width.
///
/// Pixel coordinates: u to the right, v down, (0, 0) is the centre of the first pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Strand {
    /// Points along the strand, at nearly equal distances, pixels.
    pub points: Vec<Point>,
    /// Width at each point, pixels.
    pub widths: Vec<f64>,
    /// Whether the curve is closed: the last point is followed by the first.
    pub closed: bool,
}

impl Strand {
    /// Length of the strand, pixels.
    pub fn length(&self) -> f64 {
        let steps = self
            .points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm());
        let seam = match (self.closed, self.points.first(), self.points.last()) {
            (true, Some(first), Some(last)) => (first - last).norm(),
            _ => 0.0,
        };
        steps.sum::<f64>() + seam
    }

    /// Median width of the strand, pixels.
    pub fn width(&self) -> f64 {
        median(&self.widths)
    }

    /// Largest distance of the points from the straight line between the ends, pixels.
    pub(super) fn sagitta(&self) -> f64 {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else {
            return 0.0;
        };
        let along = (last - first).try_normalize(1e-9).unwrap_or(Point::x());
        let away = self.points.iter().map(|point| along.perp(&(point - first)));
        away.fold(0.0, |most, away| most.max(away.abs()))
    }

    /// Reverses the direction of the strand.
    pub(super) fn reverse(&mut self) {
        self.points.reverse();
        self.widths.reverse();
    }

    /// A strand of constant width.
    #[cfg(test)]
    pub(super) fn even(points: Vec<Point>, width: f64, closed: bool) -> Self {
        Self {
            widths: vec![width; points.len()],
            points,
            closed,
        }
    }

    /// Unit vector along the strand at a point.
    pub fn tangent(&self, index: usize) -> Point {
        let count = self.points.len();
        let (before, after) = if self.closed {
            ((index + count - 1) % count, (index + 1) % count)
        } else {
            (index.saturating_sub(1), (index + 1).min(count - 1))
        };
        let along = self.points[after] - self.points[before];
        along.try_normalize(1e-12).unwrap_or(Point::x())
    }
}

/// Points per width of the strand.
const POINTS_PER_WIDTH: f64 = 6.0;
/// Smoothing length ℓ, in widths: waves shorter than about four widths are noise of the edges.
const SMOOTHING: f64 = 0.6;
/// A strand is measured only where the ratio of its width to its median width is within these
/// bounds. Elsewhere it meets another strand.
const PLAUSIBLE_WIDTH: [f64; 2] = [0.7, 1.18];
/// Length of the straight extension of an end where its width cannot be measured, in widths; beyond
/// that it follows the skeleton.
const LONGEST_TAIL: f64 = 1.5;
/// Length of a branch whose width may be that of the strand, as a part of the path.
const LONG_BRANCH: f64 = 0.05;
/// Rounds of measuring across the curve and smoothing it.
const ROUNDS: usize = 2;

/// Finds the centreline of a path.
pub(super) fn centreline(
    contrast: &Contrast,
    skeleton: &Skeleton,
    path: &Path,
    ends: &EndStops<impl Fn(Point) -> [f64; 3]>,
) -> Strand {
    let mut width = usual_width(skeleton, path);
    let step = (width / POINTS_PER_WIDTH).clamp(1.0, 4.0);
    let (mut points, mut weights) = first_guess(skeleton, path, step, ends);
    let lambda = |width: f64| (SMOOTHING * width / step).powi(4);
    points = smooth(&points, &weights, lambda(width), path.closed);
    let (guess, trusted) = (points.clone(), weights.clone());
    let mut measured = vec![None; points.len()];
    for _ in 0..ROUNDS {
        let strand = Strand {
            widths: Vec::new(),
            closed: path.closed,
            points,
        };
        measured = (0..strand.points.len())
            .map(|index| chord(contrast, &strand, index, width))
            .collect();
        let tangents = (0..strand.points.len()).map(|index| strand.tangent(index));
        let beside = Beside {
            points: &strand.points,
            tangents: tangents.collect(),
            step,
            width,
            closed: strand.closed,
        };
        let separated = beside.separate(&mut measured);
        let found: Vec<f64> = (0..measured.len())
            .filter(|index| !separated.iter().any(|run| run.contains(index)))
            .filter_map(|index| Some(measured[index]?.width()))
            .collect();
        if found.len() >= 3 {
            width = median(&found);
        }
        reject_outliers(&mut measured, width);
        points = strand.points.clone();
        for (index, chord) in measured.iter().enumerate() {
            weights[index] = 0.0;
            if let Some(chord) = chord {
                weights[index] = 1.0;
                points[index] += normal(strand.tangent(index)) * chord.middle();
            }
        }
        if measured.iter().flatten().count() < 3 {
            // The strand is too thin or too short to measure, so that the skeleton is used.
            weights.fill(1.0);
        }
        if !path.closed {
            let margin = (LONGEST_TAIL * width / step).ceil() as usize;
            for index in tails(&measured, margin) {
                (points[index], weights[index]) = (guess[index], trusted[index]);
            }
        }
        points = smooth(&points, &weights, lambda(width), path.closed);
    }
    let mut widths = fill_gaps(&measured, width);
    if !path.closed {
        extend_ends(contrast, &mut points, &mut widths, step, path, ends);
    }
    Strand {
        points,
        widths,
        closed: path.closed,
    }
}

/// Width of the longest branch of a path, or of another long branch if that one is twice as wide,
/// since another strand lies beside it.
fn usual_width(skeleton: &Skeleton, path: &Path) -> f64 {
    let branches = path.entries.iter().map(|arm| {
        let branch = &skeleton.branches[arm.branch];
        (branch.pixels.len(), 2.0 * branch.half_width())
    });
    let whole: usize = branches.clone().map(|(length, _)| length).sum();
    let longest = branches.clone().max_by_key(|(length, _)| *length);
    let width = longest.map_or(1.0, |(_, width)| width);
    let singles = branches.filter(|(length, single)| {
        *length as f64 >= LONG_BRANCH * whole as f64 && is_double(width, *single)
    });
    let single = singles.max_by_key(|(length, _)| *length);
    single.map_or(width, |(_, single)| single).max(1.0)
}

/// Points along a path of the skeleton, spaced by a step, for later smoothing. Points where the
/// skeleton is distorted have zero weight.
fn first_guess(
    skeleton: &Skeleton,
    path: &Path,
    step: f64,
    ends: &EndStops<impl Fn(Point) -> [f64; 3]>,
) -> (Vec<Point>, Vec<f64>) {
    let (mut raw, mut trusted) = (Vec::new(), Vec::new());
    for (entry, bridge) in path.entries.iter().zip(&path.bridges) {
        let branch = &skeleton.branches[entry.branch];
        let count = branch.pixels.len();
        let skipped = |side: usize| {
            let arm = Arm {
                side,
                branch: entry.branch,
            };
            if branch.nodes.is_none() {
                0
            } else if ends.has(arm) {
                distorted_pixels(skeleton, arm)
            } else {
                // At the end of a strand, the skeleton bends towards a corner.
                (0.5 * branch.half_width()).round().min(count as f64 / 3.0) as usize
            }
        };
        let mut pixels = branch.pixels[skipped(0)..count - skipped(1)].to_vec();
        if entry.side == 1 {
            pixels.reverse();
        }
        raw.extend(pixels.iter().copied());
        // The last pixel is not trusted, since a bridge follows.
        trusted.extend((0..pixels.len()).map(|index| index + 1 < pixels.len()));
        raw.extend(bridge.iter().copied());
        trusted.extend((0..bridge.len()).map(|index| index + 1 < bridge.len()));
    }
    if raw.is_empty() {
        // The branches of the path have no pixels, so that it connects the nodes.
        let nodes = path.entries.iter().filter_map(|entry| {
            let nodes = skeleton.branches[entry.branch].nodes?;
            Some(nodes.map(|node| skeleton.nodes[node].position))
        });
        raw = nodes.flatten().collect();
        trusted = vec![true; raw.len()];
    }
    let (points, length) = resample(&raw, step, path.closed);
    let mut weights = Vec::with_capacity(points.len());
    let (mut segment, mut along) = (0, 0.0);
    let whole_segments = raw.len().max(2) - 1;
    let size = |segment: usize| (raw[(segment + 1) % raw.len()] - raw[segment % raw.len()]).norm();
    for index in 0..points.len() {
        let intervals = if path.closed {
            points.len()
        } else {
            points.len() - 1
        };
        let s = length * index as f64 / intervals.max(1) as f64;
        while segment < whole_segments && along + size(segment) < s {
            along += size(segment);
            segment += 1;
        }
        let inside = trusted.get(segment).copied().unwrap_or(false);
        let last = index + 1 == points.len() && !path.closed;
        let gap = size(segment) > 2.0 && !inside;
        weights.push(f64::from(u8::from(!gap || last)));
    }
    (points, weights)
}

/// Looks for both edges within a width of a point; `None` if the strand is wider or leaves the
/// image.
pub(super) fn chord(
    contrast: &Contrast,
    strand: &Strand,
    index: usize,
    width: f64,
) -> Option<Chord> {
    let (centre, across) = (strand.points[index], normal(strand.tangent(index)));
    let threshold = f64::from(contrast.threshold);
    let value = |t: f64| {
        let point = centre + across * t;
        contrast.at(point.x, point.y) - threshold
    };
    const STEP: f64 = 0.5;
    let reach = (width / STEP).ceil().max(4.0) as i32;
    // If the point is outside the strand, start at the nearest pixel of the strand.
    let start = (0..=reach / 2)
        .flat_map(|k| [k, -k])
        .find(|k| value(f64::from(*k) * STEP) >= 0.0)?;
    let edge = |sign: f64| {
        let mut inside = value(f64::from(start) * STEP);
        for k in 1..=2 * reach {
            let t = f64::from(start) * STEP + sign * f64::from(k) * STEP;
            let outside = value(t);
            if outside < 0.0 {
                let point = centre + across * t;
                let leaves = point.x < 0.0
                    || point.y < 0.0
                    || point.x > (contrast.width - 1) as f64
                    || point.y > (contrast.height - 1) as f64;
                let back = STEP * outside / (outside - inside);
                return (!leaves).then_some(t - sign * back);
            }
            inside = outside;
        }
        None
    };
    Some(Chord::new([edge(-1.0)?, edge(1.0)?]))
}

/// Indices of the points more than `margin` before the first chord or behind the last one; none
/// without chords.
fn tails(chords: &[Option<Chord>], margin: usize) -> impl Iterator<Item = usize> + use<> {
    let count = chords.len();
    let first = chords.iter().position(Option::is_some).unwrap_or(0);
    let last = chords.iter().rposition(Option::is_some).unwrap_or(count);
    (0..first.saturating_sub(margin)).chain((last + margin + 1).min(count)..count)
}

/// Removes chords whose width differs from the strand's, and their neighbours.
fn reject_outliers(chords: &mut [Option<Chord>], width: f64) {
    let plausible: Vec<bool> = chords
        .iter()
        .map(|chord| {
            chord.is_some_and(|chord| {
                let ratio = chord.width() / width;
                PLAUSIBLE_WIDTH[0] < ratio && ratio < PLAUSIBLE_WIDTH[1]
            })
        })
        .collect();
    let count = chords.len();
    for (index, chord) in chords.iter_mut().enumerate() {
        let near = index.saturating_sub(1)..(index + 2).min(count);
        if !plausible[near].iter().all(|plausible| *plausible) {
            *chord = None;
        }
    }
}

/// Widths at all points: means over five neighbours, interpolated between measured points.
fn fill_gaps(chords: &[Option<Chord>], width: f64) -> Vec<f64> {
    let measured: Vec<(usize, f64)> = chords
        .iter()
        .enumerate()
        .filter_map(|(index, chord)| Some((index, chord.as_ref()?.width())))
        .collect();
    if measured.is_empty() {
        return vec![width; chords.len()];
    }
    let mut next = 0;
    let filled: Vec<f64> = (0..chords.len())
        .map(|index| {
            while next < measured.len() && measured[next].0 < index {
                next += 1;
            }
            let after = measured.get(next);
            let before = next.checked_sub(1).map(|before| measured[before]);
            match (before, after) {
                (_, Some((at, width))) if *at == index => *width,
                (Some((a, wa)), Some((b, wb))) => {
                    let t = (index - a) as f64 / (b - a) as f64;
                    wa + (wb - wa) * t
                }
                (Some((_, width)), None) => width,
                (None, Some((_, width))) => *width,
                (None, None) => width,
            }
        })
        .collect();
    (0..filled.len())
        .map(|index| {
            let near = &filled[index.saturating_sub(2)..(index + 3).min(filled.len())];
            near.iter().sum::<f64>() / near.len() as f64
        })
        .collect()
}
