//! `rodlab cell`: the virtual robot cell.

use super::interruption::watch_for_interruption;
use super::place::read_placement;
use super::prelude::*;
use super::values;
use rodlab_lab::experiment::{Crease, Jitter, PaperFile};
use rodlab_robot::Pose;
use rodlab_workcell::cell::{Cell, Driver, Place};
use rodlab_workcell::task::middle_of_table;
use rodlab_workcell::virtual_cell::{
    ChuckedSupply, Fault, Response, RodSupply, Settings, SheetPlace, SimulatedSheet, VirtualCell,
};
use std::net::{SocketAddr, ToSocketAddrs};

/// Default friction of the table.
pub(super) const FRICTION: f64 = 0.4;
/// Period of the fastest component of the gripper noise, s.
const JITTER_PERIOD: f64 = 1.0;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab cell serve --rod green_vps
  rodlab cell serve --cell two_gantries --rod thick_pink_vps --friction 0.2 --rate 5
  rodlab cell serve --scene cable_placement_u
  rodlab cell serve --paper origami --diagonal --place 0.1,-0.05,20
  rodlab cell serve --rod green_vps --fault drop-link@3s --fault lose-camera@0s",
    "\
Arms follow trajectories as `rodlab stream` sends them, with latency and lag. A gripper that closes
grasps a lying rod within its reach, even if another gripper holds that rod. Otherwise it receives
the end of a rod, which hangs from it with its free end on the table. A gripper that opens releases
it. A scene, --scene, has a rod and pegs on the table. A sheet, --paper, lies on the table; a
gripper that closes at the middle of its edge takes it. The camera shows the table with all of them,
on /camera/image_raw unless the cell file names another topic. The address on which the cell listens
is printed.

An arm obeys one client at a time. When that client disconnects, the arm stops. Times of faults
count only while an arm moves; faults are drop-link, freeze-joint, slip-grasp and lose-camera."
);

/// Arguments of `rodlab cell`.
#[derive(Debug, Args)]
pub struct CellArguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Simulate a cell behind the protocol of real cells, until Ctrl-C
    #[command(after_help = HELP[0], after_long_help = HELP[1])]
    Serve(ServeArguments),
}

