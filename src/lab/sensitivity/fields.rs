//! Derivatives of probes with respect to fields along the rods, by the adjoint mode
//! ([`rodlab_engine::mechanics::dynamics::adjoint`]).

use super::chosen::Chosen;
use super::error::SensitivityError;
use super::problem::{Problem, Source};
use crate::run::Mode;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::dynamics::adjoint::{Gradient, Recording};
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, line_plots};
use std::fmt::Write;

/// Maximum number of curves that are distinguishable in a plot.
const MOST_CURVES: usize = 8;

/// A quantity of each node or each edge of a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Natural curvatures about the first and the second director, 1/m.
    NaturalCurvature,
    /// Natural twist, rad/m.
    NaturalTwist,
    /// Relative changes of the bending stiffnesses about both directors.
    BendingStiffness,
    /// Relative change of the twisting stiffness.
    TwistingStiffness,
    /// Relative change of the stretching stiffness of the edge that starts at the node.
    StretchingStiffness,
    /// Dead force on the node, N.
    Force,
    /// Velocity of the node at the start, m/s.
    InitialVelocity,
}

impl Field {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::NaturalCurvature,
        Self::NaturalTwist,
        Self::BendingStiffness,
        Self::TwistingStiffness,
        Self::StretchingStiffness,
        Self::Force,
        Self::InitialVelocity,
    ];

    /// Name of the field.
    pub fn name(self) -> &'static str {
        match self {
            Self::NaturalCurvature => "natural_curvature",
            Self::NaturalTwist => "natural_twist",
            Self::BendingStiffness => "bending_stiffness",
            Self::TwistingStiffness => "twisting_stiffness",
            Self::StretchingStiffness => "stretching_stiffness",
            Self::Force => "force",
            Self::InitialVelocity => "initial_velocity",
        }
    }

    /// The field of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|field| field.name() == name)
    }

    /// Unit of the field; relative changes have none.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::NaturalCurvature => Some("1/m"),
            Self::NaturalTwist => Some("rad/m"),
            Self::Force => Some("N"),
            Self::InitialVelocity => Some("m/s"),
            _ => None,
        }
    }

    /// Suffixes of the components.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::NaturalCurvature | Self::BendingStiffness => &["_1", "_2"],
            Self::Force | Self::InitialVelocity => &["_x", "_y", "_z"],
            _ => &[""],
        }
    }

    /// Derivatives over the components at a node.
    fn at(self, gradient: &Gradient, node: usize) -> Vec<f64> {
        match self {
            Self::NaturalCurvature => gradient.natural_curvature[node].to_vec(),
            Self::NaturalTwist => vec![gradient.natural_twist[node]],
            Self::BendingStiffness => gradient.bending[node].to_vec(),
            Self::TwistingStiffness => vec![gradient.twisting[node]],
            Self::StretchingStiffness => vec![gradient.stretching[node]],
            Self::Force => gradient.force[node].as_slice().to_vec(),
            Self::InitialVelocity => gradient.velocity[node].as_slice().to_vec(),
        }
    }
}

