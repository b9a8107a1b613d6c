//! A knot that is tightened quasi-statically, with the parameters of the thesis, section 2.5.

use super::cases::{Case, Run, prepared};
use rodlab_files::results::{ResultsError, SeriesRow};
use rodlab_lab::experiment::{KnotMonitor, KnotOutcome, KnotRow, read_knot_series};
use rodlab_lab::run::PreparedRun;

/// The trefoil of the thesis.
const BASE: &str = include_str!("../../scenarios/trefoil.toml");

/// A knot that is tightened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tightening {
    /// Unknotting number n.
    pub unknotting_number: usize,
    /// Friction coefficient μ.
    pub friction: f64,
    /// Radius of the rod, m.
    pub radius: f64,
    /// Number of nodes of the rod.
    pub nodes: usize,
    /// Distance of the ends at the start, m.
    pub end_to_end: f64,
    /// Speed of each end, m/s.
    pub pull_speed: f64,
    /// Gap at which contact forces begin, in radii of the rod.
    pub tolerance: f64,
    /// Time for which the knot settles, s.
    pub settling: f64,
    /// Simulated time, s.
    pub end: f64,
}

/// Radius of the rods in the thesis, m.
pub(super) const RADIUS: f64 = 1.6e-3;
/// Friction coefficients of figure 2.7.
pub(super) const FRICTIONS: [f64; 4] = [0.0, 0.05, 0.1, 0.2];
/// Friction coefficient of figure 2.8.
pub(super) const FRICTION_OF_FIGURE_2_8: f64 = 0.07;
/// Friction coefficient for the limit ε → 0. Without friction, a loose knot turns about its axis,
/// and the forces never settle. This friction adds at most 3 % to the traction; its part is
/// subtracted.
pub(super) const SLIGHT_FRICTION: f64 = 1e-3;
/// Radius (m) and number of nodes of the rods for the limit ε → 0.
const THIN_RODS: [(f64, usize); 4] = [(1.6e-3, 301), (8e-4, 451), (4e-4, 601), (2e-4, 901)];
/// Time for which the knots settle, s.
const SETTLING: f64 = 4.0;
/// Gap at which contact forces begin, in radii. The gap at which surfaces rest is about half of
/// it.
const TOLERANCE: f64 = 0.0125;
/// Density at the radius of the thesis, kg/m³. The thesis uses 1180, with which the loose loop
/// takes seconds to swing, so that 6 mm/s is not slow. The balance of forces does not depend on
/// the density.
const DENSITY: f64 = 10.0;
/// Remark on the density for readers of the pages.
pub(super) fn density_in_words() -> String {
    format!(
        "Rods of the thesis' radius have a density of {DENSITY} kg/m³ here instead of 1180 kg/m³, so that the pull is \
         quasi-static; force balance does not depend on the density."
    )
}
/// Time between outputs, s.
const INTERVAL: f64 = 0.25;
/// Largest time between outputs, as a fraction of the time of pulling.
const LARGEST_PART: f64 = 0.25;
/// Simulated time of a quick version, s.
const QUICK_END: f64 = 14.0;

impl Tightening {
    /// A trefoil at each friction coefficient, then trefoils of increasingly thin rods.
    pub fn of_figure_2_7(quick: bool) -> Vec<Self> {
        let thick = |friction: f64| Self {
            unknotting_number: 1,
            friction,
            radius: RADIUS,
            nodes: 301,
            end_to_end: 0.28,
            pull_speed: 6e-3,
            tolerance: TOLERANCE,
            settling: SETTLING,
            end: if quick { QUICK_END } else { 54.0 },
        };
        let thin = |(radius, nodes): (f64, usize)| Self {
            friction: SLIGHT_FRICTION,
            radius,
            nodes,
            pull_speed: 1e-3,
            end: QUICK_END,
            ..thick(0.0)
        };
        let thick = FRICTIONS.map(thick).into_iter();
        thick.chain(THIN_RODS.map(thin)).collect()
    }

    /// The overhand knots of unknotting number 1 to 4.
    pub fn of_figure_2_8(quick: bool) -> Vec<Self> {
        (1..=4)
            .map(|unknotting_number| Self {
                unknotting_number,
                friction: FRICTION_OF_FIGURE_2_8,
                radius: RADIUS,
                nodes: 301,
                // Longer braids need more room.
                end_to_end: 0.26 + 0.02 * unknotting_number as f64,
                pull_speed: 3e-3,
                tolerance: TOLERANCE,
                settling: SETTLING,
                end: if quick { QUICK_END } else { 90.0 },
            })
            .collect()
    }

