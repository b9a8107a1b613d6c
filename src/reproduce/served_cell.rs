//! A virtual cell that is served beside what is done in it.

use rodlab_workcell::cell::{Cell, Driver};
use rodlab_workcell::virtual_cell::{Response, ServeError, Settings, VirtualCell};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// An address of this machine, on a port that is free.
const ANY_PORT: ([u8; 4], u16) = ([127, 0, 0, 1], 0);
/// Longest silence of a driver: a hard step of what is simulated takes longer than a robot may be silent.
const PATIENCE: Duration = Duration::from_secs(10);

/// Settings of a cell without anything in it that is so many times as fast as real time, if it can.
pub(super) fn empty(rate: f64) -> Settings {
    Settings {
        address: ANY_PORT.into(),
        token: None,
        rate,
        response: Response::default(),
        supply: None,
        second_supply: None,
        sheet: None,
        chucked: None,
        jitter: None,
        faults: Vec::new(),
    }
}

/// Does something with a cell that is served meanwhile, whose drivers and camera find it; what it came to, and the cell as it was left.
pub(super) fn with_cell<T>(
    cell: &Cell,
    settings: Settings,
    work: impl FnOnce(&Cell) -> T,
) -> Result<(T, VirtualCell), ServeError> {
    let mut served = VirtualCell::new(cell, settings)?;
    let address = served.address().map_err(|error| ServeError::Address {
        address: SocketAddr::from(ANY_PORT),
        error,
    })?;
    let mut client = cell.clone();
    point_to(&mut client, &address.to_string());
    client.streaming.watchdog = client.streaming.watchdog.max(PATIENCE);
    let is_over = AtomicBool::new(false);
    let (done, ended) = std::thread::scope(|scope| {
        let server = scope.spawn(|| served.serve(&|| is_over.load(Ordering::Relaxed)));
        let over = Over(&is_over);
        let done = work(&client);
        drop(over);
        (done, server.join().expect("the server does not panic"))
    });
    ended?;
    Ok((done, served))
}

/// Ends a server, also where the work with it panics.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Lets the drivers and the camera of a cell find its server.
fn point_to(cell: &mut Cell, server: &str) {
    let arms = cell.arms.iter_mut().map(|arm| &mut arm.driver);
    let axes = cell.axes.iter_mut().map(|axis| &mut axis.driver);
    for driver in arms.chain(axes) {
        if let Some(Driver::Rosbridge { address, .. }) = driver {
            server.clone_into(address);
        }
    }
    if let Some(camera) = &mut cell.camera {
        camera.source = Some(format!("rosbridge://{server}/camera/image_raw"));
    }
}
