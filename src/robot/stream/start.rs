//! Before the first goal: connections, first reports, and the checks that motion is allowed and
//! that every joint is at the first point of its trajectory.

use super::cycles::CYCLE;
use super::follow::apart;
use super::timer::Timer;
use super::{Ending, Part, StreamBounds, StreamLog, Supervisor, failed};
use std::time::Duration;

/// Longest wait for the first reports of all joints.
const FIRST_STATE: Duration = Duration::from_secs(2);

/// Connects, waits until every part reports its joints. Just before the goals are sent, compares
/// all joints with their first points at the same time.
pub(super) fn prepare(
    parts: &mut [Part],
    bounds: &StreamBounds,
    supervisor: &dyn Supervisor,
    timer: &dyn Timer,
    log: &mut StreamLog,
) -> Result<(), Ending> {
    for part in parts.iter_mut() {
        let connected = part.driver.connect(&part.trajectory.joints);
        connected.map_err(|error| failed(part, &error))?;
        log.event(&format!("{} is connected", part.name));
    }
    let begin = timer.now();
    loop {
        if supervisor.is_interrupted() {
            return Err(Ending::Interrupted);
        }
        let mut missing = None;
        for part in parts.iter_mut().filter(|part| part.driver.reports_state()) {
            let state = part.driver.state().map_err(|error| failed(part, &error))?;
            let age = state.map(|state| timer.now().saturating_duration_since(state.received));
            if age.is_none_or(|age| age > bounds.watchdog) {
                missing.get_or_insert(format!(
                    "{}: no report of all of its joints ({}) in {} s; compare the names and the \
                     topic of joint states in the cell file with the robot's",
                    part.name,
                    part.trajectory.joints.join(", "),
                    FIRST_STATE.as_secs()
                ));
            }
        }
        match missing {
            None => break,
            Some(reason) if timer.now().duration_since(begin) > FIRST_STATE => {
                return Err(Ending::Failed(reason));
            }
            Some(_) => timer.sleep(CYCLE),
        }
    }
    if let Some(reason) = supervisor.forbids() {
        return Err(Ending::Failed(format!("{reason}. Nothing was moved")));
    }
    // Only parts with measured positions are compared: a motor without a sensor starts at its
    // present position.
    for part in parts.iter_mut().filter(|part| part.driver.knows_position()) {
        let state = part.driver.state().map_err(|error| failed(part, &error))?;
        let Some(state) = state else { continue };
        let trajectory = &part.trajectory;
        let first = &trajectory.points[0];
        let apart = apart(
            &trajectory.joints,
            &part.kinds,
            &state.positions,
            first,
            bounds,
        );
        if let Some(apart) = apart {
            return Err(Ending::Failed(format!(
                "{}: not at the first point of its trajectory: {apart}. Nothing was moved: bring the arm to the first point, or plan from where it is",
                part.name
            )));
        }
    }
    Ok(())
}
