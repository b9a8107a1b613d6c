//! `rodlab movie`.

use super::interruption::watch_for_interruption;
use super::prelude::*;
use indicatif::ProgressBar;
use rodlab_files::figure::{FilmOptions, Pace};
use rodlab_lab::report::{FilmRequest, write_film};
use rodlab_lab::scenario::angle;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab movie results/flagella_quick --out flagella.gif
  rodlab movie results/flagella_quick --out flagella.mp4 --turn 90deg
  rodlab movie results/whip --out whip.gif --size 640x360 --speed 0.2    five times slower
  rodlab movie results/knot --out frames/ --from 30,20        frames/frame_0001.png and so on
  rodlab movie results/sweep --case friction-0.3 --out slide.gif",
    "\
Positions between outputs are interpolated linearly. The projection is orthographic, so that the
scale bar holds everywhere. GIF files of long films are large: choose a smaller --size and --fps.
`--turn 360deg` shows rods at rest from all sides. MP4 needs a program that was built with
`--features video`; without it, ffmpeg makes an MP4 from pictures:
  ffmpeg -framerate 30 -i frames/frame_%04d.png -pix_fmt yuv420p film.mp4"
);

/// Arguments of `rodlab movie`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct MovieArguments {
    /// The results directory of a run or a sweep, finished or still running
    pub directory: PathBuf,
    /// Output: a file that ends in .gif or .mp4, or a folder for pictures, such as frames/
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// The case of a sweep, by its id
    #[arg(long, value_name = "ID")]
    pub case: Option<String>,
    /// Width and height, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = size)]
    pub size: [usize; 2],
    /// Pictures per second
    #[arg(long, value_name = "N", default_value = "30", value_parser = within(1.0, 120.0))]
    pub fps: f64,
    /// Length of the film, such as 5s [default: 10 s, or less where there are few outputs]
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "speed")]
    pub duration: Option<std::time::Duration>,
    /// Simulated seconds per second of film: 0.1 is ten times slower than life
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    pub speed: Option<f64>,
    /// Direction of the camera, degrees: azimuth from the front (-y) towards the right (+x), elevation
    ///
    /// The default is the first view of `rodlab view`.
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = direction, allow_hyphen_values = true)]
    pub from: Option<[f64; 2]>,
    /// Angle by which the camera turns around the scene during the film, such as 90deg
    #[arg(long, value_name = "ANGLE", default_value = "0", value_parser = turn, allow_hyphen_values = true)]
    pub turn: f64,
    /// Magnification; 1 shows the whole motion
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = within(0.01, 1000.0))]
    pub zoom: f64,
    /// Name of the rod that the camera follows
    #[arg(long, value_name = "ROD")]
    pub follow: Option<String>,
}

/// Allowed widths of films, pixels.
const WIDTHS: std::ops::RangeInclusive<usize> = 64..=3840;
const HEIGHTS: std::ops::RangeInclusive<usize> = 64..=2160;

fn size(text: &str) -> Result<[usize; 2], String> {
    let sides = text.split_once(['x', '×']);
    let sides = sides.and_then(|(width, height)| {
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    });
    let is_allowed = |[width, height]: &[usize; 2]| {
        WIDTHS.contains(width) && HEIGHTS.contains(height) && width % 2 == 0 && height % 2 == 0
    };
    sides.filter(is_allowed).ok_or_else(|| {
        format!(
            "WIDTHxHEIGHT is needed, such as 1280x720: even numbers, widths from {} to {} and heights from {} to {}",
            WIDTHS.start(),
            WIDTHS.end(),
            HEIGHTS.start(),
            HEIGHTS.end()
        )
    })
}

fn direction(text: &str) -> Result<[f64; 2], String> {
    let parts = text
        .split_once(',')
        .ok_or("AZIMUTH,ELEVATION is needed, such as 30,20")?;
    let direction = [turn(parts.0)?, turn(parts.1)?];
    if direction[1].abs() > std::f64::consts::FRAC_PI_2 + 1e-9 {
        return Err("the elevation is from -90 to 90 degrees".into());
    }
    Ok(direction)
}

fn turn(text: &str) -> Result<f64, String> {
    const MOST: f64 = 1000.0;
    let angle = angle(text)?;
    let is_allowed = angle.is_finite() && angle.abs() <= MOST;
    if is_allowed {
        Ok(angle)
    } else {
        Err("the angle is too large".into())
    }
}

/// Writes a film and prints its path.
pub fn movie(arguments: &MovieArguments, common: &Common) -> Result<(), Failure> {
    let pace = match (arguments.duration, arguments.speed) {
        (Some(duration), _) => Pace::Duration(duration.as_secs_f64()),
        (None, Some(speed)) => Pace::Speed(speed),
        (None, None) => Pace::Usual,
    };
    let request = FilmRequest {
        case: arguments.case.clone(),
        follow: arguments.follow.clone(),
        options: FilmOptions {
            size: arguments.size,
            pictures_per_second: arguments.fps,
            pace,
            from: arguments.from,
            turn: arguments.turn,
            zoom: arguments.zoom,
            follow: None,
        },
    };
    let bar = ProgressBar::no_length();
    let progress = common.progress(bar, "{bar:30} {pos} of {len} pictures, {eta} left");
    let interruption = watch_for_interruption()?;
    let written = write_film(
        &arguments.directory,
        &arguments.out,
        &request,
        &|done, all| {
            progress.set_length(all as u64);
            progress.set_position(done as u64);
            !interruption.is_raised()
        },
    );
    progress.finish_and_clear();
    let written = written?;
    print(&format!(
        "{}\n{} {}, {:.1} s, {:.1} MB\n",
        arguments.out.display(),
        written.pictures,
        if written.pictures == 1 {
            "picture"
        } else {
            "pictures"
        },
        written.seconds,
        written.bytes as f64 / 1e6
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_even_and_in_range() {
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        for text in ["1280", "x", "1281x720", "0x0", "99999x99999", "-4x100"] {
            assert!(size(text).unwrap_err().contains("1280x720"), "{text}");
        }
    }

    #[test]
    fn directions_are_degrees_unless_they_have_a_unit() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let [azimuth, elevation] = direction("-90, 0.5rad").unwrap();
        assert!(near(azimuth, -std::f64::consts::FRAC_PI_2) && near(elevation, 0.5));
        assert!(near(turn("90deg").unwrap(), std::f64::consts::FRAC_PI_2));
        for text in ["30", "a,b", "0,91", "nan,0"] {
            assert!(direction(text).is_err(), "{text}");
        }
    }
}
