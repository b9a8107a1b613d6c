//! `rodlab calibrate`: cameras and their mounts.

use super::prelude::*;
use nalgebra::Isometry3;
use rodlab_vision::{
    Camera, Checkerboard, LensMisfit, RejectedPair, VisionError, board_pose,
    calibrate as calibrate_lens, hand_eye, pictures_in, read_picture, read_poses,
};

/// Arguments of `rodlab calibrate`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct CalibrateArguments {
    /// Quantity to calibrate
    #[command(subcommand)]
    what: What,
}

const EXAMPLES: &str = "\
Examples:
  rodlab calibrate camera views/ --board 9x6 --square \"25 mm\" --out camera.toml
  rodlab calibrate camera views/ --board 9x6 --square \"25 mm\" --table table.png --out camera.toml
  rodlab calibrate pose table.png --board 9x6 --square \"25 mm\" --cell camera.toml
  rodlab calibrate hand-eye hand.csv target.csv";

#[derive(Debug, Subcommand)]
enum What {
    /// Focal lengths, principal point and distortion, from pictures of a checkerboard
    Camera(CameraArguments),
    /// Pose of a camera with a calibrated lens, from one picture of a checkerboard on the table
    Pose(PoseArguments),
    /// Pose of a camera on a hand, from pairs of poses
    HandEye(HandEyeArguments),
}

#[derive(Debug, Args)]
struct BoardArguments {
    /// Inner corners of the checkerboard along both sides, as in 9x6
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = board_size)]
    board: (usize, usize),
    /// Side of the squares, in metres or with a unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    square: f64,
}

impl BoardArguments {
    fn board(&self) -> Checkerboard {
        Checkerboard {
            columns: self.board.0,
            rows: self.board.1,
            square: self.square,
        }
    }
}

