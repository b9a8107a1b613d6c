//! The vertex energy, its gradient and Hessian, compared with dual numbers: random states far from
//! the source frames, curved and twisted natural shapes, over decades of length.

use super::*;
use crate::mechanics::rod::transport::{any_normal, parallel_transport, rotated, signed_angle};
use crate::mechanics::rod::turning_angle::AngleRatio;
use crate::mechanics::rod::vertex_hessian::{
    VertexHessian, hessian as hessian_blocks, hessian_of_angle,
};
use crate::mechanics::rod::{BendingStrain, Vertex, VertexUnknowns, VertexWeights};
use nalgebra::SVector;
use num_dual::{DualNum, hessian};

type Vec3<D> = [D; 3];

fn dot<D: DualNum<Primitive = f64> + Copy>(a: &Vec3<D>, b: &Vec3<D>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross<D: DualNum<Primitive = f64> + Copy>(a: &Vec3<D>, b: &Vec3<D>) -> Vec3<D> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
fn combine<D: DualNum<Primitive = f64> + Copy>(a: &Vec3<D>, x: D, b: &Vec3<D>, y: D) -> Vec3<D> {
    [
        a[0] * x + b[0] * y,
        a[1] * x + b[1] * y,
        a[2] * x + b[2] * y,
    ]
}
fn constant<D: DualNum<Primitive = f64> + Copy>(v: &Vector3) -> Vec3<D> {
    [D::from(v.x), D::from(v.y), D::from(v.z)]
}
fn transported<D: DualNum<Primitive = f64> + Copy>(
    v: &Vec3<D>,
    from: &Vec3<D>,
    to: &Vec3<D>,
) -> Vec3<D> {
    let factor = dot(v, to) / (dot(from, to) + 1.0);
    let sum = combine(from, D::one(), to, D::one());
    combine(v, D::one(), &sum, -factor)
}

/// A random but reproducible vertex: source frames, natural strains, stiffness.
struct Setup {
    source: [Vector3; 2],
    director: [Vector3; 2],
    reference_twist_near: f64,
    natural: VertexStrains,
    strain: BendingStrain,
    stiffness: VertexStiffness,
}

/// The energy as a function of (e⁰, θ⁰, e¹, θ¹), straight from its definition.
fn energy<D: DualNum<Primitive = f64> + Copy>(x: SVector<D, 8>, setup: &Setup) -> D {
    let mut tangents = [[D::zero(); 3]; 2];
    let mut references = [[D::zero(); 3]; 2];
    let mut directors = [[[D::zero(); 3]; 2]; 2];
    for j in 0..2 {
        let e = [x[4 * j], x[4 * j + 1], x[4 * j + 2]];
        let length = dot(&e, &e).sqrt();
        let t = [e[0] / length, e[1] / length, e[2] / length];
        let d = transported(
            &constant(&setup.director[j]),
            &constant(&setup.source[j]),
            &t,
        );
        let normal = cross(&t, &d);
        let theta = x[4 * j + 3];
        directors[j] = [
            combine(&d, theta.cos(), &normal, theta.sin()),
            combine(&normal, theta.cos(), &d, -theta.sin()),
        ];
        tangents[j] = t;
        references[j] = d;
    }
    let chi = dot(&tangents[0], &tangents[1]) + 1.0;
    let c = chi / 2.0;
    let factor = match setup.strain {
        BendingStrain::Tangent => D::one(),
        BendingStrain::Angle => (c * 9.0 - c * c * 2.0 + 8.0) / 15.0,
    };
    let binormal = cross(&tangents[0], &tangents[1]).map(|c| c * factor * 2.0 / chi);
    let mut total = D::zero();
    for j in 0..2 {
        let kappa = [
            dot(&directors[j][1], &binormal),
            -dot(&directors[j][0], &binormal),
        ];
        for a in 0..2 {
            let difference = kappa[a] - setup.natural.curvature[2 * j + a];
            total += difference * difference * (0.5 * setup.stiffness.bending[a]);
        }
    }
    let carried = transported(&references[0], &tangents[0], &tangents[1]);
    let raw =
        dot(&cross(&carried, &references[1]), &tangents[1]).atan2(dot(&carried, &references[1]));
    let turns = ((setup.reference_twist_near - raw.re()) / std::f64::consts::TAU).round();
    let twist = x[7] - x[3] + raw + turns * std::f64::consts::TAU;
    let difference = twist - setup.natural.twist;
    total + difference * difference * (0.5 * setup.stiffness.twisting)
}

fn frame_at(
    edge: Vector3,
    theta: f64,
    source: &Vector3,
    director: &Vector3,
) -> (EdgeFrame, Vector3) {
    let (length, tangent) = (edge.norm(), edge.normalize());
    let reference = parallel_transport(director, source, &tangent);
    let director_1 = rotated(&reference, &tangent, theta);
    let holonomy = source.cross(&tangent) * (-1.0 / ((1.0 + source.dot(&tangent)) * length));
    (
        EdgeFrame {
            tangent,
            length,
            inverse_length: 1.0 / length,
            director_1,
            director_2: tangent.cross(&director_1),
            holonomy,
        },
        reference,
    )
}

#[test]
fn derivatives_match_dual_numbers() {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    for trial in 0..400 {
        let strain = [BendingStrain::Tangent, BendingStrain::Angle][trial as usize % 2];
        let scale = 10f64.powi(trial % 5 - 3);
        let edge = |random: &mut dyn FnMut() -> f64| {
            Vector3::new(1.0 + 0.6 * random(), random(), 0.8 * random()) * scale
        };
        let (e0, e1) = (edge(&mut random), edge(&mut random));
        // Source tangents up to about half a radian away from the present ones; every third time
        // they are equal.
        let mut source = |e: &Vector3| {
            let away = if trial % 3 == 0 { 0.0 } else { 0.5 };
            (e.normalize() + Vector3::new(random(), random(), random()) * away).normalize()
        };
        let source = [source(&e0), source(&e1)];
        let director = source.map(|s| rotated(&any_normal(&s), &s, 1.3 * random()));
        let (theta_0, theta_1) = (3.0 * random(), 20.0 * random());
        let (before, reference_0) = frame_at(e0, theta_0, &source[0], &director[0]);
        let (after, reference_1) = frame_at(e1, theta_1, &source[1], &director[1]);
        let setup = Setup {
            source,
            director,
            reference_twist_near: theta_0 - theta_1,
            natural: VertexStrains {
                curvature: [random(), random(), random(), random()],
                twist: random(),
            },
            strain,
            stiffness: VertexStiffness {
                bending: [1.0 + random(), 1.3 + random()],
                twisting: 0.9 + 0.5 * random(),
            },
        };
        let carried = parallel_transport(&reference_0, &before.tangent, &after.tangent);
        let raw = signed_angle(&carried, &reference_1, &after.tangent);
        let twist = theta_1 - theta_0
            + crate::mechanics::rod::transport::unwrapped(raw, setup.reference_twist_near);
        let strains = VertexStrains {
            curvature: curvatures(&before, &after),
            twist,
        };

        let x = SVector::<f64, 8>::from([e0.x, e0.y, e0.z, theta_0, e1.x, e1.y, e1.z, theta_1]);
        let (value, expected_gradient, expected_hessian) = hessian(|x| energy(x, &setup), &x);

        let vertex = Vertex {
            before: 0,
            after: 1,
            natural: setup.natural,
            strain,
            stiffness: setup.stiffness,
            weights: VertexWeights::default(),
            joint_twist: 0.0,
            unknowns: VertexUnknowns::Closing { element: 0 },
        };
        let (bending, twisting) = vertex.energies(&strains);
        assert!(((bending + twisting) / value - 1.0).abs() < 1e-11);

        // Lengths are in units of the edge, so that forces and moments have comparable sizes.
        let unit = |k: usize| if k % 4 == 3 { 1.0 } else { scale };
        let ours = vertex.gradient([&before, &after], &strains);
        let blocks = match strain {
            BendingStrain::Tangent => {
                hessian_blocks(&before, &after, &strains, &setup.natural, &setup.stiffness)
            }
            BendingStrain::Angle => {
                let c = 0.5 * (1.0 + before.tangent.dot(&after.tangent));
                let ratio = AngleRatio::of(c, 1.0);
                let moments =
                    Moments::new(&ratio.turning(&strains), &setup.natural, &setup.stiffness);
                let kappa = &strains.curvature;
                hessian_of_angle(&before, &after, kappa, &moments, &ratio, &setup.stiffness)
            }
        };
        let moments = [ours.phi0, ours.phi1];
        let ours = entries(&ours);
        let size = (0..8)
            .map(|i| (expected_gradient[i] * unit(i)).abs())
            .fold(0.0, f64::max);
        for i in 0..8 {
            assert!(
                ((ours[i] - expected_gradient[i]) * unit(i)).abs() < 1e-10 * size,
                "gradient {i}"
            );
        }
        let ours = with_holonomy(&blocks, &moments, &setup.source, &[before, after]);
        let size = (0..8)
            .flat_map(|i| (0..8).map(move |j| (i, j)))
            .map(|(i, j)| (expected_hessian[(i, j)] * unit(i) * unit(j)).abs())
            .fold(0.0, f64::max);
        for i in 0..8 {
            for j in 0..=i {
                let error = (ours[i][j] - expected_hessian[(i, j)]) * unit(i) * unit(j);
                assert!(
                    error.abs() < 1e-9 * size,
                    "trial {trial}: Hessian ({i}, {j}) is off by {error:e} of {size:e}"
                );
            }
        }
    }
}

fn entries(gradient: &VertexGradient) -> [f64; 8] {
    let (e0, e1) = (&gradient.e0, &gradient.e1);
    [
        e0.x,
        e0.y,
        e0.z,
        gradient.phi0,
        e1.x,
        e1.y,
        e1.z,
        gradient.phi1,
    ]
}

/// Lower triangle of the whole Hessian, with (∂E/∂φ)∇c, which the rods add once per edge.
fn with_holonomy(
    blocks: &VertexHessian,
    moments: &[f64; 2],
    source: &[Vector3; 2],
    edges: &[EdgeFrame; 2],
) -> [[f64; 8]; 8] {
    let mut full = [[0.0; 8]; 8];
    let holonomy = |j: usize| {
        crate::mechanics::rod::holonomy::holonomy_hessian(&source[j], &edges[j], moments[j])
    };
    let (e0e0, e1e1) = (blocks.e0e0 + holonomy(0), blocks.e1e1 + holonomy(1));
    for i in 0..3 {
        for j in 0..3 {
            full[i][j] = e0e0[(i, j)];
            full[4 + i][j] = blocks.e1e0[(i, j)];
            full[4 + i][4 + j] = e1e1[(i, j)];
        }
        full[3][i] = blocks.e0phi0[i];
        full[7][i] = blocks.e0phi1[i];
        full[4 + i][3] = blocks.e1phi0[i];
        full[7][4 + i] = blocks.e1phi1[i];
    }
    full[3][3] = blocks.phi0phi0;
    full[7][3] = blocks.phi1phi0;
    full[7][7] = blocks.phi1phi1;
    full
}
