//! Checks that the linking of closed rods does not change.
//!
//! Continuous collision detection certifies every step; this is a second, independent check. As
//! long as rods do not pass through each other, two numbers are invariant under any motion,
//! bending and twist:
//!
//! - the linking number of every pair of closed rods, by Gauss' integral;
//! - the linking number of a closed rod with the edge of its own material frame: the sum of its
//!   writhe and its twist in turns (Călugăreanu 1961, White 1969). It changes by two if the rod
//!   passes through itself.

use super::decimals::decimals;
use super::observer::{Finding, Observer, Sample};
use super::probes::{linking_number, writhe};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::results::{SeriesRow, Value};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Number of steps between two checks, per pair of segments and divided by the number of nodes.
const STEPS_PER_PAIR: u64 = 4;
/// Number of pairs of segments that can be checked in the time needed to write an output.
const PAIRS_PER_OUTPUT: u64 = 5000;

/// Largest number of pairs of segments that is checked: a second of work.
const MOST_PAIRS: u64 = 25_000_000;

/// Fails a run at the first output at which the linking of closed rods has changed.
///
/// A check costs 40 ns for every pair of segments, a step at least 0.3 µs for every node. The
/// guard therefore waits four steps, for each pair per node, before it checks another output, so
/// that it costs at most 3 % of a run. The guard does not wait if the check costs no more than
/// writing the output. If closed rods have more than seven thousand segments, only continuous
/// collision detection guards them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LinkingGuard {
    rods: Vec<ClosedRod>,
    seen: Linking,
    /// Whether the contact model is a barrier.
    is_barrier: bool,
    /// Step of the last check, and the number of steps before the next; `None` before the first.
    last: Option<[u64; 2]>,
}

/// A closed rod of the scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ClosedRod {
    index: usize,
    name: String,
    held: bool,
}

/// Linking numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Linking {
    /// Linking numbers of each rod with the rods before it.
    pairs: Vec<Vec<i64>>,
    /// Linking number of each rod with its own frame; empty before the first frames.
    own: Vec<f64>,
    /// Number of pairs of segments that were checked.
    looked_at: u64,
}

impl LinkingGuard {
    /// A guard of the closed rods of a scene, with the linking at its start. `None` if nothing can
    /// be guarded: without contact rods may pass through each other, and rods that are all held do
    /// not move. Also `None` for too many segments.
    pub fn of(scene: &Scene) -> Option<Self> {
        let rods: Vec<ClosedRod> = (scene.rods.iter().enumerate())
            .filter(|(_, rod)| rod.closed)
            .map(|(index, rod)| ClosedRod {
                index,
                name: rod.name.clone(),
                held: rod.held,
            })
            .collect();
        let contact = scene.contact?;
        if rods.iter().all(|rod| rod.held) {
            return None;
        }
        let segments = rods
            .iter()
            .map(|rod| scene.rods[rod.index].centreline.len() as u64);
        if segments.sum::<u64>().pow(2) / 2 > MOST_PAIRS {
            return None;
        }
        let nodes = |rod: &ClosedRod| {
            let before = &scene.rods[..rod.index];
            let first: usize = before.iter().map(|rod| rod.centreline.len()).sum();
            let placed = &scene.rods[rod.index].centreline[..];
            match &scene.start {
                Some(start) => &start.positions[first..first + placed.len()],
                None => placed,
            }
        };
        let mut seen = Linking::default();
        seen.add_pairs(&rods, nodes);
        Some(Self {
            rods,
            seen,
            is_barrier: contact.is_barrier(),
            last: None,
        })
    }

    fn look(&self, simulation: &Simulation) -> Linking {
        let ranges = simulation.rod_ranges();
        let nodes = |rod: &ClosedRod| &simulation.positions()[ranges[rod.index].node_indices()];
        let mut linking = Linking::default();
        linking.add_pairs(&self.rods, nodes);
        for rod in &self.rods {
            linking.own.push(if rod.held {
                0.0
            } else {
                let nodes = nodes(rod);
                linking.looked_at += (nodes.len() * nodes.len() / 2) as u64;
                writhe(nodes, true) + simulation.total_twist(rod.index) / TAU
            });
        }
        linking
    }

