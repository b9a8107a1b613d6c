//! Photographs of one rod that is held at one end and turned about its axis there.
//!
//! If the plane of natural curvature of a rod does not contain gravity, the rod bends and twists
//! under its weight, so that its shape also depends on GJ/EI. All photographs share the
//! gravito-bending length, the natural curvature and GJ/EI; each has its own place, direction and
//! turn at the clamp.
//!
//! The visible part of the rod in a photograph depends on the rod, see [`seen`](super::seen), so
//! the fit is repeated with the fitted rod.

use super::data::{At, DataFile};
use super::error::IdentifyError;
use super::exact::Exact;
use super::fit::Loss;
use super::hanging::{
    CURVATURE_KEY, FEWEST, HangingRod, Held, LENGTH_KEY, POINTS, angle_at_start, arc_lengths, data,
    held_rod, measure_hanging,
};
use super::identified::Identified;
use super::parameter::Request;
use super::problem::Experiment;
use super::seen::{Photograph, View};
use super::task::{Task, identify};
use crate::experiment::{case_set_from_text, prepare};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use std::collections::BTreeMap;
use std::path::Path;

/// Key of the twisting stiffness over the bending stiffness.
pub const TWISTING_KEY: &str = "parameters.twisting";
/// Twisting stiffness over the bending stiffness from which the fit starts: the ratio of an
/// incompressible material, also used for a rod that stays in its plane.
const TWISTING: [f64; 2] = [2.0 / 3.0, 100.0];
/// Sine of the turn below which the rod counts as lying in the plane of the photograph.
const TURNED: f64 = 1e-3;
/// Standard deviation of the stated turn, rad.
const ROLL: f64 = 0.0175;
/// Maximum number of fits, and the change of places on the rod, over its length, below which the
/// fit is not repeated.
const ROUNDS: usize = 5;
const SAME: f64 = 1e-4;

/// Fraction of the length by which the rod is shortened to measure the effect of an error at its
/// ends.
const ENDS: f64 = 2e-3;

/// The rod that photographs show.
#[derive(Clone, Debug)]
pub struct Photographed {
    /// The fit.
    pub identified: Identified,
    /// Length of the rod, m.
    pub length: f64,
    /// Change of GJ/EI per relative change of the length if the rod ends earlier than its
    /// photographs show; `None` if GJ/EI is not determined.
    pub twisting_over_ends: Option<f64>,
}

