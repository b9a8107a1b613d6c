//! Films of a results directory: GIF, MP4, or pictures in a folder.

use super::case_folders::{CaseFolder, case_folders};
use super::motion::CaseMotion;
use super::view::{ViewError, rods_in_motion};
use crate::scenario::did_you_mean;
use rodlab_files::figure::{Film, FilmError, FilmOptions, MovieCase};
use rodlab_files::results::{ResultsError, replace_own, write_whole};
use std::fs;
use std::path::{Path, PathBuf};

/// A film to make.
#[derive(Clone, Debug)]
pub struct FilmRequest {
    /// The case of a sweep.
    pub case: Option<String>,
    /// Name of the rod that the camera follows.
    pub follow: Option<String>,
    /// Settings of the film. The followed rod is found by its name.
    pub options: FilmOptions,
}

/// Summary of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenFilm {
    /// Number of pictures of the film.
    pub pictures: usize,
    /// Duration of the film, s.
    pub seconds: f64,
    /// Size of the file or of all files, bytes.
    pub bytes: usize,
}

/// Failure to make a film.
#[derive(Debug, thiserror::Error)]
pub enum MovieError {
    /// The directory shows no rods in motion.
    #[error(transparent)]
    View(#[from] ViewError),
    /// A sweep has several cases, and the user chose none, or one that does not exist.
    #[error("{reason}; choose one of its {} cases with --case: {}", cases.len(), first_few(cases))]
    NoCase {
        /// Reason why no case is chosen.
        reason: String,
        /// Ids of the cases.
        cases: Vec<String>,
    },
    /// No rod has the name.
    #[error(
        "there is no rod `{name}` to follow{}; rods: {}",
        hint(name, rods),
        first_few(rods)
    )]
    NoRod {
        /// The name.
        name: String,
        /// The existing names.
        rods: Vec<String>,
    },
    /// The name of the file does not determine the format.
    #[error(
        "`{}` is not a film or a folder: unknown ending; allowed: a file that ends in .gif or .mp4, or a folder for pictures, such as frames/",
        .0.display()
    )]
    UnknownFormat(PathBuf),
    /// This program was built without the encoder.
    #[error("{}", without_video(.0))]
    WithoutVideo(PathBuf),
    /// The folder holds files other than pictures of a film.
    #[error(
        "`{}` holds `{found}`, which is not a picture of a film; choose another folder or remove it",
        directory.display()
    )]
    NotOwn {
        /// The folder.
        directory: PathBuf,
        /// Contents of the folder.
        found: String,
    },
    /// The film could not be made.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

fn first_few(names: &[String]) -> String {
    const FEW: usize = 8;
    let more = if names.len() > FEW { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(FEW)].join(", "))
}

fn hint(name: &str, known: &[String]) -> String {
    let hint = did_you_mean(name, known.iter().map(String::as_str));
    hint.map_or_else(String::new, |hint| format!("; {hint}"))
}

fn without_video(path: &Path) -> String {
    let gif = path.with_extension("gif");
    let (gif, mp4) = (gif.display(), path.display());
    format!(
        "this program was built without the encoder for MP4; write a GIF with --out {gif}, or pictures with --out frames/ and then run\n  \
         ffmpeg -framerate 30 -i frames/frame_%04d.png -pix_fmt yuv420p {mp4}\n\
         or build rodlab with `cargo build --release --features video`, which needs a C++ compiler"
    )
}

/// Format of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Gif,
    Mp4,
    Pictures,
}

impl Format {
    fn of(path: &Path) -> Result<Self, MovieError> {
        let ending = path
            .extension()
            .map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("gif") => Ok(Self::Gif),
            Some("mp4") if cfg!(feature = "video") => Ok(Self::Mp4),
            Some("mp4") => Err(MovieError::WithoutVideo(path.to_owned())),
            None => Ok(Self::Pictures),
            Some(_) if path.is_dir() || path.to_string_lossy().ends_with('/') => Ok(Self::Pictures),
            Some(_) => Err(MovieError::UnknownFormat(path.to_owned())),
        }
    }
}

/// Maximum number of outputs that a film reads.
const MOST_OUTPUTS: usize = 20_000;
/// Prefix of the temporary folder for pictures.
const UNFINISHED: &str = ".rodlab-unfinished-";

