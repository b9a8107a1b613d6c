//! Resolving probes and the condition that ends a run.

use crate::scenario::resolved::{
    AtPlace, Between, OneRod, OneSpring, PressedRod, Probe, ProbeKind, StopWhen, Summary, TwoNodes,
    TwoRods,
};
use crate::scenario::section::Section;
use crate::scenario::typed;

/// Resolves all probes.
pub fn probes(top: &Section<'_>, typed: &[typed::Probe]) -> Vec<Probe> {
    let mut probes: Vec<Probe> = Vec::new();
    for (section, typed) in top.elements("probes", typed) {
        let Some(probe) = probe(&section, typed) else {
            continue;
        };
        if probes.iter().any(|other| other.name == probe.name) {
            let message = format!(
                "another probe is called `{}`; names must differ",
                probe.name
            );
            section.fault("name", message);
        }
        probes.push(probe);
    }
    probes
}

fn probe(section: &Section<'_>, typed: &typed::Probe) -> Option<Probe> {
    use typed::Probe as Typed;
    let at_node = |probe: &typed::NodeProbe| AtPlace {
        rod: probe.rod.clone(),
        at: super::load::place(section, probe.at).into(),
    };
    let along = |rod: &Option<String>, at: Option<typed::TypedPlace>| AtPlace {
        rod: rod.clone(),
        at: at.map(|at| section.place("at", at)),
    };
    let section_probe = |probe: &typed::SectionProbe| along(&probe.rod, probe.at);
    let edge_probe = |probe: &typed::EdgeProbe| along(&probe.rod, probe.at);
    let one_rod = |probe: &typed::RodProbe| OneRod {
        rod: probe.rod.clone(),
    };
    let (name, summary): (&Option<String>, Option<Summary>) = match typed {
        Typed::Position(probe)
        | Typed::Displacement(probe)
        | Typed::Velocity(probe)
        | Typed::Reaction(probe) => (&probe.name, probe.summary),
        Typed::BendingMoment(probe)
        | Typed::TwistingMoment(probe)
        | Typed::Curvature(probe)
        | Typed::Twist(probe) => (&probe.name, probe.summary),
        Typed::Tension(probe) | Typed::Torsion(probe) => (&probe.name, probe.summary),
        Typed::Distance(probe) => (&probe.name, probe.summary),
        Typed::ContactForce(probe) => (&probe.name, probe.summary),
        Typed::Energy(probe) | Typed::Writhe(probe) | Typed::ArcLength(probe) => {
            (&probe.name, probe.summary)
        }
        Typed::LinkingNumber(probe) => (&probe.name, probe.summary),
        Typed::SpringForce(probe) => (&probe.name, probe.summary),
    };
    let name = name_of_columns(section, name);
    let kind = match typed {
        Typed::Position(probe) => ProbeKind::Position(at_node(probe)),
        Typed::Displacement(probe) => ProbeKind::Displacement(at_node(probe)),
        Typed::Velocity(probe) => ProbeKind::Velocity(at_node(probe)),
        Typed::Reaction(probe) => ProbeKind::Reaction(at_node(probe)),
        Typed::Distance(probe) => ProbeKind::Distance(between(section, probe)),
        Typed::Tension(probe) => ProbeKind::Tension(edge_probe(probe)),
        Typed::Torsion(probe) => ProbeKind::Torsion(edge_probe(probe)),
        Typed::BendingMoment(probe) => ProbeKind::BendingMoment(section_probe(probe)),
        Typed::TwistingMoment(probe) => ProbeKind::TwistingMoment(section_probe(probe)),
        Typed::Curvature(probe) => ProbeKind::Curvature(section_probe(probe)),
        Typed::Twist(probe) => ProbeKind::Twist(section_probe(probe)),
        Typed::ContactForce(probe) => ProbeKind::ContactForce(pressed_rod(section, probe)),
        Typed::Energy(probe) => ProbeKind::Energy(one_rod(probe)),
        Typed::Writhe(probe) => ProbeKind::Writhe(one_rod(probe)),
        Typed::ArcLength(probe) => ProbeKind::ArcLength(one_rod(probe)),
        Typed::LinkingNumber(probe) => {
            let rod = section.needed("rod", probe.rod.clone(), "the name of a rod");
            let other = section.needed("to_rod", probe.to_rod.clone(), "the name of another rod");
            ProbeKind::LinkingNumber(TwoRods {
                rod: rod?,
                to_rod: other?,
            })
        }
        Typed::SpringForce(probe) => {
            let help = "the name of a joint of kind = \"spring\"";
            let joint = section.needed("joint", probe.joint.clone(), help)?;
            ProbeKind::SpringForce(OneSpring { joint })
        }
    };
    Some(Probe {
        name: name?,
        kind,
        summary,
    })
}

