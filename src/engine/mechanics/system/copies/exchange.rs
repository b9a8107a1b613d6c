//! Data transfer from systems into the lanes, and of evaluations back to the systems.

use super::super::{Stage, System};
use super::Copies;
use crate::linalg::instruction_set::{LANES, Lanes};
use crate::mechanics::rod::{Original, STRIDE};

/// A system in its stage, with its tolerances.
#[derive(Clone, Copy)]
pub(crate) struct Member<'a> {
    pub system: &'a System,
    pub stage: &'a Stage,
}

impl Copies {
    /// Puts systems into the lanes.
    pub(crate) fn set(&mut self, members: &[Member; LANES]) {
        self.rods.set(&members.map(|member| Original {
            geometry: &member.system.geometry,
            reference: &member.system.reference,
            ghosts: &member.system.ghosts,
        }));
        let assemblies = members.map(|member| &member.system.assembly);
        set_lanes(&mut self.masses, assemblies.map(|own| &own.masses[..]));
        let terms = members.map(|member| &member.system.terms);
        set_lanes(&mut self.loads, terms.map(|own| &own.loads.present[..]));
        set_lanes(&mut self.drag, terms.map(|own| &own.drag.coefficients[..]));
        let stages = members.map(|member| member.stage);
        set_lanes(&mut self.start, stages.map(|own| &own.start[..]));
        set_lanes(&mut self.velocity, stages.map(|own| &own.velocity[..]));
        for (chain, own) in self.shared.iter_mut().enumerate() {
            let shared = assemblies.map(|own| own.consistent.chains[chain].shared.as_flattened());
            set_lanes(&mut own.masses, shared);
        }
        self.step = stages.map(|stage| stage.step);
        self.per_step = stages.map(|stage| 1.0 / stage.step);
        self.per_acceleration_step = stages.map(|stage| 1.0 / stage.acceleration_step);
        for (rod, own) in self.allowances.iter_mut().enumerate() {
            for (lane, Member { system, .. }) in members.iter().enumerate() {
                (own.force[lane], own.weight[lane]) = system.allowance(rod);
                own.per_length[lane] = 1.0 / system.assembly.scales[rod].shortest_edge;
            }
        }
    }

    /// Copies the last evaluation of some lanes to their systems: residual and geometry are then
    /// as if the systems had evaluated themselves.
    pub(crate) fn give(&self, systems: &mut [(usize, &mut System)]) {
        let mut geometries: Vec<_> = (systems.iter_mut())
            .map(|(lane, system)| (*lane, &mut system.geometry, &system.ghosts[..]))
            .collect();
        self.rods.give(&mut geometries);
        for (place, node) in self.residual.chunks(STRIDE).enumerate() {
            for (lane, system) in systems.iter_mut() {
                let own = &mut system.residual[STRIDE * place..][..STRIDE];
                own.iter_mut()
                    .zip(node)
                    .for_each(|(own, lanes)| *own = lanes[*lane]);
            }
        }
    }
}

/// Writes numbers into all lanes.
pub(crate) fn set_lanes(lanes: &mut [Lanes], values: [&[f64]; LANES]) {
    let values = values.map(|values| &values[..lanes.len()]);
    for (k, own) in lanes.iter_mut().enumerate() {
        for lane in 0..LANES {
            own[lane] = values[lane][k];
        }
    }
}