/// Writes a film of a results directory. The ending of `to` sets its format; a name without one is a folder for pictures.
///
/// `watch` is called with the number of pictures done and the total number, and returns whether to
/// continue.
///
/// # Errors
/// [`MovieError`]. The film is written completely or not at all.
pub fn write_film(
    directory: &Path,
    to: &Path,
    request: &FilmRequest,
    watch: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<WrittenFilm, MovieError> {
    let format = Format::of(to)?;
    let manifest = rods_in_motion(directory)?;
    let folder = case_of(directory, request.case.as_deref(), "a film shows")?;
    let motion = CaseMotion::read(&folder, &manifest, MOST_OUTPUTS)?;
    let scene = motion
        .ok_or_else(|| ViewError::NoNodes(directory.to_owned()))?
        .scene();
    let follow = request.follow.as_deref().map(|name| rod_of(&scene, name));
    let options = FilmOptions {
        follow: follow.transpose()?,
        ..request.options.clone()
    };
    let film = Film::new(&scene, &options)?;
    let watch = |done: usize| watch(done, film.pictures());
    let bytes = match format {
        Format::Gif => write_file(to, &film.gif(&watch)?, |head| head.starts_with(b"GIF8"))?,
        Format::Mp4 => write_mp4(to, &film, &watch)?,
        Format::Pictures => write_pictures(to, &film, &watch)?,
    };
    Ok(WrittenFilm {
        pictures: film.pictures(),
        seconds: film.seconds(),
        bytes,
    })
}

/// The requested case, or the only one. `shows`: what shows a case, for messages.
pub(super) fn case_of(
    directory: &Path,
    case: Option<&str>,
    shows: &str,
) -> Result<CaseFolder, MovieError> {
    let mut folders = case_folders(directory)?;
    let names = || folders.iter().map(|folder| folder.name.clone()).collect();
    let found = match case {
        Some(case) => folders.iter().position(|folder| folder.name == case),
        None => (folders.len() == 1).then_some(0),
    };
    let Some(found) = found else {
        return Err(MovieError::NoCase {
            reason: case.map_or_else(
                || format!("`{}` is a sweep, and {shows} one case", directory.display()),
                |case| format!("`{}` has no case `{case}`", directory.display()),
            ),
            cases: names(),
        });
    };
    Ok(folders.swap_remove(found))
}

fn rod_of(scene: &MovieCase, name: &str) -> Result<usize, MovieError> {
    let rod = scene.rods.iter().position(|rod| rod.name == name);
    rod.ok_or_else(|| MovieError::NoRod {
        name: name.to_owned(),
        rods: scene.rods.iter().map(|rod| rod.name.clone()).collect(),
    })
}

fn write_file(
    to: &Path,
    bytes: &[u8],
    is_own: impl Fn(&[u8]) -> bool,
) -> Result<usize, ResultsError> {
    replace_own(to, bytes, is_own)?;
    Ok(bytes.len())
}

#[cfg(feature = "video")]
fn write_mp4(
    to: &Path,
    film: &Film,
    watch: &(dyn Fn(usize) -> bool + Sync),
) -> Result<usize, MovieError> {
    let is_mp4 = |head: &[u8]| head.get(4..8) == Some(b"ftyp");
    Ok(write_file(to, &film.mp4(watch)?, is_mp4)?)
}

#[cfg(not(feature = "video"))]
fn write_mp4(
    to: &Path,
    _film: &Film,
    _watch: &(dyn Fn(usize) -> bool + Sync),
) -> Result<usize, MovieError> {
    Err(MovieError::WithoutVideo(to.to_owned()))
}

/// Writes pictures into a temporary folder, which replaces an earlier one when all pictures are
/// written.
fn write_pictures(
    to: &Path,
    film: &Film,
    watch: &(dyn Fn(usize) -> bool + Sync),
) -> Result<usize, MovieError> {
    check_own_folder(to)?;
    let io = |path: &Path| {
        let path = path.to_owned();
        move |error| MovieError::from(ResultsError::io("write", path)(error))
    };
    let beside = to.parent().filter(|parent| !parent.as_os_str().is_empty());
    let beside = beside.unwrap_or(Path::new("."));
    // The folder removes itself if the film is not completed.
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    let unfinished = builder
        .prefix(UNFINISHED)
        .tempdir_in(beside)
        .map_err(io(to))?;
    let (mut number, mut bytes) = (0, 0);
    film.png_pictures(watch, |picture| {
        number += 1;
        bytes += picture.len();
        let path = unfinished.path().join(format!("frame_{number:04}.png"));
        write_whole(&path, &picture).map_err(|error| FilmError::Encoding(error.to_string()))
    })?;
    if to.exists() {
        fs::remove_dir_all(to).map_err(io(to))?;
    }
    fs::rename(unfinished.keep(), to).map_err(io(to))?;
    Ok(bytes)
}

/// Checks that a folder does not exist yet, or holds only pictures of an earlier film.
fn check_own_folder(to: &Path) -> Result<(), MovieError> {
    let not_own = |found: String| MovieError::NotOwn {
        directory: to.to_owned(),
        found,
    };
    match fs::symlink_metadata(to) {
        Err(_) => return Ok(()),
        Ok(found) if !found.is_dir() => return Err(not_own("a file".into())),
        Ok(_) => {}
    }
    let entries = fs::read_dir(to).map_err(ResultsError::io("read", to))?;
    for entry in entries {
        let name = entry.map_err(ResultsError::io("read", to))?.file_name();
        let name = name.to_string_lossy();
        let number = name
            .strip_prefix("frame_")
            .and_then(|rest| rest.strip_suffix(".png"));
        if !number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit())) {
            return Err(not_own(name.into_owned()));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_set_the_format_and_others_are_refused() {
        let format = |path: &str| Format::of(Path::new(path));
        assert_eq!(format("a.gif").unwrap(), Format::Gif);
        assert_eq!(format("a.GIF").unwrap(), Format::Gif);
        assert_eq!(format("frames/").unwrap(), Format::Pictures);
        assert_eq!(format("out/v1.2/").unwrap(), Format::Pictures);
        assert!(matches!(format("a.avi"), Err(MovieError::UnknownFormat(_))));
        let mp4 = format("a.mp4");
        if cfg!(feature = "video") {
            assert_eq!(mp4.unwrap(), Format::Mp4);
        } else {
            let message = mp4.unwrap_err().to_string();
            for word in ["a.gif", "frames/", "ffmpeg", "--features video"] {
                assert!(message.contains(word), "{message}");
            }
        }
    }

    #[test]
    fn a_folder_with_other_files_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let to = folder.path().join("frames");
        assert!(check_own_folder(&to).is_ok());
        fs::create_dir(&to).unwrap();
        fs::write(to.join("frame_0001.png"), "").unwrap();
        assert!(check_own_folder(&to).is_ok());
        fs::write(to.join("letter.txt"), "").unwrap();
        let error = check_own_folder(&to).unwrap_err();
        assert!(error.to_string().contains("letter.txt"), "{error}");
    }
}
