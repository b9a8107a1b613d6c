//! Setup of the rods of a scene in its fluid: filaments, their connections, and nodes that must
//! not start at the same point.

use crate::mechanics::fluid::{
    Connections, Filament, Fluid, FluidError, FluidModel, Sliding, Wall,
};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{RodDescription, RodNode, Scene};
use crate::mechanics::system::{Assembly, copy_positions};
use crate::mechanics::{SceneError, Vector3};

/// Distance, in radii, within which nodes next to a joint may overlap, as those of rods that meet
/// at a small angle do.
const BESIDE_A_JOINT: f64 = 2.0;
/// Distance of nodes, in multiples of ε, below which an error of the fluid names them.
const TOO_CLOSE: f64 = 0.25;

/// The fluid of a scene around its rods; `None` without fluid.
///
/// # Errors
/// [`SceneError::Fluid`] if the fluid or a rod in it is outside the range of the theory, and if
/// nodes start at the same point but may move apart.
pub(super) fn fluid_of(scene: &Scene, assembly: &Assembly) -> Result<Option<Fluid>, SceneError> {
    let Some(model) = scene.fluid else {
        return Ok(None);
    };
    if matches!(model, FluidModel::Quadratic { .. }) {
        return Ok(None);
    }
    // Held rods do not move; they matter only if rods interact through the fluid.
    let are_obstacles = matches!(model, FluidModel::RegularizedStokeslets { .. });
    let rods = || {
        let all = assembly.rods.rods.iter().zip(&scene.rods);
        all.filter(move |(_, rod)| are_obstacles || !rod.held)
    };
    let filaments: Vec<Filament> = rods()
        .map(|(range, rod)| Filament {
            first_node: range.first_node,
            nodes: range.nodes,
            closed: range.closed,
            radius: rod.radius,
        })
        .collect();
    let mut fluid = match wall(scene, assembly)? {
        Some(wall) => Fluid::beside_wall(&model, &filaments, wall)?,
        None => Fluid::new(&model, &filaments)?,
    };
    if rods().any(|(_, rod)| rod.least_radius() < rod.radius) {
        let radii = |rod: &RodDescription| rod.sections.iter().map(|edge| edge.radius).collect();
        fluid.set_edge_radii(rods().map(|(_, rod)| radii(rod)).collect())?;
    }
    let mut positions = vec![Vector3::zeros(); assembly.all_places().end];
    copy_positions(&assembly.unknowns, &mut positions);
    fluid.set_spheres(&assembly.spheres(), &positions)?;
    fluid.connect(&connections(assembly), &positions);
    let names = NodeNames::new(scene, assembly);
    if let Some((node, height)) = fluid.behind_wall(&positions) {
        return Err(SceneError::Fluid(FluidError::BadInput(format!(
            "{} is at the wall of the flow or behind it (height {height:.3e} m), where there is no fluid: place the rod on the \
             free side of the plane, clamp the node, or set planes.wall = false",
            names.of(node)
        ))));
    }
    for pair in fluid.met_by_chance() {
        if may_part(scene, assembly, &positions, pair) {
            let [first, second] = pair.map(|node| names.of(node));
            return Err(SceneError::Fluid(FluidError::BadInput(format!(
                "{first} and {second} start at the same point, where the flow between them has no solution: join them by [[joints]], \
                 clamp both, or place the rods apart"
            ))));
        }
    }
    Ok(Some(fluid))
}

/// Whether edges that spin about their axes move the fluid. They do not next to a wall, since
/// rotlets have no images there, nor in fluids in which nodes do not interact.
pub(super) fn spins_flow(scene: &Scene) -> bool {
    let couples = matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. }));
    scene.spin_drag && couples && scene.wall.is_none()
}

/// The plane at which the fluid of the scene is at rest.
fn wall(scene: &Scene, assembly: &Assembly) -> Result<Option<Wall>, SceneError> {
    let Some(index) = scene.wall else {
        return Ok(None);
    };
    let Some(plane) = scene.planes.get(index) else {
        return Err(SceneError::Unsuitable(
            "the wall of the flow must be one of the planes",
        ));
    };
    let flow = scene.flow.as_ref();
    if flow.is_some_and(|flow| !flow.rests_on(&plane.point, &plane.normal)) {
        return Err(SceneError::Unsuitable(
            "the flow beside a wall must be at rest on the wall, everywhere: use a shear with its \
             plane of rest in the wall or another such flow, or set planes.wall = false",
        ));
    }
    Ok(Some(Wall {
        point: plane.point,
        normal: plane.normal,
        held: (0..assembly.rods.nodes)
            .filter(|node| assembly.held[STRIDE * node])
            .collect(),
    }))
}