#[derive(Debug, Args)]
struct CameraArguments {
    /// PNG or JPEG images, or folders of them
    #[arg(required = true, value_name = "IMAGE")]
    images: Vec<PathBuf>,
    #[command(flatten)]
    board: BoardArguments,
    /// Image in which the board lies on the table [default: the first one]
    ///
    /// Its lower left inner corner becomes the origin of the world.
    #[arg(long, value_name = "IMAGE")]
    table: Option<PathBuf>,
    /// Output file for the table [camera]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct PoseArguments {
    /// A PNG or JPEG image of the board
    image: PathBuf,
    #[command(flatten)]
    board: BoardArguments,
    /// File whose table [camera] gives the lens
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    cell: PathBuf,
    /// Output file for the table [camera] with the pose found
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct HandEyeArguments {
    /// Poses of the hand in the base: CSV with columns x_m, y_m, z_m, qw, qx, qy, qz
    hand: PathBuf,
    /// Poses of the target in the camera, row by row at the same times
    target: PathBuf,
    /// The camera does not move and the hand holds the target
    #[arg(long)]
    fixed_camera: bool,
    /// Has no effect: the result is always JSON
    #[arg(long)]
    json: bool,
}

fn board_size(text: &str) -> Result<(usize, usize), String> {
    let sides = text.split_once(['x', '×']);
    let sides = sides.and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    sides
        .filter(|(a, b)| (2..=60).contains(a) && (2..=60).contains(b))
        .ok_or_else(|| "expected two whole numbers from 2 to 60, as in 9x6".into())
}

#[derive(Serialize)]
struct CameraAnswer {
    images: usize,
    reprojection_rms_px: f64,
    views: Vec<ViewAnswer>,
    /// Standard deviations.
    fx_deviation_px: f64,
    fy_deviation_px: f64,
    cx_deviation_px: f64,
    cy_deviation_px: f64,
    /// Radial errors that noise does not explain; they enlarge the standard deviations.
    #[serde(skip_serializing_if = "Option::is_none")]
    misfit: Option<LensMisfit>,
    left_out: Vec<String>,
    /// Table `[camera]` of the output file.
    camera: toml::Value,
}

#[derive(Serialize)]
struct TableAnswer {
    image: PathBuf,
    reprojection_rms_px: f64,
    /// Table `[camera]` of the output file.
    camera: toml::Value,
}

/// Returns the table `[camera]` of a file.
fn table(camera: &Camera) -> Result<toml::Value, Failure> {
    let file = camera.to_toml().parse::<toml::Table>();
    let mut file = file.map_err(Failure::system)?;
    Ok(file.remove("camera").unwrap_or_else(|| file.into()))
}

#[derive(Serialize)]
struct ViewAnswer {
    image: PathBuf,
    reprojection_rms_px: f64,
}

#[derive(Serialize)]
struct PoseAnswer {
    position_m: [f64; 3],
    quaternion_wxyz: [f64; 4],
}

impl PoseAnswer {
    fn of(pose: &Isometry3<f64>) -> Self {
        let turn = pose.rotation;
        Self {
            position_m: pose.translation.vector.into(),
            quaternion_wxyz: [turn.w, turn.i, turn.j, turn.k],
        }
    }
}

/// Calibrates and prints the result.
pub fn calibrate(arguments: &CalibrateArguments) -> Result<(), Failure> {
    match &arguments.what {
        What::Camera(arguments) => camera(arguments),
        What::Pose(arguments) => pose(arguments),
        What::HandEye(arguments) => mount(arguments),
    }
}

fn camera(arguments: &CameraArguments) -> Result<(), Failure> {
    let board = arguments.board.board();
    let mut paths = Vec::new();
    for image in &arguments.images {
        if image.is_dir() {
            paths.extend(pictures_in(image)?);
        } else {
            paths.push(image.clone());
        }
    }
    if let Some(table) = &arguments.table
        && !paths.contains(table)
    {
        paths.push(table.clone());
    }
    let (mut used, mut views, mut left_out, mut size) = (Vec::new(), Vec::new(), Vec::new(), None);
    for path in paths {
        let picture = read_picture(&path)?;
        let found = picture.dimensions();
        let expected = *size.get_or_insert(found);
        if found != expected {
            return Err(VisionError::Size {
                what: path.display().to_string(),
                found_width: found.0 as usize,
                found_height: found.1 as usize,
                width: expected.0 as usize,
                height: expected.1 as usize,
            }
            .into());
        }
        match board.find(&picture) {
            Ok(corners) => {
                used.push(path);
                views.push(corners);
            }
            Err(error) => left_out.push(format!("{}: {error}", path.display())),
        }
    }
    let Some((width, height)) = size.filter(|_| !views.is_empty()) else {
        let faults = left_out.join("\n");
        return Err(Failure::Input(format!(
            "no image shows the board:\n{faults}"
        )));
    };
    let found = calibrate_lens(&board, &views, width, height)?;
    let on_table = match &arguments.table {
        None => 0,
        Some(table) => {
            let place = used.iter().position(|path| path == table);
            place
                .ok_or("the image does not show the whole board")
                .at(table.display())?
        }
    };
    let calibrated = found.camera(on_table, width, height);
    if let Some(out) = &arguments.out {
        write_file(out, calibrated.to_toml().as_bytes())?;
    }
    let [fx, fy, cx, cy, ..] = found.lens_deviations;
    let views = used.into_iter().zip(&found.view_rms);
    let views = views.map(|(image, rms)| ViewAnswer {
        image,
        reprojection_rms_px: *rms,
    });
    let answer = CameraAnswer {
        images: found.view_rms.len(),
        reprojection_rms_px: found.reprojection_rms,
        views: views.collect(),
        fx_deviation_px: fx,
        fy_deviation_px: fy,
        cx_deviation_px: cx,
        cy_deviation_px: cy,
        misfit: found.misfit,
        left_out,
        camera: table(&calibrated)?,
    };
    if arguments.json {
        return print_json(&answer);
    }
    let mut text = format!(
        "# {} images, reprojection {:.4} px\n",
        answer.images, answer.reprojection_rms_px
    );
    for view in &answer.views {
        text += &format!(
            "# {:.4} px  {}\n",
            view.reprojection_rms_px,
            in_comment(&view.image.display().to_string())
        );
    }
    if let Some(misfit) = &answer.misfit {
        text += &format!(
            "# warning: the lens model does not fit: error {:.3} px at {:.0} px from the middle of the picture; a fisheye lens? The \
             standard deviations are enlarged {:.1} times\n",
            misfit.radial_error_px,
            misfit.at_radius_px,
            misfit.inflation()
        );
    }
    for fault in &answer.left_out {
        text += &format!("# left out: {}\n", in_comment(fault));
    }
    text += &format!(
        "# standard deviations: fx {fx:.2}, fy {fy:.2}, cx {cx:.2}, cy {cy:.2} px\n{}",
        calibrated.to_toml()
    );
    print(&text)
}

/// Text for a comment in TOML. A line break in the name of a file must not end the comment.
fn in_comment(text: &str) -> String {
    text.replace(|character: char| character.is_control(), " ")
}

fn pose(arguments: &PoseArguments) -> Result<(), Failure> {
    let known = Camera::read(&arguments.cell)?;
    let picture = read_picture(&arguments.image)?;
    known.check_size(picture.width(), picture.height())?;
    let board = arguments.board.board();
    let corners = board.find(&picture).at(arguments.image.display())?;
    let (seen, rms) = board_pose(&board, &corners, &known.lens)?;
    let camera = Camera {
        pose: seen.inverse(),
        table_height: 0.0,
        ..known
    };
    let text = format!("# reprojection {rms:.4} px\n{}", camera.to_toml());
    if let Some(out) = &arguments.out {
        write_file(out, text.as_bytes())?;
    }
    if arguments.json {
        return print_json(&TableAnswer {
            image: arguments.image.clone(),
            reprojection_rms_px: rms,
            camera: table(&camera)?,
        });
    }
    print(&text)
}

#[derive(Serialize)]
struct HandEyeAnswer {
    pairs: usize,
    camera: PoseAnswer,
    target: PoseAnswer,
    position_rms_m: f64,
    rotation_rms_degrees: f64,
    /// Standard deviations of the camera's pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    position_deviation_m: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation_deviation_degrees: Option<f64>,
    /// Pairs that disagree with the others, and were not used.
    rejected: Vec<RejectedPair>,
}

fn mount(arguments: &HandEyeArguments) -> Result<(), Failure> {
    let mut hands = read_poses(&arguments.hand)?;
    let targets = read_poses(&arguments.target)?;
    if arguments.fixed_camera {
        for hand in &mut hands {
            hand.inverse_mut();
        }
    }
    let found = hand_eye(&hands, &targets)?;
    for pair in &found.rejected {
        tracing::warn!(
            "pair {} disagrees with the others and is not used: error {:.2} mm and {:.2}°",
            pair.pair,
            1e3 * pair.position_error_m,
            pair.rotation_error_degrees
        );
    }
    print_json(&HandEyeAnswer {
        pairs: hands.len() - found.rejected.len(),
        camera: PoseAnswer::of(&found.camera),
        target: PoseAnswer::of(&found.target),
        position_rms_m: found.position_rms,
        rotation_rms_degrees: found.rotation_rms.to_degrees(),
        position_deviation_m: found.deviations.map(|(position, _)| position),
        rotation_deviation_degrees: found.deviations.map(|(_, turn)| turn.to_degrees()),
        rejected: found.rejected,
    })
}
