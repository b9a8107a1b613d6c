//! A rod that a task has laid, from its results directory, to score its picture again.

use super::deploy_record::{DeployScore, PATTERN, stroke_folder};
use super::error::WorkError;
use super::look::Seen;
use crate::cell::Cell;
use image::RgbImage;
use rodlab_files::results::MANIFEST;
use rodlab_robot::{Pose, pose};
use rodlab_vision::{
    ColourRule, Point, SCORE_POINTS, SeenLength, part_of_curve, read_curve, score,
};
use serde::Deserialize;
use std::fmt::Display;
use std::fs;
use std::path::Path;

/// What the picture of a laid rod is compared with.
pub struct LaidRod {
    /// Folder of its stroke in the results; empty if it is the only one.
    pub name: String,
    /// The frame of the pattern in the cell.
    pub frame: Pose,
    /// Radius of the rod, m.
    pub radius: f64,
    length: f64,
    /// Smallest length that the picture must show, m.
    least: f64,
    /// Length of rod before the pattern, m.
    lead_in: f64,
    /// Start of the rod in the frame of the pattern, m.
    start: Point,
    pattern: Vec<Point>,
    /// The score in the results.
    pub recorded: Option<DeployScore>,
}

/// The rod in a picture, and its score.
pub struct Rescored {
    /// The rod in the frame of the pattern, m.
    pub rod: Vec<Point>,
    /// Its length.
    pub length: SeenLength,
    /// Its distances from the pattern.
    pub score: DeployScore,
}

/// The part of `manifest.json` that is read.
#[derive(Deserialize)]
#[serde(untagged)]
enum Manifest {
    Several { strokes: Vec<Laid> },
    One(Laid),
}

#[derive(Deserialize)]
struct Laid {
    motion: Place,
    seen_length: Option<Seeable>,
    score: Option<DeployScore>,
}

#[derive(Deserialize)]
struct Place {
    place_position: [f64; 3],
    place_quaternion: [f64; 4],
}

#[derive(Deserialize)]
struct Seeable {
    least_m: f64,
}

/// The part of `plan/landing.toml` that is read.
#[derive(Deserialize)]
struct Landing {
    deployment: Deployment,
}

#[derive(Deserialize)]
struct Deployment {
    #[serde(default)]
    lead_in: f64,
    rod: Rod,
}

#[derive(Deserialize)]
struct Rod {
    radius: f64,
    length: f64,
}

impl LaidRod {
    /// Reads the rods in the results of `rodlab deploy` or `rodlab place`, which have a picture;
    /// none for those of another task.
    ///
    /// # Errors
    /// A file is missing or damaged.
    pub fn read(directory: &Path) -> Result<Vec<Self>, WorkError> {
        let path = directory.join(MANIFEST);
        let manifest = match serde_json::from_str(&text(&path)?) {
            Ok(manifest) => manifest,
            // The manifest of another task.
            Err(_) => return Ok(Vec::new()),
        };
        let rods = match manifest {
            Manifest::One(laid) => vec![(String::new(), laid)],
            Manifest::Several { strokes } => {
                let strokes = strokes.into_iter().enumerate();
                strokes
                    .map(|(index, laid)| (stroke_folder(index), laid))
                    .collect()
            }
        };
        let has_pattern = |(name, _): &(String, Laid)| directory.join(name).join(PATTERN).is_file();
        let rods = rods.into_iter().filter(has_pattern);
        rods.map(|(name, laid)| Self::of(&directory.join(&name), name, laid))
            .collect()
    }

    fn of(directory: &Path, name: String, laid: Laid) -> Result<Self, WorkError> {
        let landing = directory.join("plan/landing.toml");
        let Landing { deployment } =
            toml::from_str(&text(&landing)?).map_err(|error| damaged(&landing, &error))?;
        let Place {
            place_position,
            place_quaternion,
        } = laid.motion;
        let frame = pose(place_position, place_quaternion)
            .ok_or_else(|| damaged(directory, &"`place_quaternion` is no rotation"))?;
        let path = read_curve(&directory.join("plan/pattern.csv"), None)?;
        let rod = deployment.rod;
        Ok(Self {
            name,
            frame,
            radius: rod.radius,
            length: rod.length,
            least: laid.seen_length.map_or(rod.length, |seen| seen.least_m),
            lead_in: deployment.lead_in,
            start: path[0],
            pattern: read_curve(&directory.join(PATTERN), None)?,
            recorded: laid.score,
        })
    }

    /// Finds the rod in a picture, and scores it.
    ///
    /// # Errors
    /// The picture does not show the whole rod.
    pub fn score(
        &self,
        picture: &RgbImage,
        cell: &Cell,
        colour: &ColourRule,
    ) -> Result<Rescored, WorkError> {
        let seen = Seen::of(picture, cell, &self.frame, self.radius, colour)?;
        let rod = match self.name.is_empty() {
            true => seen.longest(self.start)?,
            false => seen.from(self.start)?,
        };
        let length = SeenLength::of(&rod, self.length).with_least(self.least);
        if !length.is_whole() {
            return Err(WorkError::NotSeenWhole(length.to_string()));
        }
        let part = part_of_curve(&rod, self.lead_in, &self.pattern)?;
        let score = score(&part, &self.pattern, SCORE_POINTS, false)?;
        Ok(Rescored {
            rod,
            length,
            score: DeployScore {
                by_arc_length: score.by_arc_length,
                by_nearest_point: score.by_nearest_point,
            },
        })
    }
}

fn text(path: &Path) -> Result<String, WorkError> {
    fs::read_to_string(path).map_err(|error| damaged(path, &error))
}

fn damaged(path: &Path, error: &dyn Display) -> WorkError {
    WorkError::Failed(format!("{}: {error}", path.display()))
}
