//! Advice on failed steps, limited to what the scene contains.

use super::failure::{Crossing, Failure, Forces};
use super::parameters::{IntegrationParameters, Scheme, StepSize};
use crate::mechanics::contact::ContactModel;
use crate::mechanics::system::System;

/// Properties of a scene and its time steps that select the advice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Means {
    /// The contact model; `None` without contact.
    pub contact: Option<ContactModel>,
    /// Whether any contact has friction.
    pub friction: bool,
    /// Whether a rod is in a fluid.
    pub fluid: bool,
    /// The scheme.
    pub scheme: Scheme,
    /// Whether steps have a fixed size.
    pub fixed: bool,
}

impl Means {
    /// Collects the properties from a scene. `fluid`: whether a fluid contains rods.
    pub(crate) fn of(system: &System, parameters: &IntegrationParameters, fluid: bool) -> Self {
        let contact = system.contact();
        Self {
            contact: contact.map(|contact| contact.parameters().model),
            friction: contact.is_some_and(|contact| contact.largest_friction() > 0.0),
            fluid,
            scheme: parameters.scheme,
            fixed: matches!(parameters.step, StepSize::Fixed(_)),
        }
    }

    /// Whether contact forces are functions of the gaps, within tolerances.
    fn has_soft_contact(&self) -> bool {
        matches!(
            self.contact,
            Some(ContactModel::ImplicitContact | ContactModel::IncrementalPotential)
        )
    }

    /// Completes a sentence about the steps that are needed with advice on how to choose them.
    fn steps(&self, needed: &str) -> String {
        if self.fixed {
            format!("{needed}; use time.step = \"auto\" to choose them")
        } else {
            needed.to_owned()
        }
    }
}