/// Derivatives of probes with respect to fields, in SI units.
#[derive(Clone, Debug)]
pub struct FieldDerivatives {
    /// Columns of the probes.
    pub columns: Vec<String>,
    /// Values at the end of the run.
    pub values: Vec<f64>,
    /// Components of the fields, each with its unit.
    pub components: Vec<(String, Option<&'static str>)>,
    /// A row for each node, in each part of the motion.
    pub rows: Vec<FieldRow>,
    /// Ends of the parts of the motion, s.
    pub ends: Vec<f64>,
    /// Time at the end, s.
    pub time: f64,
    /// Accepted steps.
    pub steps: u64,
}

/// Derivatives with respect to the fields at one node, for a change of the fields during one part
/// of the motion.
#[derive(Clone, Debug)]
pub struct FieldRow {
    /// Number of the part.
    pub part: usize,
    /// Name of the rod.
    pub rod: String,
    /// Node of the rod.
    pub node: usize,
    /// Distance of the node from the start of the rod as placed, m.
    pub arc_length: f64,
    /// Derivatives of each column: a list for each component.
    pub derivatives: Vec<Vec<f64>>,
}

/// Differentiates probes of a scenario, at its end, with respect to fields along its rods. `of`
/// names probes or their columns; an empty list means all. The motion is divided into `parts` parts
/// of equal duration; each row of derivatives belongs to a change of the fields in one part. The
/// computation stops if `goes_on` returns false.
///
/// # Errors
/// See [`SensitivityError`].
pub fn field_derivatives(
    source: Source<'_>,
    of: &[String],
    fields: &[Field],
    parts: usize,
    goes_on: &dyn Fn() -> bool,
) -> Result<FieldDerivatives, SensitivityError> {
    let problem = Problem::new(source, &[])?;
    let run = problem.base();
    let chosen = Chosen::new(run, of)?;
    chosen.check_shape(run)?;
    let is_static = matches!(run.mode, Mode::Static);
    let settles = is_static || matches!(run.mode, Mode::Dynamic { settles: true, .. });
    if is_static && parts > 1 || settles && fields.contains(&Field::InitialVelocity) {
        return Err(SensitivityError::Unsuitable(
            "a run that begins in equilibrium has no initial velocity, and an equilibrium has no parts; set time.mode = \"dynamic\" and time.begin = \"placed\"",
        ));
    }
    let mut recording = Recording::new(&run.scene, &problem.integration())?;
    let mut steps = 0;
    let times = problem.output_times();
    let end = times.last().copied().unwrap_or_default();
    if settles {
        recording.find_equilibrium()?;
    }
    if is_static {
        steps = 1;
    } else {
        for time in times {
            while recording.simulation().time() < time {
                if !goes_on() {
                    return Err(SensitivityError::Interrupted);
                }
                recording.advance(time)?;
                steps += 1;
            }
        }
    }
    let values = |simulation: &Simulation| chosen.values(run, simulation, steps);
    let here = values(recording.simulation());
    if let Some(index) = here.iter().position(Option::is_none) {
        return Err(SensitivityError::Key {
            key: chosen.columns[index].clone(),
            reason: "it has no value at the end of the run".to_owned(),
        });
    }
    let results = |simulation: &Simulation| -> Vec<f64> {
        let values = values(simulation).into_iter();
        values.map(|value| value.unwrap_or(f64::NAN)).collect()
    };
    let ends: Vec<f64> = (1..=parts)
        .map(|part| match parts - part {
            0 => end,
            _ => end * part as f64 / parts as f64,
        })
        .collect();
    // Rounding errors of the time do not move a step into the next part.
    let mut limits: Vec<f64> = ends.iter().map(|end| end * (1.0 + 1e-12)).collect();
    if let Some(last) = limits.last_mut() {
        *last = f64::INFINITY;
    }
    let gradients = recording.gradients_over(&limits, &results)?;
    let component = |field: &Field| {
        let (name, unit) = (field.name(), field.unit());
        let endings = field.endings().iter();
        endings
            .map(|ending| (format!("{name}{ending}"), unit))
            .collect::<Vec<_>>()
    };
    Ok(FieldDerivatives {
        components: fields.iter().flat_map(component).collect(),
        rows: rows(&run.scene, fields, &gradients, parts),
        values: here.into_iter().flatten().collect(),
        columns: chosen.columns,
        ends,
        time: end,
        steps,
    })
}

/// Builds the rows of all parts and nodes from the gradients of each column in each part.
fn rows(
    scene: &Scene,
    fields: &[Field],
    gradients: &[Vec<Gradient>],
    parts: usize,
) -> Vec<FieldRow> {
    let mut rows = Vec::new();
    for part in 0..parts {
        let mut first = 0;
        for rod in &scene.rods {
            let mut arc_length = 0.0;
            for (node, place) in rod.centreline.iter().enumerate() {
                if let Some(before) = node.checked_sub(1) {
                    arc_length += (place - rod.centreline[before]).norm();
                }
                let of_column = |gradients: &Vec<Gradient>| {
                    let at = |field: &Field| field.at(&gradients[part], first + node);
                    fields.iter().flat_map(at).collect::<Vec<f64>>()
                };
                let of_columns: Vec<Vec<f64>> = gradients.iter().map(of_column).collect();
                let components = of_columns.first().map_or(0, Vec::len);
                let derivatives = (0..components)
                    .map(|component| of_columns.iter().map(|own| own[component]).collect())
                    .collect();
                rows.push(FieldRow {
                    part,
                    rod: rod.name.clone(),
                    node,
                    arc_length,
                    derivatives,
                });
            }
            first += rod.centreline.len();
        }
    }
    rows
}

impl FieldDerivatives {
    /// Sum over all nodes and parts: the derivative of a column with respect to a component that is
    /// uniform in space and time.
    pub fn sum(&self, component: usize, column: usize) -> f64 {
        let rows = self.rows.iter();
        rows.map(|row| row.derivatives[component][column]).sum()
    }

