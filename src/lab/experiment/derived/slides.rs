//! Apparent friction of nodes that slide along rods and catch at the edges, from the weights in
//! the scene.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{LARGEST_CATCH, apparent_friction};
use rodlab_engine::mechanics::scene::{LoadKind, RodNode, Scene};
use serde::Serialize;

/// A node that slides along a rod.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedSlide {
    /// Name of the rod that slides.
    pub name: String,
    /// Name of the rod along which it slides.
    pub rail: String,
    /// Mean edge length of the rail, m.
    pub edge: f64,
    /// Estimate of the force across the rail due to weights and other loads, N.
    pub force: f64,
    /// Apparent friction coefficient of the edges under that force.
    pub apparent_friction: f64,
}

impl DerivedSlide {
    /// Returns a warning if the edges are too long for that force.
    pub fn warning(&self) -> Option<String> {
        let Self {
            name,
            rail,
            edge,
            apparent_friction,
            ..
        } = self;
        (*apparent_friction > LARGEST_CATCH).then(|| {
            format!(
                "the edges of rod `{rail}` are too long for `{name}`, which slides along it: they catch it like a friction coefficient of about {apparent_friction:.2}; with edges of {:.2e} m it would be {LARGEST_CATCH}",
                edge * (LARGEST_CATCH / apparent_friction).sqrt()
            )
        })
    }
}

/// All slides of a scene along rods that can bend.
pub fn derived_slides(scene: &Scene) -> Vec<DerivedSlide> {
    let slides = scene.joints.iter().filter(|joint| joint.kind.slides());
    let bent = slides.filter(|joint| !scene.rods[joint.nodes[1].rod].held);
    bent.map(|joint| {
        let [slider, place] = joint.nodes;
        let rail = &scene.rods[place.rod];
        let edges = rail.centreline.len() - usize::from(!rail.closed);
        let length: f64 = (0..edges)
            .map(|edge| {
                let next = (edge + 1) % rail.centreline.len();
                (rail.centreline[next] - rail.centreline[edge]).norm()
            })
            .sum();
        let edge = length / edges as f64;
        let force = force_across(scene, slider, place);
        let bending = rail.stiffness.bending[0].min(rail.stiffness.bending[1]);
        DerivedSlide {
            name: scene.rods[slider.rod].name.clone(),
            rail: rail.name.clone(),
            edge,
            force,
            apparent_friction: apparent_friction(force, edge, bending),
        }
    })
    .collect()
}

/// The load on the sliding rod, if that hangs on the rail; otherwise the fraction of the load on
/// the rail that is deflected there.
fn force_across(scene: &Scene, slider: RodNode, place: RodNode) -> f64 {
    let sliding = group(scene, slider.rod);
    if !is_borne(scene, &sliding) {
        return load_on(scene, &sliding);
    }
    let mut pulled = group(scene, place.rod);
    for joint in &scene.joints {
        if joint.kind.slides() && joint.nodes[1].rod == place.rod {
            let other = group(scene, joint.nodes[0].rod);
            if !is_borne(scene, &other) {
                pulled.extend(other);
            }
        }
    }
    load_on(scene, &pulled) * half_turn_sine(&scene.rods[place.rod].centreline, place.node)
}

/// Sine of half the turning angle of a polyline at a node.
fn half_turn_sine(nodes: &[Vector3], node: usize) -> f64 {
    if node == 0 || node + 1 >= nodes.len() {
        return 0.0;
    }
    let before = (nodes[node] - nodes[node - 1]).normalize();
    let after = (nodes[node + 1] - nodes[node]).normalize();
    0.5 * (after - before).norm()
}

/// A rod with all rods that are joined to it, except by slides and springs.
fn group(scene: &Scene, rod: usize) -> Vec<usize> {
    let mut group = vec![rod];
    let mut next = 0;
    while let Some(&one) = group.get(next) {
        next += 1;
        for joint in scene.joints.iter().filter(|joint| !joint.kind.slides()) {
            let ends = joint.nodes.map(|node| node.rod);
            let other = if ends[0] == one { ends[1] } else { ends[0] };
            if ends.contains(&one) && !group.contains(&other) {
                group.push(other);
            }
        }
    }
    group
}

/// Whether a clamp or a held rod supports one of these rods.
fn is_borne(scene: &Scene, rods: &[usize]) -> bool {
    let clamped = scene.clamps.iter().filter(|clamp| clamp.holds_position);
    rods.iter().any(|rod| scene.rods[*rod].held)
        || clamped.into_iter().any(|clamp| rods.contains(&clamp.rod))
}

/// Weights, dead forces and distributed loads on some rods, at full magnitude, N.
fn load_on(scene: &Scene, rods: &[usize]) -> f64 {
    let length = |rod: usize| -> f64 {
        let nodes = scene.rods[rod].centreline.windows(2);
        nodes.map(|pair| (pair[1] - pair[0]).norm()).sum()
    };
    let of_rods = rods
        .iter()
        .map(|&rod| scene.rods[rod].mass_per_length * length(rod));
    let bodies = scene
        .bodies
        .iter()
        .filter(|body| rods.contains(&body.at.rod));
    let mass = of_rods.sum::<f64>() + bodies.map(|body| body.mass).sum::<f64>();
    let mut force = Vector3::zeros();
    for load in &scene.loads {
        match load.kind {
            LoadKind::Gravity { acceleration } => force += acceleration * mass,
            LoadKind::Force {
                rod, force: own, ..
            } if rods.contains(&rod) => force += own,
            LoadKind::Distributed {
                rod,
                force_per_length,
            } => {
                let on = rods.iter().filter(|own| rod.is_none_or(|rod| rod == **own));
                force += force_per_length * on.map(|&rod| length(rod)).sum::<f64>();
            }
            _ => {}
        }
    }
    force.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rail_catches_by_the_sine_of_half_of_its_turn() {
        for turn in [0.1_f64, 1.0, 2.5] {
            let nodes = [
                Vector3::zeros(),
                2.0 * Vector3::x(),
                Vector3::new(2.0 + 0.3 * turn.cos(), 0.0, 0.3 * turn.sin()),
            ];
            let expected = (0.5 * turn).sin();
            assert!((half_turn_sine(&nodes, 1) - expected).abs() < 1e-12);
            assert_eq!(half_turn_sine(&nodes, 0), 0.0);
            assert_eq!(half_turn_sine(&nodes, 2), 0.0);
        }
    }
}