#[derive(Debug, Args)]
struct ServeArguments {
    /// Cell file, whose arms have drivers of kind "rosbridge"
    #[arg(long, value_name = "FILE", default_value = "gantry", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    cell: PathBuf,
    /// Rod file: TOML with [deployment.rod], or with [material] and [rod] if the cell has a [chuck]
    ///
    /// [deployment.rod] has gravito_bending_length, radius and length; [material] has youngs_modulus, poissons_ratio and density, and
    /// [rod] radius and length. Without a rod, grippers hold nothing.
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    rod: Option<PathBuf>,
    /// Scenario as for `rodlab place`, which defines rod, pegs and friction of the table
    #[arg(long, value_name = "SCENARIO", conflicts_with_all = ["rod", "paper"], value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    scene: Option<PathBuf>,
    /// Place of the frame of the scene's pattern: x,y,z in metres, a turn about z in degrees
    ///
    /// By default the middle of the pattern is in the middle of the table.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "X,Y,Z[,TURN]",
        requires = "scene",
        allow_hyphen_values = true
    )]
    scene_place: Option<Place>,
    /// Position of the free end of a supplied rod on the table: x,y in the cell, m
    ///
    /// By default the rod hangs freely; for a scene, its free end is at the start of the pattern.
    #[arg(long, hide_short_help = true, value_name = "X,Y", value_parser = place, conflicts_with = "paper", allow_hyphen_values = true)]
    free_end: Option<[f64; 2]>,
    /// Supply rods that hang in the air with this free length, for `rodlab identify --rod`
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, requires = "rod", conflicts_with_all = ["free_end", "second_rod"])]
    hanging: Option<f64>,
    /// Keep laid rods on the table when the next one is supplied
    #[arg(long, hide_short_help = true, requires = "rod")]
    keep_rods: bool,
    /// Rod file for all arms except the first [default: that of --rod]
    #[arg(long, value_name = "FILE", requires = "rod", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    second_rod: Option<PathBuf>,
    /// Sheet file: TOML with [folding.paper], as in scenarios/papers
    #[arg(long, value_name = "FILE", conflicts_with = "rod", value_parser = file_or_preset(PresetKind::Paper), add = presets(PresetKind::Paper))]
    paper: Option<PathBuf>,
    /// Place the sheet with a corner forward, for a fold along its diagonal
    #[arg(long, requires = "paper")]
    diagonal: bool,
    /// Place of the sheet: middle of its edge on the table, m, and direction across the sheet,
    /// degrees
    ///
    /// The direction is measured from the x axis of the table. By default the middle of the sheet is in the middle of the table.
    #[arg(long, value_name = "X,Y[,TURN]", requires = "paper", value_parser = sheet_place, allow_hyphen_values = true)]
    place: Option<SheetPlace>,
    /// Friction of the table [default: that of the sheet file or the scene, otherwise 0.4]
    #[arg(long, value_name = "FRICTION", value_parser = within(0.0, 10.0))]
    friction: Option<f64>,
    /// Speed relative to real time; best effort: runs slower if the simulation cannot keep up
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = within(0.01, 100.0))]
    rate: f64,
    /// Address to listen on, host:port; port 0 selects a free one [default: that of the drivers]
    ///
    /// An address that other machines can reach requires --token.
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<String>,
    /// Token required of clients: the path after the address, "192.168.1.5:9090/TOKEN"
    #[arg(long, hide_short_help = true, value_name = "TOKEN", env = "RODLAB_CELL_TOKEN", hide_env_values = true, value_parser = token)]
    token: Option<String>,
    /// Time from a command to the first motion, s
    #[arg(long, hide_short_help = true, value_name = "SECONDS", default_value_t = Response::default().latency, value_parser = within(0.0, 0.2))]
    latency: f64,
    /// Time by which joints lag behind their setpoints, s
    #[arg(long, hide_short_help = true, value_name = "SECONDS", default_value_t = Response::default().lag, value_parser = within(0.0, 0.2))]
    lag: f64,
    /// Root mean square of the gripper noise in each direction, not seen by the joint encoders
    ///
    /// Its periods are from 1 to 5 s.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    jitter: Option<f64>,
    /// Seed of the gripper noise
    #[arg(
        long,
        hide_short_help = true,
        value_name = "N",
        default_value_t = 1,
        requires = "jitter"
    )]
    seed: u64,
    /// Fault to inject, and its time, s of motion: FAULT@TIME; repeatable
    #[arg(long = "fault", value_name = "FAULT@TIME")]
    faults: Vec<Fault>,
}

/// Serves a virtual cell.
pub fn cell(arguments: &CellArguments) -> Result<(), Failure> {
    let What::Serve(arguments) = &arguments.what;
    let cell = Cell::read(&arguments.cell)?;
    let address = arguments.address(&cell)?;
    let rod = arguments.rod.as_deref();
    let friction = arguments.friction.unwrap_or(FRICTION);
    let chucked = rod
        .map(|rod| ChuckedSupply::new(rod, &cell))
        .transpose()?
        .flatten();
    let supply = match rod.filter(|_| cell.chuck.is_none()) {
        Some(rod) => Some(match arguments.hanging {
            Some(length) => RodSupply::hanging(rod, length)?,
            None => RodSupply::new(rod, friction)?,
        }),
        None => arguments.scene(&cell)?,
    };
    let supply = match (supply, arguments.free_end) {
        (Some(supply), Some(place)) => Some(supply.with_free_end(place)),
        (supply, _) => supply,
    };
    let second = arguments.second_rod.as_deref();
    let second_supply = second.map(|rod| RodSupply::new(rod, friction));
    let paper = arguments.paper.as_deref();
    let sheet = paper.map(|paper| arguments.sheet(paper, &cell));
    let settings = Settings {
        address,
        token: arguments.token.clone(),
        rate: arguments.rate,
        response: Response {
            latency: arguments.latency,
            lag: arguments.lag,
        },
        supply,
        further: Vec::new(),
        rods_stay: arguments.keep_rods,
        second_supply: second_supply.transpose()?,
        sheet: sheet.transpose()?,
        chucked,
        jitter: arguments
            .jitter
            .map(|rms| Jitter::new([rms, 0.0], JITTER_PERIOD, arguments.seed)),
        faults: arguments.faults.clone(),
    };
    let interrupted = watch_for_interruption()?;
    let mut served = VirtualCell::new(&cell, settings)?;
    let address = served.address();
    let address = address.map_err(Failure::system)?;
    print(&format!("listening on {address}\n"))?;
    Ok(served.serve(&|| interrupted.is_raised())?)
}

