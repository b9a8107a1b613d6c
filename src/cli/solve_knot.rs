//! `rodlab solve knot-inversion`: the fold of the simplified knot.

use super::prelude::*;
use rodlab_engine::mechanics::kirchhoff::EndSpin;
use rodlab_planning::knot::SimplifiedKnot;

/// Arguments of `rodlab solve knot-inversion`.
#[derive(Debug, Args)]
pub struct KnotInversionArguments {
    /// Unknotting number n of the overhand knot
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=6))]
    unknotting_number: u8,
    /// Whether the ends of the loop may spin about their tangents
    #[arg(long, default_value = "clamped")]
    end_spin: EndSpinArgument,
    /// Poisson's ratio of the rod; it has an effect only with clamped ends
    #[arg(long, value_name = "NU", default_value_t = 0.5, value_parser = within(-0.9, 0.5))]
    poissons_ratio: f64,
    /// Angle φ between the axis of the braid and the ends of the loop, in degrees from 30 to 90
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0, value_parser = within(30.0, 90.0))]
    tilt: f64,
    /// Length of the braid over that of the loop, ε, from 0.4 to 0.9
    #[arg(long, value_name = "EPSILON", default_value_t = 0.7, value_parser = within(0.4, 0.9))]
    ratio: f64,
    /// Distance of the loop's ends from the axis in radii of the rod, from −1 (left-handed strands) to 1
    #[arg(long, default_value_t = 0.0, value_parser = within(-1.0, 1.0), allow_hyphen_values = true)]
    offset: f64,
    /// Radius of the rod, in metres or with a unit; adds lengths in metres to the answer
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    radius: Option<f64>,
}

/// Boundary conditions at the ends of the loop.
#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum EndSpinArgument {
    /// They keep the twist of the planar loop.
    Clamped,
    /// They carry no twisting moment.
    Free,
}

/// The answer: the size at which the knot inverts.
#[derive(Serialize)]
pub struct KnotInversionAnswer {
    length_normalized: f64,
    rotation_rad: f64,
    unknotting_number: u8,
    end_spin: EndSpinArgument,
    tilt_rad: f64,
    braid_over_loop: f64,
    offset_over_radius: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    length_m: Option<f64>,
}

impl KnotInversionArguments {
    /// Solves for the fold.
    pub fn solve(&self) -> Result<KnotInversionAnswer, Failure> {
        let spin = match self.end_spin {
            EndSpinArgument::Clamped => EndSpin::Clamped {
                stiffness_ratio: 1.0 / (1.0 + self.poissons_ratio),
            },
            EndSpinArgument::Free => EndSpin::Free,
        };
        let knot = SimplifiedKnot {
            turns: f64::from(self.unknotting_number),
            tilt: self.tilt.to_radians(),
            ratio: self.ratio,
            offset: self.offset,
            spin,
        };
        let fold = knot.inversion().ok_or_else(|| {
            Failure::Input(
                "this knot has no fold: its loop turns over without a snap, or never".into(),
            )
        })?;
        Ok(KnotInversionAnswer {
            length_normalized: fold.length,
            rotation_rad: fold.rotation,
            unknotting_number: self.unknotting_number,
            end_spin: self.end_spin,
            tilt_rad: knot.tilt,
            braid_over_loop: knot.ratio,
            offset_over_radius: knot.offset,
            length_m: self.radius.map(|radius| fold.length * radius),
        })
    }
}