/// Fits one rod of a radius (m) to all photographs. Fits its twisting stiffness, too, if the rod
/// is turned out of its plane.
///
/// # Errors
/// As [`identify`].
pub fn measure_photographs(
    photographs: &[Photograph<'_>],
    radius: f64,
    is_straight: bool,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Photographed, IdentifyError> {
    for one in photographs {
        let lengths = arc_lengths(one.points);
        if one.points.len() < FEWEST || lengths[lengths.len() - 1] <= 0.0 {
            return Err(IdentifyError::Input(format!(
                "{}: the traced rod is too short to be fitted",
                one.picture.display()
            )));
        }
    }
    let is_turned = photographs.iter().any(is_out_of_plane);
    let mut rod = first_rod(photographs, radius, is_straight, goes_on)?;
    rod.twisting = TWISTING[usize::from(!is_turned)];
    let mut views: Vec<View> = photographs
        .iter()
        .map(|one| {
            View::of_the_plane([
                angle_at_start(one.points, &arc_lengths(one.points)),
                one.roll,
            ])
        })
        .collect();
    // The shapes of the first fit determine the foreshortening.
    for (number, view) in views.iter_mut().enumerate() {
        *view = rod.seen(&photographs[number], view)?;
    }
    let mut round = 0;
    loop {
        round += 1;
        let fit = |rod: &mut Rod, views: &[View], shown: f64| {
            rod.fit(photographs, views, [is_straight, is_turned], shown, goes_on)
        };
        let found = fit(&mut rod, &views, 1.0)?;
        let length = rod.length;
        rod.take(&found);
        let mut change = 0.0_f64;
        for (number, view) in views.iter_mut().enumerate() {
            let of = |name: &str| value(&found, &format!("parameters.{name}_{number}"));
            view.angle = of("angle").unwrap_or(view.angle);
            view.roll = of("roll").unwrap_or(view.roll);
            let next = rod.seen(&photographs[number], view)?;
            for (one, other) in next.places.iter().zip(&view.places) {
                change = change.max((one - other).abs());
            }
            *view = next;
        }
        if (change < SAME && round > 1) || round == ROUNDS {
            let of_found = found.parameters.iter();
            let twisting = of_found.clone().find(|one| one.key == TWISTING_KEY);
            let determined = twisting.filter(|one| one.standard_error.is_some());
            let twisting_over_ends = match determined {
                None => None,
                Some(twisting) => {
                    let shorter = fit(&mut rod, &views, 1.0 - ENDS)?;
                    let shorter = value(&shorter, TWISTING_KEY).unwrap_or(twisting.value);
                    Some((shorter - twisting.value) / ENDS)
                }
            };
            return Ok(Photographed {
                identified: found,
                length,
                twisting_over_ends,
            });
        }
    }
}

fn is_out_of_plane(photograph: &Photograph<'_>) -> bool {
    libm::sin(photograph.roll).abs() > TURNED
}

fn value(found: &Identified, key: &str) -> Option<f64> {
    let found = found.parameters.iter().find(|one| one.key == key);
    found.map(|one| one.value)
}

/// The rod, as fitted so far.
struct Rod {
    length: f64,
    radius: f64,
    gravito_bending_length: f64,
    curvature: f64,
    twisting: f64,
}

/// Fits the rod to the photograph that shows it in its plane, if there is one.
fn first_rod(
    photographs: &[Photograph<'_>],
    radius: f64,
    is_straight: bool,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Rod, IdentifyError> {
    let length_of = |one: &Photograph<'_>| arc_lengths(one.points).last().copied().unwrap_or(0.0);
    let longest = photographs.iter().map(length_of).fold(0.0, f64::max);
    let mut rod = Rod {
        length: longest,
        radius,
        gravito_bending_length: libm::cbrt(longest.powi(3) / 20.0),
        // Without a turn, a straight rod would not start to curve to either side.
        curvature: if is_straight { 0.0 } else { 1.0 / longest },
        twisting: TWISTING[0],
    };
    if let Some(flat) = photographs.iter().find(|one| !is_out_of_plane(one)) {
        let hanging = HangingRod {
            picture: flat.picture,
            points: flat.points,
            radius,
            down: flat.down,
            is_straight,
        };
        rod.take(&measure_hanging(&hanging, goes_on)?);
        rod.length = length_of(flat);
    }
    Ok(rod)
}

impl Rod {
    /// Takes over the values of a fit.
    fn take(&mut self, found: &Identified) {
        for (key, own) in [
            (LENGTH_KEY, &mut self.gravito_bending_length),
            (CURVATURE_KEY, &mut self.curvature),
            (TWISTING_KEY, &mut self.twisting),
        ] {
            *own = value(found, key).unwrap_or(*own);
        }
    }

    /// The scenario of a photograph.
    fn scenario(&self, photograph: &Photograph<'_>, view: &View, suffix: &str) -> String {
        held_rod(&Held {
            length: self.length,
            radius: self.radius,
            angle: view.angle,
            down: photograph.down,
            gravito_bending_length: self.gravito_bending_length,
            curvature: self.curvature,
            twisting: self.twisting,
            roll: view.roll,
            suffix,
        })
    }

    /// The rod as a photograph shows it.
    fn seen(&self, photograph: &Photograph<'_>, view: &View) -> Result<View, IdentifyError> {
        let text = self.scenario(photograph, view, "");
        let loaded = case_set_from_text("rod", &text, Path::new(""))?.scenario_of(0)?;
        let run = prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
        let nodes = Simulation::new(&run.scene, &run.integration).and_then(|mut simulation| {
            simulation.find_equilibrium()?;
            Ok(simulation.positions().to_vec())
        });
        let nodes: Vec<Vector3> = nodes.map_err(|source| IdentifyError::Simulation {
            scenario: photograph.picture.display().to_string(),
            source,
        })?;
        Ok(View::of(&nodes, self.length, [view.angle, view.roll]))
    }

    /// Fits it to all photographs; the fraction `shown` of their length is the rod.
    fn fit(
        &mut self,
        photographs: &[Photograph<'_>],
        views: &[View],
        [is_straight, is_turned]: [bool; 2],
        shown: f64,
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Identified, IdentifyError> {
        let curves: Vec<Vec<[f64; 2]>> = photographs
            .iter()
            .zip(views)
            .map(|(photograph, view)| view.without_perspective(photograph))
            .collect();
        // The length is taken from the photograph that shows most of the rod.
        let most = views
            .iter()
            .zip(&curves)
            .fold((0.0, 0.0), |most, (view, curve)| {
                let length = arc_lengths(curve).last().copied().unwrap_or(0.0);
                if view.seen > most.0 {
                    (view.seen, length)
                } else {
                    most
                }
            });
        let length = most.1 / most.0;
        self.length = shown * length;
        let mut keys = vec![request(LENGTH_KEY, length)];
        if !is_straight {
            keys.push(request(CURVATURE_KEY, length));
        }
        if is_turned {
            keys.push(request(TWISTING_KEY, length));
        }
        let mut experiments = Vec::new();
        for (number, (photograph, view)) in photographs.iter().zip(views).enumerate() {
            for name in ["angle", "x0", "y0"] {
                keys.push(request(&format!("parameters.{name}_{number}"), length));
            }
            if is_turned {
                keys.push(Request {
                    prior: Some([photograph.roll, ROLL]),
                    ..request(&format!("parameters.roll_{number}"), length)
                });
            }
            let text = self.scenario(photograph, view, &format!("_{number}"));
            let curve = &curves[number];
            let place = |part: f64| {
                let at = (part * POINTS as f64).round() as usize;
                At::ArcLength((view.places[at] * length).min(self.length))
            };
            experiments.push(Experiment {
                scenario: case_set_from_text("rod", &text, Path::new(""))?,
                files: vec![DataFile {
                    path: photograph.picture.to_owned(),
                    data: data(curve, &arc_lengths(curve), place),
                }],
            });
        }
        let task = Task {
            experiments,
            keys,
            loss: Loss::Huber,
            noise: BTreeMap::new(),
            shared: None,
            windows: 1,
        };
        identify(&task, &Exact::default(), goes_on, &mut |_| {})
    }
}

/// A key with bounds, which also set the scale of the fit.
fn request(key: &str, length: f64) -> Request {
    let is_place = key.contains(".x0") || key.contains(".y0");
    Request {
        key: key.to_owned(),
        bounds: match key {
            CURVATURE_KEY => Some([-20.0 / length, 20.0 / length]),
            _ if is_place => Some([-0.1 * length, 0.1 * length]),
            _ => None,
        },
        prior: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// View of a rod by a camera at an eye, with waves of the size of a pixel added.
    fn photographed(rod: &Rod, roll: f64, eye: Option<[f64; 3]>, waves: f64) -> Vec<[f64; 2]> {
        let view = View::of_the_plane([0.3, roll]);
        let photograph = Photograph {
            picture: Path::new("photo.png"),
            points: &[],
            down: [0.0, -1.0],
            roll,
            eye,
        };
        let text = rod
            .scenario(&photograph, &view, "")
            .replace("edges = 50", "edges = 200");
        let mut simulation = crate::test_support::simulation("rod", &text).unwrap();
        simulation.find_equilibrium().unwrap();
        // The points are one wavelength apart: waves on closer points would make the rod longer.
        let nodes = simulation.positions().iter().step_by(4).enumerate();
        nodes
            .map(|(k, node)| {
                let nearer = eye.map_or(1.0, |[_, _, height]| 1.0 / (1.0 - node.z / height));
                let [x, y] = eye.map_or([0.0; 2], |[x, y, _]| [x, y]);
                let wave = |phase: f64| waves * (2.9 * k as f64 + phase).sin();
                [
                    x + (node.x - x) * nearer + wave(0.0),
                    y + (node.y - y) * nearer + wave(1.0),
                ]
            })
            .collect()
    }

    const ROD: Rod = Rod {
        length: 0.3,
        radius: 1e-3,
        gravito_bending_length: 0.12,
        curvature: 5.0,
        twisting: 0.8,
    };

    fn fitted(shots: &[(f64, Option<[f64; 3]>)]) -> Photographed {
        let curves: Vec<_> = (shots.iter())
            .map(|(roll, eye)| photographed(&ROD, *roll, *eye, 1e-4))
            .collect();
        let photographs: Vec<Photograph<'_>> = (shots.iter().zip(&curves))
            .map(|((roll, eye), points)| Photograph {
                picture: Path::new(if *roll == 0.0 {
                    "front.png"
                } else {
                    "side.png"
                }),
                points,
                down: [0.0, -1.0],
                roll: *roll,
                eye: *eye,
            })
            .collect();
        let found = measure_photographs(&photographs, ROD.radius, false, &|| true).unwrap();
        for one in &found.identified.parameters {
            println!("{} {:.5} ± {:?}", one.key, one.value, one.standard_error);
        }
        println!("length {:.5}", found.length);
        found
    }

    #[test]
    fn the_twisting_stiffness_is_found_from_a_rod_that_is_turned_about_its_clamp() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for eye in [None, Some([0.1, -0.1, 0.7])] {
            let found = fitted(&[(0.0, eye), (quarter, eye)]);
            for (key, truth, part) in [
                (LENGTH_KEY, ROD.gravito_bending_length, 0.01),
                (CURVATURE_KEY, ROD.curvature, 0.03),
                (TWISTING_KEY, ROD.twisting, 0.05),
            ] {
                let found = found.identified.parameters.iter();
                let found = found.clone().find(|one| one.key == key).unwrap();
                let error = found.standard_error.unwrap();
                assert!((found.value / truth - 1.0).abs() < part, "{found:?}");
                // The waves make the rod longer by 0.04 %, an error of all lengths but not of the
                // ratio.
                let is_off = (found.value - truth).abs() > 4.0 * error;
                assert!(key != TWISTING_KEY || !is_off, "{found:?}");
            }
            assert!(
                (found.length / ROD.length - 1.0).abs() < 3e-3,
                "{}",
                found.length
            );
        }
    }

    #[test]
    fn shapes_in_a_plane_leave_the_twisting_stiffness_open() {
        let found = fitted(&[(0.0, None), (0.0, None)]);
        assert_eq!(value(&found.identified, TWISTING_KEY), None);
        let straight = Rod {
            curvature: 0.0,
            ..ROD
        };
        let points = photographed(&straight, 0.0, None, 1e-4);
        let photographs = [0.0, 1.5].map(|roll| Photograph {
            picture: Path::new("photo.png"),
            points: &points,
            down: [0.0, -1.0],
            roll,
            eye: None,
        });
        let found = measure_photographs(&photographs, ROD.radius, true, &|| true).unwrap();
        let [open] = found.identified.undetermined.as_slice() else {
            panic!("{:?}", found.identified.undetermined);
        };
        assert!(
            open.words
                .contains("do not determine `parameters.twisting`"),
            "{open:?}"
        );
    }
}
