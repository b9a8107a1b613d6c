//! The pattern of a deployment as it is laid: rounded and shrunk where the rod demands it, and the
//! strokes of a drawing one by one.

use super::plan_deployment::DeploymentPlan;
use super::prelude::*;
use rodlab_lab::experiment::RodFile;
use rodlab_planning::plan::deployment::{MOST_POSES, SUSPENDED};
use rodlab_planning::plan::pattern::{PatternSource, Point};
use rodlab_vision::distance_to;
use std::sync::OnceLock;

/// Distance, in radii, within which a stroke begins at another one.
const NEAR: f64 = 4.0;

impl DeploymentPlan {
    /// The pattern. Sharp corners of a drawing are rounded, and with `--size fit` it shrinks, if
    /// it cannot be laid otherwise.
    pub(super) fn fitted(&self) -> Result<PatternSource, Failure> {
        let source = self.source.source()?;
        if self.ties_knot() {
            return Ok(source);
        }
        if let Some(fitted) = self.fitted.get() {
            return Ok(fitted.clone());
        }
        let rod = RodFile::read(self.rod_file()?)?.rod;
        let changes = self.source.changes();
        let remedy = self.request().allowed_remedy(&source, &rod, changes);
        let fitted = match remedy {
            None => source,
            Some(remedy) => {
                if let Some(size) = remedy.size {
                    let size = 1e3 * size;
                    tracing::warn!(
                        "--size fit: the longer side is {size} mm, for which the rod is long enough"
                    );
                }
                if let Some(deviation) = remedy.deviation {
                    let deviation = 1e3 * deviation;
                    tracing::warn!(
                        "corners that are too sharp for the rod are rounded: the path is up to {deviation} mm from the drawing \
                         (--deviation sets another distance)"
                    );
                }
                remedy.applied(source).at(self.source.name())?
            }
        };
        Ok(self.fitted.get_or_init(|| fitted).clone())
    }

    /// Plans of all strokes of a drawing, with one kind of rod that is cut to the length of each;
    /// a single plan with the whole rod if there is only one.
    pub fn strokes(&self) -> Result<Vec<Self>, Failure> {
        let mut sources = match self.ties_knot() {
            true => Vec::new(),
            false => self.source.strokes()?,
        };
        if sources.len() < 2 {
            let mut plan = self.clone();
            plan.source = sources.pop().unwrap_or(plan.source);
            return Ok(vec![plan]);
        }
        let mut plans: Vec<Self> = Vec::new();
        for source in sources {
            let mut plan = self.clone();
            (plan.source, plan.fitted, plan.is_cut) = (source, OnceLock::new(), true);
            plans.push(plan);
        }
        let length = |plan: &Self| plan.source.source().map_or(0.0, |one| one.drawn_length());
        let longest = plans.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
        let rod = longest
            .map(Self::expected_rod)
            .transpose()?
            .map(Path::to_owned);
        let mut lying: Vec<Vec<Point>> = Vec::new();
        for plan in &mut plans {
            plan.chosen.get_or_init(|| rod.clone().unwrap_or_default());
            let near = NEAR * RodFile::read(plan.rod_file()?)?.rod.radius;
            let drawn = plan.source.source()?.drawn_points().to_vec();
            let is_near = |end: Option<&Point>| {
                let mut lines = lying.iter();
                end.is_some_and(|end| lines.any(|line| distance_to(line, *end) < near))
            };
            // The free end of a rod is put on the table; its other end may fall onto another rod.
            if is_near(drawn.first()) && !is_near(drawn.last()) {
                plan.source.turn_round()?;
            }
            lying.push(drawn);
        }
        Ok(plans)
    }

    /// Length to which the rod is cut, m: that of the pattern with its lead-in, and the rest that
    /// hangs from the gripper at the end.
    pub fn cut_length(&self) -> Result<Option<f64>, Failure> {
        if !self.is_cut {
            return Ok(None);
        }
        let rod = RodFile::read(self.rod_file()?)?.rod;
        let pattern = self.request().pattern(&self.fitted()?, &rod);
        let pattern = pattern.at(self.source.name())?;
        let length = pattern.length() + SUSPENDED * rod.gravito_bending_length;
        Ok(Some(length.min(rod.length)))
    }

    /// The pattern without lead-in and lead-out, m.
    pub fn outline(&self) -> Result<Vec<Point>, Failure> {
        let pattern = self.fitted()?.pattern().at(self.source.name())?;
        // Limit the number of points, since the pattern may be very long.
        let step = self.step.max(pattern.length() / MOST_POSES);
        let points = pattern.sampled(step).into_iter();
        Ok(points.map(|point| point.position).collect())
    }
}