/// A name that columns can begin with; `None` if it is none, which is reported.
fn name_of_columns(section: &Section<'_>, name: &Option<String>) -> Option<String> {
    let name = section.needed(
        "name",
        name.clone(),
        "the name with which the columns begin",
    )?;
    let allowed =
        |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_';
    let begins = name.starts_with(|letter: char| letter.is_ascii_lowercase());
    if !begins || !name.chars().all(allowed) || name.ends_with('_') {
        let message = format!(
            "`{name}` cannot begin the name of a column; allowed: small letters, digits and underscores, a letter first \
             and no underscore last"
        );
        section.fault("name", message);
        return None;
    }
    Some(name)
}

fn between(section: &Section<'_>, probe: &typed::DistanceProbe) -> Between {
    let nodes = match (probe.at, probe.to) {
        (Some(at), Some(to)) => Some(TwoNodes {
            at: section.place("at", at),
            to: section.place("to", to),
        }),
        (None, None) => None,
        (at, _) => {
            let (key, rod) = if at.is_some() {
                ("to", "other")
            } else {
                ("at", "one")
            };
            let help = format!(
                "the node of the {rod} rod; without `at` and `to` the least distance of two rods"
            );
            section.missing(key, help);
            None
        }
    };
    if nodes.is_none() && probe.at.is_none() && probe.to.is_none() {
        if probe.to_rod.is_none() {
            section.missing(
                "to_rod",
                "the name of the other rod, or the nodes `at` and `to`",
            );
        } else if probe.to_rod == probe.rod {
            section.fault(
                "to_rod",
                "a rod has no distance from itself; give the nodes `at` and `to`",
            );
        }
    }
    Between {
        rod: probe.rod.clone(),
        to_rod: probe.to_rod.clone(),
        nodes,
    }
}

fn pressed_rod(section: &Section<'_>, probe: &typed::ContactForceProbe) -> PressedRod {
    if probe.from_rod.is_some() && probe.from_plane.is_some() {
        section.fault(
            "from_plane",
            "either a rod or a plane presses; leave one of the keys out",
        );
    }
    if probe.from_obstacle.is_some() && (probe.from_rod.is_some() || probe.from_plane.is_some()) {
        section.fault(
            "from_obstacle",
            "either a rod, a plane or an obstacle presses; leave the other keys out",
        );
    }
    let plane = |number: i64| section.number_from_zero("from_plane", number);
    PressedRod {
        rod: probe.rod.clone(),
        from_rod: probe.from_rod.clone(),
        from_plane: probe.from_plane.and_then(plane),
        from_obstacle: probe.from_obstacle.clone(),
    }
}

/// Resolves the condition that ends a run.
pub fn stop_when(top: &Section<'_>, typed: Option<&typed::StopWhen>) -> Option<StopWhen> {
    let typed = typed?;
    let section = top.below("stop_when");
    let probe = section.needed(
        "probe",
        typed.probe.clone(),
        "the name of a probe or of one of its columns",
    );
    match (typed.above, typed.below) {
        (None, None) => section.missing("above", "a number, `above` or `below` which the run ends"),
        (Some(_), Some(_)) => section.fault(
            "below",
            "either `above` or `below`; leave one of the keys out",
        ),
        _ => {}
    }
    for (key, number) in [("above", typed.above), ("below", typed.below)] {
        if number.is_some_and(|number| !number.is_finite()) {
            section.fault(key, "out of range; allowed: any finite number");
        }
    }
    Some(StopWhen {
        probe: probe?,
        above: typed.above,
        below: typed.below,
    })
}
