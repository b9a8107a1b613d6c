use super::*;
use crate::mechanics::fluid::{Fluid, FluidModel};
use std::f64::consts::PI;

const VISCOSITY: f64 = 0.7;
const RADIUS: f64 = 0.3;
const THIN: f64 = 0.01;
const STOKESLETS: FluidModel = FluidModel::RegularizedStokeslets {
    viscosity: VISCOSITY,
    regularization: 1.02,
    far_field_error: 0.0,
};
const RESISTIVE: FluidModel = FluidModel::Resistive {
    viscosity: VISCOSITY,
};

/// Straight filaments, with a sphere on the first node of each; the tips of the spheres follow all
/// nodes.
struct Setting {
    filaments: Vec<Filament>,
    spheres: Vec<Sphere>,
    positions: Vec<Vector3>,
}

impl Setting {
    /// Filaments along x, given by start, length and number of nodes.
    fn new(rods: &[(Vector3, f64, usize)]) -> Self {
        let total: usize = rods.iter().map(|rod| rod.2).sum();
        let (mut filaments, mut spheres, mut positions) = (Vec::new(), Vec::new(), Vec::new());
        for (number, &(start, length, nodes)) in rods.iter().enumerate() {
            let first_node = positions.len();
            filaments.push(Filament {
                first_node,
                nodes,
                closed: false,
                radius: THIN,
            });
            spheres.push(Sphere {
                centre: first_node,
                radius: RADIUS,
                first_tip: total + 3 * number,
                arm: 0.05,
            });
            let step = length / (nodes - 1) as f64;
            positions.extend((0..nodes).map(|k| start + Vector3::x() * (step * k as f64)));
        }
        for _ in rods {
            positions.extend([Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * 0.05));
        }
        Self {
            filaments,
            spheres,
            positions,
        }
    }

    fn fluid(&self, model: &FluidModel) -> Fluid {
        let mut fluid = Fluid::new(model, &self.filaments).unwrap();
        fluid.set_spheres(&self.spheres, &self.positions).unwrap();
        fluid
    }

    /// Velocities of a rigid-body motion of the whole setting.
    fn moving(&self, velocity: Vector3, spin: Vector3) -> Vec<Vector3> {
        let nodes = self.positions.len() - 3 * self.spheres.len();
        let places = self.positions.iter().enumerate();
        places
            .map(|(place, x)| {
                spin.cross(x)
                    + if place < nodes {
                        velocity
                    } else {
                        Vector3::zeros()
                    }
            })
            .collect()
    }

    fn drag(&self, fluid: &mut Fluid, velocities: &[Vector3]) -> (Vec<Vector3>, Vec<Matrix3>) {
        let mut forces = vec![Vector3::zeros(); self.positions.len()];
        let mut resistance = vec![Matrix3::zeros(); self.positions.len()];
        fluid
            .drag(
                &self.positions,
                velocities,
                &[],
                &mut forces,
                &mut resistance,
            )
            .unwrap();
        (forces, resistance)
    }

    /// Torque of the forces on the tips of a sphere.
    fn torque(&self, sphere: usize, forces: &[Vector3]) -> Vector3 {
        let tips = self.spheres[sphere].tips().into_iter();
        tips.map(|tip| self.positions[tip].cross(&forces[tip]))
            .sum()
    }
}

#[test]
fn a_sphere_that_hides_its_rod_has_the_drag_and_torque_of_stokes() {
    let setting = Setting::new(&[(Vector3::zeros(), 0.8 * RADIUS, 4)]);
    let (velocity, spin) = (Vector3::new(0.3, -0.1, 0.2), Vector3::new(2.0, 1.0, -1.0));
    for model in [STOKESLETS, RESISTIVE] {
        let mut fluid = setting.fluid(&model);
        let (forces, resistance) = setting.drag(&mut fluid, &setting.moving(velocity, spin));
        let force: Vector3 = forces[..4].iter().sum();
        let stokes = velocity * (-6.0 * PI * VISCOSITY * RADIUS);
        assert!((force - stokes).norm() < 1e-5 * stokes.norm(), "{force}");
        let torque = setting.torque(0, &forces);
        let expected = spin * (-8.0 * PI * VISCOSITY * RADIUS.powi(3));
        assert!(
            (torque - expected).norm() < 1e-5 * expected.norm(),
            "{torque}"
        );
        assert!((resistance[0].m11 / (6.0 * PI * VISCOSITY * RADIUS) - 1.0).abs() < 1e-12);
        assert_eq!(resistance[1], Matrix3::zeros());
    }
}

