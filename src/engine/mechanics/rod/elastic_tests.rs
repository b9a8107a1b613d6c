//! Gradient and Hessian computed in lanes: every instruction set, and both paths to the gradient.

use super::*;
use crate::linalg::instruction_set::InstructionSet;
use crate::mechanics::rod::transport::{any_normal, rotated};
use crate::mechanics::rod::vertex::{VertexStiffness, VertexStrains};
use crate::mechanics::rod::{BendingStrain, GhostEdge, Placement, ReferenceFrames, VertexWeights};

pub(in crate::mechanics::rod) const NODES: usize = 21;

/// A bent and twisted rod with a clamped first node, and frames that lag somewhat behind its
/// present shape.
pub(in crate::mechanics::rod) fn clamped_rod() -> (ElasticRods, Vec<f64>, ReferenceFrames, GhostEdge)
{
    let nodes: Vec<Vector3> = (0..NODES)
        .map(|k| 0.1 * k as f64)
        .map(|s| Vector3::new(s, (2.0 * s).sin() * 0.4, (3.0 * s).cos() * 0.3))
        .collect();
    let placed = Placement::new(&nodes, false, None, 7.0, [None, None]).unwrap();
    let stiffness = VertexStiffness {
        bending: [2.0, 3.0],
        twisting: 1.5,
    };
    let vertex = |before, after, first, from| Vertex {
        before,
        after,
        natural: VertexStrains {
            curvature: [0.1, -0.2, 0.1, -0.2],
            twist: 0.05,
        },
        stiffness,
        strain: match first / (6 * STRIDE) {
            1 => BendingStrain::Angle,
            _ => BendingStrain::Tangent,
        },
        weights: VertexWeights::default(),
        joint_twist: 0.0,
        unknowns: VertexUnknowns::Consecutive {
            first,
            from,
            to: VERTEX_UNKNOWNS,
        },
    };
    let mut vertices = vec![vertex(NODES, 0, 0, STRIDE)];
    vertices.extend((1..NODES - 1).map(|k| vertex(k - 1, k, STRIDE * (k - 1), 0)));
    let edges = (0..NODES - 1).map(|k| Edge {
        start: k,
        end: k + 1,
        natural_length: 1.1 * placed.lengths[k],
        stretching: 40.0,
    });
    let rods = ElasticRods {
        edges: edges.collect(),
        vertices,
        nodes: NODES,
        ghosts: 1,
        ..ElasticRods::default()
    };
    let mut unknowns = vec![0.0; STRIDE * NODES];
    for (k, x) in nodes.iter().enumerate() {
        unknowns[STRIDE * k..STRIDE * k + 3].copy_from_slice(x.as_slice());
        unknowns[STRIDE * k + 3] = placed.angles.get(k).map_or(0.0, |angle| angle + 0.01);
    }
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let behind = |v: &Vector3| rotated(v, &axis, 0.2);
    let padded = |vectors: &[Vector3]| {
        let moved = vectors.iter().map(behind);
        moved.chain([Vector3::zeros()]).collect()
    };
    let reference = ReferenceFrames {
        tangent: padded(&placed.tangents),
        director: padded(&placed.directors),
        twist: vec![0.0; rods.vertices.len()],
    };
    let tangent = Vector3::x();
    let ghost = GhostEdge {
        tangent,
        director: any_normal(&tangent),
        spin: 0.0,
    };
    (rods, unknowns, reference, ghost)
}

#[test]
fn every_instruction_set_gives_the_same_bytes() {
    let (rods, unknowns, reference, ghost) = clamped_rod();
    let results: Vec<_> = InstructionSet::available()
        .map(|set| {
            let mut geometry = RodGeometry::new(&rods);
            geometry.set = set;
            geometry.update(&rods, &unknowns, &reference, &[ghost]);
            let mut gradient = vec![0.0; unknowns.len()];
            let mut band = BandedSymmetric::new(unknowns.len());
            let mut moments = vec![0.0; NODES + 1];
            rods.add_derivatives(&geometry, &mut gradient, &mut band, &mut [], &mut moments);
            let mut only = vec![0.0; unknowns.len()];
            rods.add_gradient(&geometry, &mut only);
            assert_eq!(only, gradient, "{set:?}: the gradient alone");
            (gradient, band.columns().to_vec())
        })
        .collect();
    assert!(results[0].0.iter().all(|entry| entry.is_finite()));
    for result in &results[1..] {
        assert_eq!(*result, results[0]);
    }
}

#[test]
fn the_gradient_is_that_of_the_energy_and_the_hessian_that_of_the_gradient() {
    let (rods, unknowns, reference, ghost) = clamped_rod();
    let mut geometry = RodGeometry::new(&rods);
    let mut evaluate = |unknowns: &[f64]| {
        geometry.update(&rods, unknowns, &reference, &[ghost]);
        let mut gradient = vec![0.0; unknowns.len()];
        let mut band = BandedSymmetric::new(unknowns.len());
        let mut moments = vec![0.0; NODES + 1];
        rods.add_derivatives(&geometry, &mut gradient, &mut band, &mut [], &mut moments);
        (rods.energy(&geometry).total(), gradient, band)
    };
    let (_, gradient, band) = evaluate(&unknowns);
    let size = gradient.iter().fold(0.0, |size: f64, g| size.max(g.abs()));
    let stiffness = (0..unknowns.len()).fold(0.0, |size: f64, k| size.max(band.get(k, k).abs()));
    let difference = 1e-5;
    for k in 0..unknowns.len() {
        let mut moved = unknowns.clone();
        moved[k] += difference;
        let (energy_above, above, _) = evaluate(&moved);
        moved[k] -= 2.0 * difference;
        let (energy_below, below, _) = evaluate(&moved);
        let slope = (energy_above - energy_below) / (2.0 * difference);
        assert!((gradient[k] - slope).abs() < 1e-7 * size, "gradient {k}");
        for i in 0..unknowns.len() {
            let slope = (above[i] - below[i]) / (2.0 * difference);
            let error = band.get(i, k) - slope;
            assert!(error.abs() < 1e-7 * stiffness, "Hessian ({i}, {k})");
        }
    }
}