    /// Each knot of figure 2.8, followed by its versions with one changed choice each:
    /// [`VARIANTS`].
    pub fn of_convergence(quick: bool) -> Vec<Self> {
        let vary = |run: Self| VARIANTS.map(|(_, change)| change(run));
        Self::of_figure_2_8(quick)
            .into_iter()
            .flat_map(vary)
            .collect()
    }

    /// h²/EI, which makes tractions dimensionless, 1/N.
    pub fn traction_unit(&self) -> f64 {
        let prepared = self.prepare();
        let monitor = prepared.observer::<KnotMonitor>();
        let observer = monitor.expect("a knot is observed").observer;
        observer.radius.powi(2) / observer.bending_stiffness
    }
}

/// A knot with one choice changed.
type Change = fn(Tightening) -> Tightening;

/// The changed choices for the convergence study, as text.
pub(super) const VARIANTS: [(&str, Change); 5] = [
    ("301 nodes", |run| run),
    ("151 nodes", |run| Tightening { nodes: 151, ..run }),
    ("601 nodes", |run| Tightening { nodes: 601, ..run }),
    ("half the speed", |run| Tightening {
        pull_speed: 0.5 * run.pull_speed,
        end: run.settling + 2.0 * (run.end - run.settling),
        ..run
    }),
    ("half the contact gap", |run| Tightening {
        tolerance: 0.5 * run.tolerance,
        ..run
    }),
];

impl Run for Tightening {
    /// Name of the run, such as `knot_n1_mu0.1_h1.6mm_301nodes_6mms_gap0.0125h_54s`.
    fn id(&self) -> String {
        let Self {
            unknotting_number,
            friction,
            nodes,
            tolerance,
            end,
            ..
        } = self;
        let millimetres = |metres: f64| (1e7 * metres).round() / 1e4;
        format!(
            "knot_n{unknotting_number}_mu{friction}_h{}mm_{nodes}nodes_{}mms_gap{tolerance}h_{end}s",
            millimetres(self.radius),
            millimetres(self.pull_speed)
        )
    }

    fn prepare(&self) -> PreparedRun {
        let thinness = self.radius / RADIUS;
        let interval = INTERVAL.min(LARGEST_PART * (self.end - self.settling));
        let overrides = [
            format!("title=\"{}\"", self.id()),
            format!("knot.unknotting_number={}", self.unknotting_number),
            format!("rod.radius={:?}", self.radius),
            format!("rod.nodes={}", self.nodes),
            "knot.ends=\"pinned\"".to_owned(),
            format!("knot.pull_speed={:?}", self.pull_speed),
            format!("knot.end_to_end={:?}", self.end_to_end),
            format!("knot.settling_time={:?}", self.settling),
            // Keep the frequency of the loop, which is proportional to √(E/ρ) h.
            format!("material.density={:?}", DENSITY * thinness * thinness),
            format!("contact.friction={:?}", self.friction),
            format!(
                "contact.distance_tolerance={:?}",
                self.tolerance * self.radius
            ),
            format!("time.end={:?}", self.end),
            format!("output.interval={interval:?}"),
        ];
        prepared(&self.id(), BASE, &overrides)
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn cost(&self) -> f64 {
        let steps = self.end / 2.5e-3;
        4e-6 * self.nodes as f64 * self.unknotting_number as f64 * steps
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            settling: 0.0,
            end: 1e-2,
            ..*self
        }
    }
}

/// Fraction of the time of pulling that is ignored, since friction does not yet act in the
/// direction of slip everywhere.
const LEFT_OUT: f64 = 0.1;

/// Measurements of the knot while its ends moved, without the ignored first part.
pub(super) fn pulled_rows(case: &Case<Tightening>) -> Result<Vec<KnotRow>, ResultsError> {
    let rows = pulled_series(case)?.into_iter();
    Ok(rows.map(|(_, knot)| knot).collect())
}

fn pulled_series(case: &Case<Tightening>) -> Result<Vec<(SeriesRow, KnotRow)>, ResultsError> {
    let rows = read_knot_series(&case.directory)?.into_iter();
    let Tightening { settling, end, .. } = case.run;
    let start = settling + LEFT_OUT * (end - settling);
    Ok(rows.filter(|(series, _)| series.time_s > start).collect())
}

/// Means over an interval of the motion of the ends . During the interval, the corners of the
/// polyline slip over each other many times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// l̄_k in the middle of the interval.
    pub length: f64,
    /// Traction F̄: work of the ends per distance.
    pub force: f64,
    /// The part of friction.
    pub friction: f64,
}

