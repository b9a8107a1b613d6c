//! Rods for the grippers of a virtual cell that hang freely in the air.

use super::rod::{RodError, RodSupply, prepared};
use nalgebra::Translation3;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_lab::experiment::RodFile;
use rodlab_planning::plan::deployment::DeployedRod;
use rodlab_robot::Pose;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use toml::toml;

/// Number of edges of a rod that hangs in the air.
const HANGING_EDGES: u32 = 80;
/// Viscosity of the material over Young's modulus, s; the rod swings for about a second.
const VISCOSITY: f64 = 0.05;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;

impl RodSupply {
    /// Rods as a file describes them, with a free part of `length`, m. The user puts the end of
    /// this part into the gripper, so that it hangs straight down in the air. The rest of the rod,
    /// behind the fingers, is not simulated.
    ///
    /// # Errors
    /// Errors of [`Self::new`].
    pub fn hanging(file: &Path, length: f64) -> Result<Self, RodError> {
        let RodFile { rod, density, .. } = RodFile::read(file).map_err(Box::new)?;
        let (radius, youngs_modulus) = (rod.radius, rod.youngs_modulus(density, GRAVITY));
        let viscosity = VISCOSITY * youngs_modulus;
        let (_, prepared) = prepared(
            "rod",
            toml! {
                experiment = "scene"
                material = { youngs_modulus = youngs_modulus, poissons_ratio = 0.5, density = density, viscosity = viscosity }
                rods = [{ name = "rod", radius = radius, edges = HANGING_EDGES, shape = { kind = "straight", start = [0.0, 0.0, 0.0], end = [0.0, 0.0, length] } }]
                clamps = [{ rod = "rod", at = "end" }]
                loads = [{ kind = "gravity", acceleration = [0.0, 0.0, (-GRAVITY)] }]
                time = { scheme = "implicit-euler", step = "5 ms", end = 10.0 }
            },
        )?;
        let up = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -FRAC_PI_2);
        Ok(Self {
            prepared,
            rod: DeployedRod { length, ..rod },
            end: Pose::from_parts(Translation3::new(0.0, 0.0, length), up),
            free_end: None,
            may_hang: false,
            is_free: true,
            fixtures: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::rod::HandOver;
    use super::*;
    use rodlab_lab::identify::HeldRod;

    #[test]
    fn a_rod_in_the_air_follows_its_hand_and_comes_to_rest_in_the_equilibrium_of_its_pose() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rod.toml");
        let text = "[deployment.rod]\ngravito_bending_length = \"3 cm\"\nradius = \"2 mm\"\nlength = \"30 cm\"\n";
        std::fs::write(&path, text).unwrap();
        let supply = RodSupply::hanging(&path, 0.12).unwrap();
        let tilted = |angle: f64| {
            let turn = UnitQuaternion::from_euler_angles(0.0, angle, 0.4);
            let up = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -FRAC_PI_2);
            Pose::from_parts(Translation3::new(0.1, 0.2, 1.0 + 0.1 * angle), turn * up)
        };
        let mut rod = supply
            .handed(&HandOver {
                arm: 0,
                supply: 0,
                hand: tilted(0.0),
                table: Pose::translation(0.3, -0.1, 0.05),
                now: 0.0,
            })
            .unwrap();
        let first = rod.nodes();
        assert!((first[0] - Vector3::new(0.1, 0.2, 0.88)).norm() < 1e-6);
        for step in 1..=1000 {
            let part = (f64::from(step - 200) / 200.0).clamp(0.0, 1.0);
            let hand = tilted(part * FRAC_PI_2);
            while !rod.advance(&hand, 5e-3 * f64::from(step)).unwrap() {}
        }
        let held = HeldRod {
            title: "rod".into(),
            length: 0.12,
            radius: 2e-3,
            density: 1000.0,
            gravito_bending_length: 0.03,
        };
        let expected = held.nodes(&tilted(FRAC_PI_2), [0.03, 0.0, 0.0]).unwrap();
        let [end, rests] = [expected[expected.len() - 1], rod.nodes()[0]];
        assert!((end - rests).norm() < 2e-4, "{end} {rests}");
    }
}
