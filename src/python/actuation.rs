//! Natural curvature as an array, by actuation of both curvatures of each rod.

use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use rodlab_engine::mechanics::scene::{ActuatedStrain, Actuation, Course, RodDescription, Scene};
use std::ops::Range;

/// The rods whose natural curvature a program sets.
#[derive(Clone, Debug, Default)]
pub struct CurvedRods {
    /// Nodes of each rod, and its two actuations.
    rods: Vec<(Range<usize>, [usize; 2])>,
}

impl CurvedRods {
    /// Adds an actuation of both curvatures to each elastic rod of a scene.
    pub fn add_to(scene: &mut Scene) -> Self {
        let mut rods = Vec::new();
        let mut first = 0;
        for (rod, description) in scene.rods.iter().enumerate() {
            let nodes = first..first + description.centreline.len();
            first = nodes.end;
            if description.held {
                continue;
            }
            let places = places(description);
            let strains = [
                ActuatedStrain::FirstCurvature,
                ActuatedStrain::SecondCurvature,
            ];
            let numbers = strains.map(|strain| {
                scene.actuations.push(Actuation {
                    rod,
                    strain,
                    part: [0.0, f64::INFINITY],
                    course: Course::Given {
                        places: places.clone(),
                        values: vec![0.0; places.len()],
                    },
                });
                scene.actuations.len() - 1
            });
            rods.push((nodes, numbers));
        }
        Self { rods }
    }

    /// Whether there are no such rods.
    pub fn is_empty(&self) -> bool {
        self.rods.is_empty()
    }

    /// Sets the curvatures κ₁, κ₂ of all nodes of the scene, row by row, 1/m.
    pub fn set(&self, simulation: &mut Simulation, flat: &[f64]) -> Result<(), SimulationError> {
        for (nodes, numbers) in &self.rods {
            for (component, number) in numbers.iter().enumerate() {
                let values: Vec<f64> = (nodes.clone())
                    .map(|node| flat[2 * node + component])
                    .collect();
                simulation.set_actuation(*number, &values)?;
            }
        }
        Ok(())
    }
}

/// Distances of the nodes of a rod from its start, m.
fn places(rod: &RodDescription) -> Vec<f64> {
    let mut place = 0.0;
    let edges = rod.centreline.windows(2).map(|ends| {
        place += (ends[1] - ends[0]).norm();
        place
    });
    [0.0].into_iter().chain(edges).collect()
}