impl ServeArguments {
    /// Rods and pegs of the scene, if given.
    fn scene(&self, cell: &Cell) -> Result<Option<RodSupply>, Failure> {
        let Some(file) = &self.scene else {
            return Ok(None);
        };
        let scene = read_placement(file, &[])?;
        let place = self
            .scene_place
            .or_else(|| middle_of_table(cell, &scene.fixtures.outline()));
        let frame = place.and_then(Place::pose).ok_or_else(|| {
            Failure::Input("--scene-place: x,y,z is needed, or a cell with a [table]".into())
        })?;
        let friction = self.friction.unwrap_or(scene.friction);
        Ok(Some(RodSupply::of(&scene.deployment, friction, frame)?))
    }

    /// The sheet on the table.
    fn sheet(&self, paper: &Path, cell: &Cell) -> Result<SimulatedSheet, Failure> {
        let file = PaperFile::read(paper)?;
        let crease = if self.diagonal {
            Crease::Diagonal
        } else {
            Crease::Half
        };
        file.paper.target(crease).at("--diagonal")?;
        let friction = self.friction.or(file.paper.friction).unwrap_or(FRICTION);
        let table = cell.table.map_or_else(Pose::identity, |table| table.top);
        let sheet = SimulatedSheet::new(paper, friction, self.diagonal, self.place, &table);
        Ok(sheet?)
    }

    /// Address to listen on. An address that only this machine can reach needs no token.
    fn address(&self, cell: &Cell) -> Result<SocketAddr, Failure> {
        let (what, given) = match &self.listen {
            Some(given) => ("--listen", given.as_str()),
            None => (
                "the address of the drivers",
                driver_address(cell).unwrap_or_default(),
            ),
        };
        let server = given.split('/').next().unwrap_or_default();
        let resolved = server.to_socket_addrs().ok().and_then(|mut all| all.next());
        let address = resolved.ok_or_else(|| {
            Failure::Input(format!(
                "{what}: {given:?} is not an address of this machine; expected host:port, as in 127.0.0.1:9090"
            ))
        })?;
        if address.ip().is_loopback() || (self.listen.is_some() && self.token.is_some()) {
            return Ok(address);
        }
        Err(Failure::Input(format!(
            "{what}: other machines can reach {address}; allowed: 127.0.0.1, or any address with --listen and --token"
        )))
    }
}

fn driver_address(cell: &Cell) -> Option<&str> {
    cell.arms.iter().find_map(|arm| match &arm.driver {
        Some(Driver::Rosbridge { address, .. }) => Some(address.as_str()),
        _ => None,
    })
}

/// A parser of seconds in a range, with or without a unit.
fn within(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| values::within(least, most)(text.trim().trim_end_matches('s'))
}

fn place(text: &str) -> Result<[f64; 2], String> {
    let fault = || "two numbers from -100 to 100 m are needed, as in 0.2,-0.1".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(fault)?;
    let number = |text: &str| within(-100.0, 100.0)(text).map_err(|_| fault());
    Ok([number(x)?, number(y)?])
}

fn sheet_place(text: &str) -> Result<SheetPlace, String> {
    let is_near = |numbers: &Vec<f64>| numbers.iter().all(|number| number.abs() <= 1e3);
    let (x, y, turn) = match numbers(text).filter(is_near).as_deref() {
        Some([x, y]) => (*x, *y, 0.0),
        Some([x, y, turn]) => (*x, *y, *turn),
        _ => return Err("two or three numbers are needed, as in 0.1,-0.05,20".into()),
    };
    Ok(SheetPlace {
        edge: [x, y],
        heading: turn.to_radians(),
    })
}

fn token(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let is_long = (16..=128).contains(&text.len());
    if is_long && text.chars().all(is_plain) {
        Ok(text.to_owned())
    } else {
        Err("16 to 128 letters, digits, hyphens and underscores are needed".into())
    }
}
