//! Sources of pictures: files, folders, recordings and cameras.

use super::prelude::*;
use image::RgbImage;
use rodlab_robot::{
    Bag, BagError, BagPicture, CameraError, CameraPicture, PictureTopic, open_camera,
};
use rodlab_vision::{VisionError, decode_picture, pictures_in, read_picture};
use std::time::Duration;

/// Longest wait for a picture from a camera.
const CAMERA_PATIENCE: Duration = Duration::from_secs(5);

/// Selection of pictures of a recording.
#[derive(Clone, Debug, Args)]
pub struct RecordingArguments {
    /// Topic of the pictures of a recording [default: the only one, or the only one in colour]
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// Take every N-th picture of a folder or recording
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
}

/// A picture from a source.
pub struct SourcePicture {
    /// Name in answers and messages.
    pub name: PathBuf,
    /// Folder for its results.
    pub folder: PathBuf,
    /// Time from the first picture of a recording, s.
    pub time: Option<f64>,
    /// The picture, or the reason why it cannot be read.
    pub picture: Result<RgbImage, Failure>,
}

/// Whether a source may have more than one picture.
pub fn is_series(source: &Path) -> bool {
    source.is_dir() || has_ending(source, &["bag"])
}

/// The pictures of a source, in order of time.
pub fn pictures(
    source: &Path,
    recording: &RecordingArguments,
) -> Result<Box<dyn Iterator<Item = SourcePicture>>, Failure> {
    if recording.topic.is_some() && !has_ending(source, &["bag"]) {
        return Err(Failure::Input(format!(
            "--topic is for recordings (.bag); {} is not one",
            source.display()
        )));
    }
    let every = recording.every as usize;
    if source.is_dir() {
        let paths = pictures_in(source)?.into_iter().step_by(every);
        return Ok(Box::new(paths.map(|path| SourcePicture {
            folder: path.file_name().unwrap_or_default().into(),
            time: None,
            picture: read_picture(&path).map_err(Failure::from),
            name: path,
        })));
    }
    if has_ending(source, &["bag"]) {
        let bag = Bag::open(source, recording.topic.as_deref()).or_input()?;
        let path = source.to_owned();
        let taken = bag.enumerate().step_by(every);
        return Ok(Box::new(
            taken.map(move |(number, frame)| recorded(&path, number, frame)),
        ));
    }
    if has_ending(source, &["db3", "mcap"]) {
        return Err(Failure::Input(format!(
            "{source}: recordings of ROS 2 are not read; `rosbags-convert --src {source} --dst {bag}` makes one of ROS 1 of it. \
             Allowed: PNG, JPEG, TIFF, BMP and WebP files, folders of them, bags of ROS 1 (.bag), and cameras",
            source = source.display(),
            bag = source.with_extension("bag").display()
        )));
    }
    Ok(Box::new(std::iter::once(SourcePicture {
        name: source.to_owned(),
        folder: PathBuf::new(),
        time: None,
        picture: single(source),
    })))
}

/// Whether a file name has one of the given extensions.
pub fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| {
        endings
            .iter()
            .any(|known| ending.eq_ignore_ascii_case(known))
    })
}

fn recorded(path: &Path, number: usize, frame: Result<BagPicture, BagError>) -> SourcePicture {
    let folder = PathBuf::from(format!("picture_{number:06}"));
    let name = path.join(&folder);
    let (time, picture) = match frame {
        Ok(frame) => (Some(frame.time), decoded(frame.picture, &name)),
        Err(error) => (None, Err(Failure::input(error))),
    };
    SourcePicture {
        name,
        folder,
        time,
        picture,
    }
}

fn decoded(picture: CameraPicture, name: &Path) -> Result<RgbImage, Failure> {
    match picture {
        CameraPicture::Pixels(picture) => Ok(picture),
        CameraPicture::File(bytes) => decode_picture(&bytes).map_err(|reason| {
            VisionError::Malformed {
                path: name.into(),
                reason,
            }
            .into()
        }),
    }
}

/// The picture in a file, or the next picture of a camera.
fn single(source: &Path) -> Result<RgbImage, Failure> {
    let Some(mut camera) = camera_at(source).transpose()? else {
        return Ok(read_picture(source)?);
    };
    match camera.picture(CAMERA_PATIENCE).map_err(Failure::system)? {
        CameraPicture::Pixels(picture) => Ok(picture),
        CameraPicture::File(bytes) => decode_picture(&bytes)
            .map_err(|reason| Failure::System(format!("{}: {reason}", source.display()))),
    }
}

/// The camera at a source; `None` for a file.
fn camera_at(source: &Path) -> Option<Result<Box<dyn PictureTopic>, Failure>> {
    let opened = open_camera(source.to_str()?)?;
    Some(opened.map_err(|error| match error {
        CameraError::Name(words) => Failure::Input(words),
        CameraError::Driver(error) => Failure::system(error),
    }))
}
