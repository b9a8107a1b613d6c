//! Natural strains that change over time.

mod keys;
mod resolve;
mod resolved;

pub use resolved::{Actuation, ActuationKind, Course};

use super::ScenePart;
use crate::experiment::places::find_rod;
use crate::scenario::keys::{Part, Section};
use crate::scenario::{Issue, KeyPath, Time};
use keys::ActuationKeys;
use rodlab_engine::mechanics::scene::{
    ActuatedStrain, Actuation as Strain, Course as StrainCourse, NaturalShape, RodDescription,
    Scene, Wave,
};

impl Part for Actuation {
    type Typed = ActuationKeys;

    const KEY: &'static str = "actuation";
    const DESCRIPTION: &'static str = "Natural strains that change over time.";

    fn resolve(section: &Section<'_>, typed: &ActuationKeys, _: usize) -> Self {
        resolve::actuation(section, typed)
    }

    fn judge(array: &Section<'_>, all: &[Self], time: &Time) {
        resolve::judge(array, all, time);
    }
}

impl ScenePart for Actuation {
    fn place(&self, scene: &mut Scene, path: &KeyPath) -> Result<(), Issue> {
        let rods = &scene.rods;
        let rod = find_rod(&self.rod, rods, &path.key("rod"))?;
        if rods[rod].held {
            let message = format!(
                "rod `{}` is a rigid obstacle, which neither bends nor lengthens",
                self.rod
            );
            return Err(Issue::new(path.key("rod"), message));
        }
        let length = natural_length(&rods[rod]);
        if self.from >= length {
            let message = format!(
                "{:?} m is out of range; allowed: less than the length of rod `{}`, {length:?} m",
                self.from, self.rod
            );
            return Err(Issue::new(path.key("from"), message));
        }
        scene.actuations.push(Strain {
            rod,
            strain: match self.kind {
                ActuationKind::Curvature { direction: 1 } => ActuatedStrain::FirstCurvature,
                ActuationKind::Curvature { .. } => ActuatedStrain::SecondCurvature,
                ActuationKind::Twist => ActuatedStrain::Twist,
                ActuationKind::Length => ActuatedStrain::Length,
            },
            part: [self.from, self.to.unwrap_or(f64::INFINITY)],
            course: match &self.course {
                Course::Uniform { values } => StrainCourse::Uniform(values.clone()),
                Course::Wave {
                    amplitude,
                    wavelength,
                    frequency,
                    phase,
                    schedule,
                } => StrainCourse::Wave(Wave {
                    amplitude: *amplitude,
                    wavelength: wavelength.unwrap_or(f64::INFINITY),
                    frequency: *frequency,
                    phase: *phase,
                    schedule: schedule.clone(),
                }),
            },
        });
        Ok(())
    }
}

/// Length of a rod without stress, m.
fn natural_length(rod: &RodDescription) -> f64 {
    let nodes = match &rod.natural_shape {
        NaturalShape::Centreline(nodes) => nodes,
        _ => &rod.centreline,
    };
    let edges = nodes.len() - usize::from(!rod.closed);
    let length = |edge: usize| (nodes[(edge + 1) % nodes.len()] - nodes[edge]).norm();
    rod.relaxed((0..edges).map(length).collect()).iter().sum()
}
