//! Boundary of the flow of a scene, and the parts that it leaves out.

use crate::scenario::{Issue, KeyPath, Scenario};
use rodlab_engine::mechanics::fluid::FluidModel;
use rodlab_engine::mechanics::scene::Scene;

/// Chooses the plane that is the wall of the flow. Planes of the experiment come before those of the scenario.
///
/// # Errors
/// Two planes that are walls, or a wall in a fluid model without walls.
pub(super) fn wall(scene: &Scene, scenario: &Scenario) -> Result<Option<usize>, Issue> {
    let built = scene.planes.len() - scenario.planes.len();
    let key = |index: usize| KeyPath::from("planes").index(index).key("wall");
    if !matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. })) {
        let mut planes = scenario.planes.iter();
        return match planes.position(|plane| plane.wall == Some(true)) {
            Some(index) => Err(Issue::new(
                key(index),
                "only the fluid of model \"rss\" has walls; take that model, or leave the key out",
            )),
            None => Ok(None),
        };
    }
    let of_scenario = scenario.planes.iter().enumerate();
    let mut walls = (0..built).chain(
        of_scenario
            .filter(|(_, plane)| plane.wall != Some(false))
            .map(|(index, _)| built + index),
    );
    let first = walls.next();
    match walls.next() {
        None => Ok(first),
        Some(second) => Err(Issue::new(
            key(second - built),
            "only one plane can be a wall of the flow, because images \
             are exact for a single plane; set wall = false for the other planes (the fluid then \
             passes through them)",
        )),
    }
}

/// Parts of a scene that the flow leaves out by default, a sentence each.
pub(super) fn left_out(scene: &Scene, scenario: &Scenario) -> Vec<String> {
    let Some(model) = scene.fluid else {
        return Vec::new();
    };
    let built = scene.planes.len() - scenario.planes.len();
    let is_asked_for = |index: usize| match index.checked_sub(built) {
        Some(own) => scenario.planes[own].wall != Some(false),
        None => true,
    };
    let has_walls = matches!(model, FluidModel::RegularizedStokeslets { .. });
    let is_quadratic = matches!(model, FluidModel::Quadratic { .. });
    let has_no_walls = !has_walls && !is_quadratic;
    let planes = (0..scene.planes.len()).filter(|&index| has_no_walls && is_asked_for(index));
    let planes = planes.map(|index| {
        format!(
            "plane {index} is not part of the flow: the fluid of model \"resistive\" has no walls; take \"rss\", or set planes.wall = false"
        )
    });
    let obstacles = scene.obstacles.iter().map(|obstacle| {
        format!(
            "obstacle `{}` is not part of the flow: the fluid moves as if it were absent",
            obstacle.name
        )
    });
    let bodies = (scenario.bodies.iter())
        .filter(|body| body.shape.is_some() && (is_quadratic || body.ball().is_none()))
        .map(|body| match is_quadratic {
            true => format!("body `{}` has no drag: the model \"quadratic\" has the drag of rods only", body.name),
            false => format!(
                "body `{}` is not part of the flow, which has only spheres with the centre at their node: the fluid moves as if it were absent",
                body.name
            ),
        });
    let is_spun = (scene.clamps.iter()).any(|clamp| {
        let motion = &clamp.motion;
        clamp.holds_frame && (motion.angular_velocity != 0.0 || !motion.angle.is_empty())
    });
    let spin = (scene.spin_drag && scene.wall.is_some() && is_spun).then(|| {
        "the flow includes the torque on rods that spin about their own axes, but not the motion of the fluid that this spin causes near the wall".to_owned()
    });
    planes.chain(obstacles).chain(bodies).chain(spin).collect()
}