    /// Change since the last check, as a sentence.
    fn change(&self, now: &Linking, time: f64) -> Option<String> {
        let time = decimals(time, 6);
        let advice = if self.is_barrier {
            "take smaller time steps"
        } else {
            "take smaller time steps, or contact.model = \"ipc\""
        };
        for (index, (before, now)) in self.seen.pairs.iter().zip(&now.pairs).enumerate() {
            if let Some(other) = (0..index).find(|&other| before[other] != now[other]) {
                return Some(format!(
                    "rods `{}` and `{}` passed through each other before t = {time} s: their linking number was {} \
                     and is {}; {advice}",
                    self.rods[other].name, self.rods[index].name, before[other], now[other]
                ));
            }
        }
        // Clamps that hold a frame may bend a rod so that writhe and twist do not add up to a
        // whole number.
        let mut own = self.seen.own.iter().zip(&now.own);
        let changed = own.position(|(before, now)| (now - before).abs() > 1.0)?;
        Some(format!(
            "rod `{}` passed through itself before t = {time} s: the sum of its writhe and its twist, in turns, was {:.3} and is {:.3}; {advice}",
            self.rods[changed].name, self.seen.own[changed], now.own[changed]
        ))
    }
}

impl Linking {
    fn add_pairs<'a>(&mut self, rods: &[ClosedRod], nodes: impl Fn(&ClosedRod) -> &'a [Vector3]) {
        let boxes: Vec<[Vector3; 2]> = rods.iter().map(|rod| bounds(nodes(rod))).collect();
        for (index, rod) in rods.iter().enumerate() {
            let with = |other: usize| {
                // Curves with disjoint bounding boxes are not linked. The linking of two held
                // curves does not change.
                let apart = rod.held && rods[other].held
                    || (0..3).any(|axis| {
                        boxes[index][0][axis] > boxes[other][1][axis]
                            || boxes[other][0][axis] > boxes[index][1][axis]
                    });
                if apart {
                    return (0, 0);
                }
                let (one, other) = (nodes(rod), nodes(&rods[other]));
                let number = linking_number((one, true), (other, true)).round();
                (number as i64, (one.len() * other.len()) as u64)
            };
            let found: Vec<(i64, u64)> = (0..index).map(with).collect();
            self.looked_at += found.iter().map(|(_, pairs)| pairs).sum::<u64>();
            self.pairs
                .push(found.into_iter().map(|(number, _)| number).collect());
        }
    }
}

/// Lowest and highest corner of the bounding box of points.
fn bounds(points: &[Vector3]) -> [Vector3; 2] {
    let first = [points[0]; 2];
    points.iter().fold(first, |[low, high], point| {
        [low.inf(point), high.sup(point)]
    })
}

impl Observer for LinkingGuard {
    fn name(&self) -> &str {
        "linking"
    }