/// Range of l̄_k while the ends move, without the ignored first part and before any inversion: the
/// tight end first.
pub(super) fn range_before_inversion(
    case: &Case<Tightening>,
) -> Result<Option<[f64; 2]>, ResultsError> {
    let rows = pulled_rows(case)?;
    let knot = KnotOutcome::of(&case.record.outcome).unwrap_or_default();
    let inverted = [knot.inversion_by_force, knot.inversion_by_height];
    let inverted = inverted.into_iter().flatten().fold(0.0, f64::max);
    Ok(rows.first().zip(rows.last()).map(|(first, last)| {
        [
            inverted.max(last.length_normalized),
            first.length_normalized,
        ]
    }))
}

/// The means over `count` equal parts of a range of l̄_k, from loose to tight; empty if the range
/// is empty.
pub(super) fn stretches(
    case: &Case<Tightening>,
    [tight, loose]: [f64; 2],
    count: usize,
) -> Result<Vec<Stretch>, ResultsError> {
    let rows = pulled_rows(case)?;
    let (unit, radius) = (case.run.traction_unit(), case.run.radius);
    let mark = |k: usize| {
        let part = k as f64 / count as f64;
        (1.0 - part) * loose + part * tight
    };
    let mean = |k: usize| {
        let [start, end] = [mark(k), mark(k + 1)];
        let done = |of: fn(&KnotRow) -> f64| Some(at(&rows, end, of)? - at(&rows, start, of)?);
        let per_distance = unit / (radius * (start - end));
        Some(Stretch {
            length: 0.5 * (start + end),
            force: per_distance * done(|row| row.work_of_ends_j)?,
            friction: per_distance * done(|row| row.friction_loss_j)?,
        })
    };
    let whole = if tight < loose { count } else { 0 };
    Ok((0..whole).filter_map(mean).collect())
}

/// Root mean square deviation of F̄ from its means over `count` equal parts of a range of l̄_k,
/// relative to these means; `None` if there are fewer than two.
pub(super) fn fluctuation(
    case: &Case<Tightening>,
    range: [f64; 2],
    count: usize,
) -> Result<Option<f64>, ResultsError> {
    let parts = stretches(case, range, count)?;
    let squares: Vec<f64> = pulled_rows(case)?
        .iter()
        .filter_map(|row| {
            // Between the middles of two parts the mean is interpolated linearly.
            let after = parts.partition_point(|part| part.length > row.length_normalized);
            let (a, b) = (parts.get(after.checked_sub(1)?)?, parts.get(after)?);
            let part = (a.length - row.length_normalized) / (a.length - b.length);
            let mean = a.force + part * (b.force - a.force);
            Some((row.force_normalized / mean - 1.0).powi(2))
        })
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    Ok((!squares.is_empty()).then_some(mean.sqrt()))
}

/// A value at an l̄_k, interpolated linearly between two rows.
fn at(rows: &[KnotRow], length: f64, of: fn(&KnotRow) -> f64) -> Option<f64> {
    let after = rows.partition_point(|row| row.length_normalized > length);
    let (a, b) = (rows.get(after.max(1) - 1)?, rows.get(after.max(1))?);
    let part = (a.length_normalized - length) / (a.length_normalized - b.length_normalized);
    Some(of(a) + part * (of(b) - of(a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_describe_the_runs() {
        let runs = Tightening::of_figure_2_7(false);
        assert_eq!(
            runs[2].id(),
            "knot_n1_mu0.1_h1.6mm_301nodes_6mms_gap0.0125h_54s"
        );
        let prepared = runs[2].prepare();
        assert_eq!(prepared.scene.contact.unwrap().friction, 0.1);
        assert_eq!(
            prepared
                .observer::<KnotMonitor>()
                .unwrap()
                .observer
                .determinant,
            3
        );
    }

    #[test]
    fn values_between_rows_lie_on_lines() {
        let rows =
            [(30.0, 1.0), (20.0, 2.0), (10.0, 4.0)].map(|(length_normalized, work_of_ends_j)| {
                KnotRow {
                    length_normalized,
                    work_of_ends_j,
                    ..KnotRow::default()
                }
            });
        let work = |length| at(&rows, length, |row| row.work_of_ends_j);
        assert_eq!(
            [30.0, 25.0, 20.0, 12.5, 10.0].map(work),
            [1.0, 1.5, 2.0, 3.5, 4.0].map(Some)
        );
        assert_eq!(at(&rows[..1], 25.0, |row| row.work_of_ends_j), None);
    }
}
