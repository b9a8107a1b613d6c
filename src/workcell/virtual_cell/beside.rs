//! A virtual cell that runs in the process of its task.

use super::server::{ServeError, VirtualCell};
use super::settings::{ANY_PORT, Settings};
use crate::cell::{Cell, Driver};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Longest silence of a driver, the camera or a client. On a busy machine a difficult step of the
/// simulation or a picture may take longer than the limit for a robot.
const PATIENCE: Duration = Duration::from_secs(120);

/// Serves a cell while `work` runs, with drivers and camera connected to it. Returns the result of
/// the work, and the final state of the cell.
///
/// # Errors
/// The cell cannot be served, or its simulation failed.
pub fn with_cell<T>(
    cell: &Cell,
    settings: Settings,
    work: impl FnOnce(&Cell) -> T,
) -> Result<(T, VirtualCell), ServeError> {
    let mut served = VirtualCell::new(cell, settings)?;
    served.wait_for_clients(PATIENCE);
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

/// Stops a server when dropped, even if the work panics.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Sets the address of the server in the drivers and the camera of a cell.
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