/// Names of the nodes of a scene in messages.
pub(super) struct NodeNames {
    /// First node and name of each rod.
    rods: Vec<(usize, String)>,
}

impl NodeNames {
    /// Collects the names of a scene.
    pub(crate) fn new(scene: &Scene, assembly: &Assembly) -> Self {
        let ranges = assembly.rods.rods.iter();
        Self {
            rods: (ranges.zip(&scene.rods))
                .map(|(range, rod)| (range.first_node, rod.name.clone()))
                .collect(),
        }
    }

    fn of(&self, node: usize) -> String {
        let rod = self.rods.partition_point(|(first, _)| *first <= node) - 1;
        let (first, name) = &self.rods[rod];
        format!("node {} of rod `{name}`", node - first)
    }

    /// Adds to an error of the fluid the nodes that cause it, if these are too close to each other
    /// at `positions`.
    pub(crate) fn explain(
        &self,
        error: FluidError,
        fluid: &Fluid,
        positions: &[Vector3],
    ) -> FluidError {
        if let FluidError::BehindWall { node, height, .. } = error {
            let name = self.of(node);
            return FluidError::BehindWall { node, name, height };
        }
        if !matches!(
            error,
            FluidError::Singular | FluidError::NoConvergence { .. }
        ) {
            return error;
        }
        match fluid.nearest_nodes(positions) {
            Some((pair, regularizations)) if regularizations < TOO_CLOSE => {
                let [first, second] = pair.map(|node| self.of(node));
                FluidError::TooClose {
                    first,
                    second,
                    regularizations,
                }
            }
            _ => error,
        }
    }
}

fn connections(assembly: &Assembly) -> Connections {
    Connections {
        joined: assembly.joints.points.clone(),
        sliding: (assembly.joints.slides.iter())
            .map(|slide| Sliding {
                node: slide.node,
                rail: slide.rail(),
                closed: slide.is_closed(),
            })
            .collect(),
    }
}

/// Whether two nodes at one place may move apart freely, as those of two rods inside each other
/// may. They may not if clamps hold both there, or if joints, springs or clamps tie their rods
/// nearby.
fn may_part(scene: &Scene, assembly: &Assembly, positions: &[Vector3], pair: [usize; 2]) -> bool {
    if pair.iter().all(|node| assembly.held[STRIDE * node]) {
        return false;
    }
    let place = |at: RodNode| assembly.rods.rods[at.rod].first_node + at.node;
    let joints = scene.joints.iter().map(|joint| joint.nodes);
    let springs = scene.springs.iter().map(|spring| spring.nodes);
    let rods = pair.map(|node| assembly.locate(node).0);
    let reach = BESIDE_A_JOINT * scene.rods[rods[0]].radius.max(scene.rods[rods[1]].radius);
    let is_near = |node: usize| (positions[node] - positions[pair[0]]).norm() < reach;
    let ties = joints
        .chain(springs)
        .map(|nodes| nodes.map(|at| (at.rod, place(at))))
        .filter(|ends| ends.iter().all(|(_, node)| is_near(*node)));
    let held_pairs = clamped_pairs(scene, assembly, rods)
        .filter(|nodes| nodes.iter().all(|node| is_near(*node)))
        .map(|[a, b]| [(rods[0], a), (rods[1], b)]);
    // The rods connected to the first one through such ties.
    let ties: Vec<[usize; 2]> = ties
        .chain(held_pairs)
        .map(|ends| ends.map(|end| end.0))
        .collect();
    let mut reached: Vec<usize> = Vec::new();
    let mut next = vec![rods[0]];
    while let Some(rod) = next.pop() {
        for tie in ties.iter().filter(|tie| tie.contains(&rod)) {
            let other = if tie[0] == rod { tie[1] } else { tie[0] };
            if !reached.contains(&other) {
                reached.push(other);
                next.push(other);
            }
        }
    }
    !reached.contains(&rods[1])
}

/// Pairs of nodes of two rods that are both held.
fn clamped_pairs(
    scene: &Scene,
    assembly: &Assembly,
    rods: [usize; 2],
) -> impl Iterator<Item = [usize; 2]> {
    let held = rods.map(|rod| {
        let first = assembly.rods.rods[rod].first_node;
        let nodes = first..first + scene.rods[rod].centreline.len();
        let held = nodes.filter(|node| assembly.held[STRIDE * node]);
        held.collect::<Vec<_>>()
    });
    let [of_first, of_second] = held;
    of_first
        .into_iter()
        .flat_map(move |a| of_second.clone().into_iter().map(move |b| [a, b]))
        .filter(|[a, b]| a != b)
}