    /// The row with the largest derivative of a column with respect to a component; `None` if all
    /// are zero.
    pub fn largest(&self, component: usize, column: usize) -> Option<&FieldRow> {
        let size = |row: &FieldRow| row.derivatives[component][column].abs();
        let rows = self.rows.iter().filter(|row| size(row) > 0.0);
        rows.max_by(|one, other| size(one).total_cmp(&size(other)))
    }

    /// All rows.
    pub fn to_csv(&self) -> String {
        let mut text = "until_s,rod,node,arc_length_m".to_owned();
        for (component, _) in &self.components {
            for column in &self.columns {
                // Writing to a string cannot fail.
                let _ = write!(text, ",d_{column}_d_{component}");
            }
        }
        text.push('\n');
        for row in &self.rows {
            let FieldRow {
                part,
                rod,
                node,
                arc_length,
                derivatives,
            } = row;
            let _ = write!(text, "{:?},{rod},{node},{arc_length:?}", self.ends[*part]);
            for derivative in derivatives.iter().flatten() {
                let _ = write!(text, ",{derivative:?}");
            }
            text.push('\n');
        }
        text
    }

    /// Plots the derivatives along the rods, one plot for each component; `None` if a plot would
    /// have too many curves.
    pub fn figure(&self) -> Option<Figure> {
        let mut series: Vec<(usize, &str)> = Vec::new();
        for row in &self.rows {
            if series.last() != Some(&(row.part, &row.rod)) {
                series.push((row.part, &row.rod));
            }
        }
        if series.len() * self.columns.len() > MOST_CURVES {
            return None;
        }
        let rods = series.iter().filter(|(part, _)| *part == 0).count();
        let plot = |(component, (name, _)): (usize, &(String, Option<&str>))| {
            let mut curves = Vec::new();
            for (column, of) in self.columns.iter().enumerate() {
                for (part, rod) in &series {
                    let own = self.rows.iter();
                    let own = own.filter(|row| row.part == *part && row.rod == *rod);
                    let points = own.map(|row| {
                        let derivative = row.derivatives[component][column];
                        (row.arc_length, Some(derivative))
                    });
                    let mut label = of.clone();
                    if rods > 1 {
                        let _ = write!(label, ", {rod}");
                    }
                    if self.ends.len() > 1 {
                        let _ = write!(label, ", until {:.4} s", self.ends[*part]);
                    }
                    curves.push(Curve::new(label, points.collect()).looking(Look::Marks));
                }
            }
            LinePlot::new(format!("d/d {name}"), curves)
        };
        let plots: Vec<LinePlot> = self.components.iter().enumerate().map(plot).collect();
        Some(line_plots(plots, "Arc length in m"))
    }
}