/// Stimson and Jeffery 1926: two equal spheres that move along the line of their centres, 3.7622 diameters apart, have 0.836 times
/// the drag of one alone.
#[test]
fn two_spheres_in_a_row_shelter_each_other_as_by_stimson_and_jeffery() {
    let apart = Vector3::x() * (2.0 * RADIUS * 3.7622);
    let setting = Setting::new(&[
        (Vector3::zeros(), 0.5 * RADIUS, 2),
        (apart, 0.5 * RADIUS, 2),
    ]);
    let mut fluid = setting.fluid(&STOKESLETS);
    let (forces, _) = setting.drag(&mut fluid, &setting.moving(Vector3::x(), Vector3::zeros()));
    let alone = 6.0 * PI * VISCOSITY * RADIUS;
    for centre in [0, 2] {
        assert!(
            (-forces[centre].x / alone - 0.836).abs() < 2e-3,
            "{}",
            forces[centre].x / alone
        );
    }
}

#[test]
fn sphere_and_tail_act_on_each_other_alike_and_take_energy() {
    let setting = Setting::new(&[(Vector3::zeros(), 4.0 * RADIUS, 33)]);
    let mut fluid = setting.fluid(&STOKESLETS);
    let places = setting.positions.len();
    let mut numbers = crate::random::uniform_numbers(3);
    // The test motions are smooth: rough motions differ by the error of collocation.
    let mut motion = || -> Vec<Vector3> {
        let [a, b, c] = [0; 3].map(|_| Vector3::from_fn(|_, _| numbers() - 0.5));
        let bent = |x: &Vector3| a + b * x.x + c * (x.x * x.x);
        let mut velocities: Vec<Vector3> = setting.positions.iter().map(bent).collect();
        let spin = Vector3::from_fn(|_, _| numbers() - 0.5);
        for tip in setting.spheres[0].tips() {
            velocities[tip] = spin.cross(&setting.positions[tip]);
        }
        velocities
    };
    let (first, second) = (motion(), motion());
    let (of_first, _) = setting.drag(&mut fluid, &first);
    let (of_second, _) = setting.drag(&mut fluid, &second);
    let power = |forces: &[Vector3], velocities: &[Vector3]| -> f64 {
        (0..places).map(|k| forces[k].dot(&velocities[k])).sum()
    };
    assert!(power(&of_first, &first) < 0.0 && power(&of_second, &second) < 0.0);
    let taken = fluid.dissipation().unwrap() + power(&of_second, &second);
    assert!(
        taken.abs() < 1e-9 * power(&of_second, &second).abs(),
        "{taken}"
    );
    let [there, back] = [power(&of_first, &second), power(&of_second, &first)];
    let scale = (power(&of_first, &first) * power(&of_second, &second)).sqrt();
    assert!(
        (there - back).abs() < 0.01 * scale,
        "{there} {back} {scale}"
    );
}

#[test]
fn a_restored_flow_with_a_sphere_continues_bit_for_bit() {
    let setting = Setting::new(&[(Vector3::zeros(), 4.0 * RADIUS, 12)]);
    let mut fluid = setting.fluid(&STOKESLETS);
    let [first, second] = [Vector3::x(), Vector3::new(0.2, 0.9, -0.3)]
        .map(|velocity| setting.moving(velocity, Vector3::y()));
    setting.drag(&mut fluid, &first);
    let mut restored = setting.fluid(&STOKESLETS);
    restored.restore(fluid.memory()).unwrap();
    let [on, again] = [&mut fluid, &mut restored].map(|fluid| setting.drag(fluid, &second).0);
    assert_eq!(on, again);
}

#[test]
fn spheres_that_overlap_and_spheres_beside_a_wall_are_refused() {
    let close = Setting::new(&[
        (Vector3::zeros(), 0.5 * RADIUS, 2),
        (Vector3::y() * (1.9 * RADIUS), 0.5 * RADIUS, 2),
    ]);
    let mut fluid = Fluid::new(&STOKESLETS, &close.filaments).unwrap();
    let error = fluid.set_spheres(&close.spheres, &close.positions);
    assert!(error.unwrap_err().to_string().contains("overlap"));
    let single = Setting::new(&[(Vector3::z(), 0.5 * RADIUS, 2)]);
    let wall = crate::mechanics::fluid::Wall {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        held: Vec::new(),
    };
    let mut fluid = Fluid::beside_wall(&STOKESLETS, &single.filaments, wall).unwrap();
    let error = fluid.set_spheres(&single.spheres, &single.positions);
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("planes.wall = false")
    );
}