impl Failure {
    /// Advice for scenes with these properties in which steps fail repeatedly with this failure;
    /// empty if there is none.
    pub(crate) fn advice(&self, means: &Means) -> String {
        let mut choices = Vec::new();
        match self {
            Self::Newton(_) => {
                if means.has_soft_contact() && means.friction {
                    choices.push("a larger contact.slip_tolerance");
                }
                if means.has_soft_contact() {
                    choices.push("a larger contact.distance_tolerance");
                }
                if means.fluid && means.scheme != Scheme::ImplicitEuler {
                    choices.push("time.scheme = \"implicit-euler\"");
                }
                if means.fixed {
                    choices.push("time.step = \"auto\"");
                }
            }
            Self::Penetration { .. } => {
                if means.fixed {
                    choices.push("smaller steps");
                }
                if means.contact != Some(ContactModel::IncrementalPotential) {
                    choices.push("contact.model = \"ipc\"");
                }
            }
            Self::NoDrag { .. } => choices.extend(["longer edges", "smaller steps"]),
            Self::NoPush { .. } => choices.push("smaller steps"),
            Self::Work {
                forces: Forces::Drag,
                ..
            } => choices.extend(["rods farther apart", "shorter edges"]),
            Self::NoContactForces { .. } => {
                choices.extend(["contact.model = \"imc\"", "contact.model = \"ipc\""]);
            }
            Self::Crossing {
                crossing: Crossing::Extrapolation,
                ..
            } => choices.push("time.scheme = \"implicit-euler\""),
            Self::Crossing {
                crossing: Crossing::Clamp,
                ..
            } => choices.push("a slower motion of the clamp"),
            Self::Work {
                forces: Forces::Elastic,
                ..
            } => {
                return means
                    .steps("rotating rods need steps in which they turn by at most 0.1 rad");
            }
            Self::Turn { .. } => {
                return means
                    .steps("snapping rods need steps in which no edge turns by more than 2 rad");
            }
            Self::Work { .. } | Self::Crossing { .. } => {
                return means
                    .steps("impacts need steps in which nodes move by at most about one radius");
            }
        }
        match choices.split_last() {
            None => String::new(),
            Some((last, [])) => format!("try {last}"),
            Some((last, others)) => format!("try {} or {last}", others.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::barrier_tests::crossing;
    use super::super::tests::heavy_cantilever;
    use super::*;
    use crate::mechanics::scene::{Plane, Scene};
    use crate::mechanics::system::{Divergence, Turn};
    use crate::mechanics::test_support::fixed;
    use crate::mechanics::{Overlap, Vector3};

    /// A failure of every kind that can occur in a scene with these properties.
    fn failures(means: &Means) -> Vec<Failure> {
        let iterations = 40;
        let mut all = vec![
            Failure::Newton(Divergence {
                iterations,
                residual: 1.0,
                unknown: 0,
            }),
            Failure::Work {
                iterations,
                forces: Forces::Elastic,
                work: 1.0,
            },
            Failure::Turn {
                iterations,
                turn: Turn {
                    what: String::new(),
                    angle: 3.0,
                    consequence: "",
                },
            },
        ];
        if means.contact.is_none() {
            return all;
        }
        let crossings = [
            Crossing::Clamp,
            Crossing::Passage([String::new(), String::new()]),
        ];
        all.extend(crossings.map(|crossing| Failure::Crossing {
            iterations,
            crossing,
        }));
        all.push(Failure::Work {
            iterations,
            forces: Forces::Contact,
            work: 1.0,
        });
        all.push(Failure::Penetration {
            iterations,
            overlap: Overlap {
                first: String::new(),
                second: String::new(),
                distance: 0.0,
                least: 1.0,
                exclusive: false,
            },
        });
        if means.contact == Some(ContactModel::Complementarity) {
            all.push(Failure::NoContactForces { iterations });
        }
        if means.scheme == Scheme::ImplicitMidpoint {
            all.push(Failure::Crossing {
                iterations,
                crossing: Crossing::Extrapolation,
            });
        }
        all
    }

    fn means_of(scene: &Scene, parameters: &IntegrationParameters, fluid: bool) -> Means {
        Means::of(&System::new(scene).unwrap(), parameters, fluid)
    }

    #[test]
    fn advice_names_only_what_the_scene_has() {
        use ContactModel::{Complementarity, ImplicitContact, IncrementalPotential};
        use Scheme::{BackwardDifferences, ImplicitEuler, ImplicitMidpoint};
        let bare = heavy_cantilever(10);
        // The words that the advice for a scene may contain.
        let (slip, gap, model) = ("slip_tolerance", "distance_tolerance", "contact.model");
        let scenes = [
            (bare.clone(), vec![]),
            (crossing(ImplicitContact, 1e-6, 0.0), vec![gap, model]),
            (crossing(ImplicitContact, 1e-6, 0.3), vec![slip, gap, model]),
            (crossing(IncrementalPotential, 1e-6, 0.0), vec![gap]),
            (crossing(IncrementalPotential, 1e-6, 0.3), vec![slip, gap]),
            (crossing(Complementarity, 1e-6, 0.3), vec![model]),
        ];
        let automatic = StepSize::Auto {
            tolerance: 1e-2,
            maximum: 1e-3,
        };
        let mut looked_at = 0;
        for (scene, allowed) in &scenes {
            for scheme in [ImplicitEuler, ImplicitMidpoint, BackwardDifferences] {
                for (step, fluid) in [
                    (StepSize::Fixed(1e-3), false),
                    (StepSize::Fixed(1e-3), true),
                    (automatic, false),
                    (automatic, true),
                ] {
                    let parameters = IntegrationParameters {
                        scheme,
                        step,
                        ..fixed(1e-3)
                    };
                    let means = means_of(scene, &parameters, fluid);
                    for failure in failures(&means) {
                        let advice = failure.advice(&means);
                        for word in [slip, gap, model] {
                            let fits = allowed.contains(&word) || !advice.contains(word);
                            assert!(fits, "{means:?} {failure:?}: {advice}");
                        }
                        let is_automatic = step == automatic;
                        assert!(
                            !(is_automatic && advice.contains("auto")),
                            "{failure:?}: {advice}"
                        );
                        assert!(
                            !(scheme == ImplicitEuler && advice.contains("euler")),
                            "{failure:?}: {advice}"
                        );
                        looked_at += 1;
                    }
                }
            }
        }
        assert!(looked_at > 300, "{looked_at}");
    }

    #[test]
    fn friction_of_a_plane_counts_as_friction() {
        let mut scene = crossing(ContactModel::ImplicitContact, 1e-6, 0.0);
        assert!(!means_of(&scene, &fixed(1e-3), false).friction);
        scene.planes.push(Plane {
            point: Vector3::z() * -1.0,
            normal: Vector3::z(),
            friction: Some(0.2),
            directed_friction: None,
        });
        let means = means_of(&scene, &fixed(1e-3), false);
        let advice = failures(&means)[0].advice(&means);
        assert!(advice.contains("slip_tolerance"), "{advice}");
    }

    #[test]
    fn a_swimmer_is_advised_on_its_steps_and_its_scheme() {
        let means = Means {
            contact: None,
            friction: false,
            fluid: true,
            scheme: Scheme::BackwardDifferences,
            fixed: true,
        };
        let advice = failures(&means)[0].advice(&means);
        assert_eq!(
            advice,
            "try time.scheme = \"implicit-euler\" or time.step = \"auto\""
        );
    }
}
