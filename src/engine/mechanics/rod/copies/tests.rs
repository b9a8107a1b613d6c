//! Rods in lanes, compared with the same rods alone.

use super::super::discretization::GhostEdge;
use super::super::elastic::tests::{NODES, clamped_rod};
use super::super::geometry::RodGeometry;
use super::super::topology::STRIDE;
use super::*;
use crate::linalg::{BandedSymmetric, HALF_BANDWIDTH};

/// Parameters of the rod in a lane.
struct Alone {
    rods: ElasticRods,
    unknowns: Vec<f64>,
    geometry: RodGeometry,
    gradient: Vec<f64>,
    band: BandedSymmetric,
}

#[test]
fn rods_in_lanes_get_the_bytes_that_they_get_alone() {
    let (rods, unknowns, reference, ghost) = clamped_rod();
    let ghosts = [GhostEdge { spin: 0.1, ..ghost }];
    let alone: Vec<Alone> = (0..LANES)
        .map(|lane| {
            let part = 0.03 * lane as f64;
            let mut rods = rods.clone();
            for vertex in &mut rods.vertices {
                vertex.natural.twist += part;
                vertex.stiffness.bending[0] += part;
            }
            (rods.edges.iter_mut()).for_each(|edge| edge.natural_length += part);
            let moved = unknowns.iter().enumerate();
            // Rotations of half a turn and more between reference directors are counted.
            let unknowns = moved.map(|(k, own)| own + part * (k as f64).sin());
            let unknowns: Vec<f64> = unknowns.collect();
            let mut geometry = RodGeometry::new(&rods);
            geometry.update(&rods, &unknowns, &reference, &ghosts);
            let mut gradient = vec![0.0; unknowns.len()];
            let mut band = BandedSymmetric::new(unknowns.len());
            let mut moments = vec![0.0; NODES + 1];
            rods.add_derivatives(&geometry, &mut gradient, &mut band, &mut [], &mut moments);
            Alone {
                rods,
                unknowns,
                geometry,
                gradient,
                band,
            }
        })
        .collect();
    for set in InstructionSet::available() {
        let mut copies = RodCopies::new(&rods).unwrap();
        copies.set = set;
        copies.set(&std::array::from_fn(|lane| Original {
            geometry: &alone[lane].geometry,
            reference: &reference,
            ghosts: &ghosts,
        }));
        let of_lanes = |k: usize| std::array::from_fn(|lane| alone[lane].unknowns[k]);
        let together: Vec<Lanes> = (0..unknowns.len()).map(of_lanes).collect();
        let mut gradient = LaneVector::new(unknowns.len());
        copies.evaluate(&together, &mut gradient);
        let mut columns = vec![[[0.0; LANES]; HALF_BANDWIDTH + 1]; unknowns.len()];
        copies.begin_hessians();
        for vertex in 0..rods.vertices.len() {
            copies.add_vertex(vertex, &mut columns);
        }
        for edge in 0..rods.edges.len() {
            copies.add_edge(edge, &mut columns);
        }
        let mut given: Vec<_> = alone
            .iter()
            .map(|own| RodGeometry::new(&own.rods))
            .collect();
        let lanes = given.iter_mut().enumerate();
        let mut lanes: Vec<_> = lanes.map(|(lane, own)| (lane, own, &ghosts[..])).collect();
        copies.give(&mut lanes);
        for (lane, (alone, given)) in alone.iter().zip(&given).enumerate() {
            for (k, own) in alone.gradient.iter().enumerate() {
                assert_eq!(
                    gradient[k][lane], *own,
                    "{set:?}, lane {lane}: gradient {k}"
                );
            }
            for (j, column) in alone.band.columns().iter().enumerate() {
                let together = columns[j].map(|entry| entry[lane]);
                assert_eq!(together, *column, "{set:?}, lane {lane}: column {j}");
            }
            let edges = |of: &RodGeometry| format!("{:?}", &of.edges[..NODES - 1]);
            assert_eq!(edges(given), edges(&alone.geometry));
            let twists = |of: &RodGeometry| -> Vec<f64> {
                (0..rods.vertices.len())
                    .map(|vertex| of.twist(vertex))
                    .collect()
            };
            assert_eq!(twists(given), twists(&alone.geometry));
            let mut committed = [reference.clone(), reference.clone()];
            for (of, committed) in [given, &alone.geometry].into_iter().zip(&mut committed) {
                of.commit(committed);
            }
            assert_eq!(committed[0], committed[1]);
            assert_eq!(alone.rods.energy(given), alone.rods.energy(&alone.geometry));
            let mut gradient = vec![0.0; STRIDE * NODES];
            alone.rods.add_gradient(given, &mut gradient);
            assert_eq!(
                gradient, alone.gradient,
                "{set:?}, lane {lane}: of what was given"
            );
        }
    }
}
