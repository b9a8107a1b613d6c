//! Linear drag, C (q − qₙ)/h with a coefficient for each unknown: the drag of loads of the scene,
//! which may change over time, and the resistance of a fluid to the spin of edges.

use super::build::Assembly;
use super::events::Event;
use super::factor::Scale;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::SceneError;
use crate::mechanics::rod::{ElasticRods, RodGeometry, STRIDE};
use crate::mechanics::scene::{LoadKind, Scene};

/// All drag with coefficients.
#[derive(Clone, Debug)]
pub(crate) struct LinearDrag {
    /// Coefficient of the velocity of each unknown at the present time, N s/m or N m s; empty without drag.
    pub coefficients: Vec<f64>,
    parts: Vec<Part>,
}

#[derive(Clone, Debug)]
struct Part {
    /// Coefficient of each unknown, N s/m or N m s.
    coefficients: Vec<f64>,
    scale: Scale,
}

impl LinearDrag {
    /// Sets the coefficients to those of `time`.
    fn at(&mut self, time: f64) {
        self.coefficients.fill(0.0);
        for part in &self.parts {
            let factor = part.scale.at(time);
            for (sum, coefficient) in self.coefficients.iter_mut().zip(&part.coefficients) {
                *sum += factor * coefficient;
            }
        }
    }
}

impl Term for LinearDrag {
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let mut parts = Vec::new();
        for (number, load) in scene.loads.iter().enumerate() {
            let LoadKind::Drag {
                rod,
                translation,
                rotation,
            } = load.kind
            else {
                continue;
            };
            let mut coefficients = vec![0.0; STRIDE * assembly.rods.nodes];
            for edge in assembly.edges_of(rod)? {
                for node in [edge.start, edge.end] {
                    for axis in 0..3 {
                        coefficients[STRIDE * node + axis] +=
                            0.5 * edge.natural_length * translation;
                    }
                }
                coefficients[STRIDE * edge.start + 3] += edge.natural_length * rotation;
            }
            parts.push(Part {
                coefficients,
                scale: Scale::of(number, load),
            });
        }
        parts.extend(assembly.spin_resistance(scene).map(|coefficients| Part {
            coefficients,
            scale: Scale::steady(),
        }));
        let unknowns = parts.first().map_or(0, |part| part.coefficients.len());
        let mut drag = Self {
            coefficients: vec![0.0; unknowns],
            parts,
        };
        drag.at(0.0);
        Ok(drag)
    }

    fn kind(&self) -> Kind {
        Kind::Motion
    }

    fn has_copies(&self) -> bool {
        true
    }

    fn drive(&mut self, time: f64, _: &mut ElasticRods, _: &mut RodGeometry) {
        self.at(time);
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        let Some(stage) = at.stage else { return };
        let per_step = 1.0 / stage.step;
        let motion = at.unknowns.iter().zip(&stage.start);
        let entries = residual.iter_mut().zip(&self.coefficients).zip(motion);
        for ((entry, coefficient), (now, start)) in entries {
            *entry += coefficient * (now - start) * per_step;
        }
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        let Some(stage) = at.stage else { return };
        let per_step = 1.0 / stage.step;
        for (column, coefficient) in entries.columns().iter_mut().zip(&self.coefficients) {
            column[0] += coefficient * per_step;
        }
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        let scales = self.parts.iter().map(|part| &part.scale);
        events.extend(scales.flat_map(Scale::events));
    }

    fn scale_load(&mut self, load: usize, factor: f64) {
        for part in &mut self.parts {
            part.scale.set_factor(load, factor);
        }
    }
}