    fn measure(&mut self, sample: &Sample<'_>, row: &SeriesRow) -> (Vec<Value>, Finding) {
        if let Some([step, wait]) = self.last
            && sample.steps < step + wait
        {
            return (Vec::new(), Finding::GoOn);
        }
        let now = self.look(sample.simulation);
        let nodes = sample.simulation.positions().len() as u64;
        let wait = if now.looked_at > PAIRS_PER_OUTPUT {
            STEPS_PER_PAIR * now.looked_at / nodes
        } else {
            0
        };
        self.last = Some([sample.steps, wait]);
        let finding = match self.change(&now, row.time_s) {
            Some(sentence) => Finding::Fail(sentence),
            None => Finding::GoOn,
        };
        self.seen = now;
        (Vec::new(), finding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::contact::ContactParameters;
    use rodlab_engine::mechanics::dynamics::{IntegrationParameters, StepSize};
    use rodlab_engine::mechanics::scene::{NaturalShape, RodDescription, Stiffness};

    fn closed(name: &str, nodes: usize, point: impl Fn(f64) -> Vector3) -> RodDescription {
        let stiffness = Stiffness {
            stretching: 1e4,
            bending: [1e-4; 2],
            twisting: 1e-4,
        };
        let points = (0..nodes).map(|k| point(k as f64 / nodes as f64 * TAU));
        RodDescription {
            closed: true,
            natural_shape: NaturalShape::AsPlaced,
            ..RodDescription::uniform(name, points.collect(), stiffness, 1e-3, 1e-2)
        }
    }

    fn ring(name: &str, centre: f64, velocity: f64) -> RodDescription {
        RodDescription {
            velocity: velocity * Vector3::x(),
            ..closed(name, 24, |t| {
                // One ring is horizontal, the other vertical.
                let (sine, cosine) = t.sin_cos();
                Vector3::new(centre + 0.05 * cosine, 0.0, 0.0)
                    + 0.05
                        * sine
                        * if name == "lying" {
                            Vector3::y()
                        } else {
                            Vector3::z()
                        }
            })
        }
    }

    /// The guard of rods that pass through each other: it exists with contact; the run has no
    /// contact.
    fn first_failure(rods: Vec<RodDescription>, step: f64, steps: u64) -> Option<String> {
        let scene = Scene {
            rods,
            ..Scene::default()
        };
        assert!(LinkingGuard::of(&scene).is_none());
        let mut guard = LinkingGuard::of(&Scene {
            contact: Some(ContactParameters::default()),
            ..scene.clone()
        })
        .unwrap();
        let parameters = IntegrationParameters {
            step: StepSize::Fixed(step),
            ..IntegrationParameters::default()
        };
        let mut simulation = Simulation::new(&scene, &parameters).unwrap();
        for steps in 0..=steps {
            let sample = Sample {
                simulation: &simulation,
                steps,
                exchange: Default::default(),
            };
            let row = SeriesRow {
                time_s: simulation.time(),
                ..SeriesRow::default()
            };
            if let (_, Finding::Fail(sentence)) = guard.measure(&sample, &row) {
                return Some(sentence);
            }
            simulation.advance(f64::INFINITY).unwrap();
        }
        None
    }

    #[test]
    fn rings_that_become_unlinked_are_reported() {
        let rings = |velocity| vec![ring("lying", 0.0, 0.0), ring("standing", 0.05, velocity)];
        let sentence = first_failure(rings(1.0), 1e-3, 200).unwrap();
        assert!(
            sentence
                .starts_with("rods `lying` and `standing` passed through each other before t = 0."),
            "{sentence}"
        );
        assert_eq!(first_failure(rings(0.0), 1e-3, 200), None);
    }

    #[test]
    fn rods_whose_check_takes_seconds_are_not_guarded() {
        let ring = |nodes: usize| Scene {
            rods: vec![closed("ring", nodes, |t| {
                Vector3::new(t.cos(), t.sin(), 0.0)
            })],
            contact: Some(ContactParameters::default()),
            ..Scene::default()
        };
        assert!(LinkingGuard::of(&ring(5000)).is_some());
        assert!(LinkingGuard::of(&ring(8000)).is_none());
    }

    #[test]
    fn a_rod_that_passes_through_itself_is_told() {
        // A twisted figure eight whose strands cross at the middle and are shot through each
        // other.
        let eight = |height: f64| {
            closed("eight", 48, move |t| {
                Vector3::new(0.1 * (2.0 * t).sin(), 0.1 * t.cos(), height * t.sin())
            })
        };
        let Some(mut guard) = LinkingGuard::of(&Scene {
            rods: vec![eight(0.01)],
            contact: Some(ContactParameters::default()),
            ..Scene::default()
        }) else {
            panic!("a closed rod is guarded");
        };
        let parameters = IntegrationParameters::default();
        let mut look = |height: f64, steps: u64| {
            let scene = Scene {
                rods: vec![eight(height)],
                ..Scene::default()
            };
            let simulation = Simulation::new(&scene, &parameters).unwrap();
            let sample = Sample {
                simulation: &simulation,
                steps,
                exchange: Default::default(),
            };
            guard.measure(&sample, &SeriesRow::default()).1
        };
        assert_eq!(look(0.01, 0), Finding::GoOn);
        assert_eq!(look(0.002, 1000), Finding::GoOn);
        let Finding::Fail(sentence) = look(-0.002, 2000) else {
            panic!("not seen");
        };
        assert!(
            sentence.contains("rod `eight` passed through itself"),
            "{sentence}"
        );
    }
}
