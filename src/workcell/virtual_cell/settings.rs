//! Settings of a virtual cell.

use super::arm::Response;
use super::chuck::ChuckedSupply;
use super::fault::Fault;
use super::rod::RodSupply;
use super::sheet::SimulatedSheet;
use rodlab_lab::experiment::Jitter;
use std::net::SocketAddr;

/// Contents of a virtual cell, and settings of its server.
pub struct Settings {
    /// Address to listen on; port 0 selects a free one.
    pub address: SocketAddr,
    /// Token that clients must send as the path of the server.
    pub token: Option<String>,
    /// Speed relative to real time.
    pub rate: f64,
    /// Response of the arms.
    pub response: Response,
    /// Rods for the grippers.
    pub supply: Option<RodSupply>,
    /// Rods that are handed over after the first one, one of each; the last kind again and again.
    pub further: Vec<RodSupply>,
    /// Whether laid rods stay on the table when the next one is handed over; otherwise the user
    /// takes them away.
    pub rods_stay: bool,
    /// Rods of another kind, for the grippers of all arms except the first.
    pub second_supply: Option<RodSupply>,
    /// A sheet on the table.
    pub sheet: Option<SimulatedSheet>,
    /// Rods between the chuck and a hand.
    pub chucked: Option<ChuckedSupply>,
    /// Noise added to the gripper poses; not reported to clients.
    pub jitter: Option<Jitter>,
    /// Faults to inject.
    pub faults: Vec<Fault>,
}

/// An address of this machine with a free port.
pub(super) const ANY_PORT: ([u8; 4], u16) = ([127, 0, 0, 1], 0);

impl Settings {
    /// An empty cell on a free port. `rate` is the speed relative to real time (best effort).
    pub fn empty(rate: f64) -> Self {
        Self {
            address: ANY_PORT.into(),
            token: None,
            rate,
            response: Response::default(),
            supply: None,
            further: Vec::new(),
            rods_stay: false,
            second_supply: None,
            sheet: None,
            chucked: None,
            jitter: None,
            faults: Vec::new(),
        }
    }
}
