//! Scenes of which a model would be another scene.

use crate::run::PreparedRun;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Clamp, NaturalShape, RodDescription, Scene};

/// Sine of the angle between edges that counts as straight, and relative difference of stiffnesses
/// that counts as none.
const EQUAL: f64 = 1e-9;

/// Rods that a simulator can represent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Abilities {
    /// Name of the simulator.
    pub simulator: &'static str,
    /// Why it has no closed rods, unless it has.
    pub not_closed: Option<&'static str>,
    /// Whether rods may be placed with stress, if they are straight without.
    pub bent: bool,
}

/// Calls `represent` for each rod that moves.
///
/// # Errors
/// The keys of a scene of which a model would mean something else, a sentence each.
pub(super) fn represented<T>(
    prepared: &PreparedRun,
    abilities: Abilities,
    represent: impl Fn(usize) -> T,
) -> Result<Vec<T>, Vec<String>> {
    let scene = &prepared.scene;
    let simulator = abilities.simulator;
    let mut faults = Vec::new();
    if prepared.table.is_some() {
        faults.push("experiment: it fills a table and has no scene of its own to export".into());
    }
    if scene.start.is_some() {
        faults.push(format!(
            "start: models for {simulator} start as placed; leave the table out"
        ));
    }
    if scene.rods.iter().all(|rod| rod.held) {
        faults.push("rods: there is no rod that moves".into());
    }
    if !scene.joints.is_empty() {
        faults.push(format!(
            "joints: models for {simulator} have no joints of rods, which would fall apart"
        ));
    }
    let mut rods = Vec::new();
    for (index, rod) in scene.rods.iter().enumerate() {
        if rod.held {
            continue;
        }
        let before = faults.len();
        let reasons = rod_faults(rod, &clamps_of(scene, index), abilities);
        faults.extend(
            (reasons.into_iter()).map(|(key, reason)| format!("rods.{}.{key}: {reason}", rod.name)),
        );
        if faults.len() == before {
            rods.push(represent(index));
        }
    }
    if faults.is_empty() {
        Ok(rods)
    } else {
        Err(faults)
    }
}

/// The clamps of a rod.
pub(super) fn clamps_of(scene: &Scene, rod: usize) -> Vec<&Clamp> {
    let clamps = scene.clamps.iter();
    clamps.filter(|clamp| clamp.rod == rod).collect()
}

/// Keys of a rod that a simulator cannot represent.
fn rod_faults(
    rod: &RodDescription,
    clamps: &[&Clamp],
    abilities: Abilities,
) -> Vec<(&'static str, String)> {
    let simulator = abilities.simulator;
    let mut faults: Vec<(&'static str, String)> = Vec::new();
    if rod.closed
        && let Some(reason) = abilities.not_closed
    {
        faults.push(("shape", reason.into()));
    }
    let [first, second] = rod.stiffness.bending;
    if (first - second).abs() > EQUAL * first.max(second) {
        faults.push((
            "cross_section",
            format!("the rods of {simulator} are equally stiff in all directions"),
        ));
    }
    if !rod.sections.is_empty() {
        faults.push((
            "sections",
            format!("models for {simulator} have rods with the same section everywhere"),
        ));
    }
    let is_straight = !rod.closed && is_straight(&rod.centreline);
    let without_twist = rod.twist == 0.0;
    let may_be_bent = abilities.bent && !rod.closed;
    let is_representable = match &rod.natural_shape {
        NaturalShape::AsPlaced => true,
        NaturalShape::Straight => (is_straight || may_be_bent) && without_twist,
        NaturalShape::Curved { curvature, twist } => {
            let is_straight_without_stress = *curvature == [0.0; 2] && *twist == 0.0;
            (is_straight || may_be_bent) && is_straight_without_stress && without_twist
        }
        _ => false,
    };
    if !is_representable {
        let allowed = if abilities.bent {
            format!(
                "models for {simulator} have rods without stress as placed, or open rods that are \
                 straight without stress and placed without twist; allowed: \"as-placed\", \
                 \"straight\""
            )
        } else {
            format!("the rods of {simulator} are without stress as placed; allowed: \"as-placed\"")
        };
        faults.push(("natural_shape", allowed));
    }
    let last = rod.centreline.len() - 1;
    let is_inner = |node: usize| rod.closed || (node != 0 && node != last);
    let inner = (clamps.iter()).find(|clamp| clamp.holds_frame && is_inner(clamp.node));
    if let Some(clamp) = inner {
        let node = clamp.node;
        faults.push((
            "name",
            format!(
                "a clamp holds the frame at its inner node {node}; allowed: clamps at its ends"
            ),
        ));
    }
    faults
}

/// Whether all nodes are on a line.
fn is_straight(nodes: &[Vector3]) -> bool {
    nodes.windows(3).all(|nodes| {
        let [before, after] = [nodes[1] - nodes[0], nodes[2] - nodes[1]];
        before.cross(&after).norm() <= EQUAL * before.norm() * after.norm()
    })
}

/// Unit tangent at an end of an open rod: the one given, or the edge turned on by half the angle to
/// its neighbour.
pub(super) fn end_tangent(rod: &RodDescription, end: usize) -> Vector3 {
    let nodes = &rod.centreline;
    let last = nodes.len() - 1;
    let edge = |k: usize| (nodes[k + 1] - nodes[k]).normalize();
    rod.end_tangents[end].unwrap_or_else(|| {
        let (own, neighbour) = match end {
            0 => (edge(0), edge(1.min(last - 1))),
            _ => (edge(last - 1), edge(last.saturating_sub(2))),
        };
        (own * 1.5 - neighbour * 0.5).normalize()
    })
}
