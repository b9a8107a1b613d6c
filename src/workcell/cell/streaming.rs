//! Streams a joint trajectory to the drivers of a cell.

use super::resolved::{Cell, Driver, ros_version};
use rodlab_robot::{
    FileDriver, JointKind, JointTrajectory, Limits, Part, PartTrajectory, Ros1Driver,
    RosbridgeDriver, StepperDriver, check, check_stops,
};

const WITHOUT_ROS_2: &str = "this program was built without ROS 2; `cargo install --path .`, without `--no-default-features`, builds one with it";

/// Largest number of positions in a trajectory that is sent unchanged: 5 MB as a rosbridge
/// message, half of the limit of the server.
const MOST_NUMBERS: usize = 150_000;
/// Tolerance by which a motion may change when points are removed, rad or m.
const THINNING: f64 = 1e-5;

/// Plan of a stream.
#[derive(Clone, Debug, serde::Serialize)]
pub struct StreamReport {
    /// Duration of the motion, s.
    pub duration_s: f64,
    /// Number of points; for several trajectories, their sum.
    pub points: usize,
    /// Names of the arms and axes that move.
    pub parts: Vec<String>,
    /// Least distance of the arms from each other, from themselves and from their surroundings, m;
    /// 0.2 means 0.2 or more.
    pub least_clearance_m: f64,
}

impl Cell {
    /// Prepares the parts of trajectories for a stream, on one clock from zero, with drivers that
    /// are not connected yet. Every point is checked against limits, collisions and `[safety]`.
    ///
    /// # Errors
    /// A message: an unknown name, a missing joint, an arm in two trajectories, an exceeded limit,
    /// a contact, or a part without a driver.
    pub fn prepare_stream(
        &self,
        trajectories: &[JointTrajectory],
    ) -> Result<(Vec<Part>, StreamReport), String> {
        let mut parts = Vec::new();
        let unknown = trajectories.iter();
        let mut faults: Vec<String> = unknown
            .flat_map(|trajectory| self.unknown_columns(trajectory))
            .collect();
        for Movable {
            name,
            joints,
            kinds,
            limits,
            driver,
        } in self.movable()
        {
            let mut moving = trajectories
                .iter()
                .map(|trajectory| (trajectory, trajectory.columns_of(name)))
                .filter(|(_, columns)| !columns.is_empty());
            let Some((trajectory, columns)) = moving.next() else {
                continue;
            };
            if moving.next().is_some() {
                faults.push(format!("{name}: two trajectories move it"));
                continue;
            }
            let Some(columns) = in_order(trajectory, &columns, &joints) else {
                faults.push(format!(
                    "{name}: columns for all of its joints are needed: {}",
                    joints.join(", ")
                ));
                continue;
            };
            let points = trajectory.points.iter();
            let part = PartTrajectory {
                joints,
                times: trajectory
                    .times
                    .iter()
                    .map(|time| time - trajectory.times[0])
                    .collect(),
                points: points
                    .map(|point| columns.iter().map(|column| point[*column]).collect())
                    .collect(),
            };
            let part = within_a_message(part);
            if let Err(exceeded) = check(&part, &limits) {
                faults.extend(exceeded.iter().map(|fault| format!("{name}.{fault}")));
            }
            match driver {
                None => faults.push(format!("{name}: it has no `driver` in the cell file")),
                Some(driver) => match self.driver(driver) {
                    Some(driver) => {
                        if let Some(horizon) = self.streaming.horizon
                            && driver.sends_goals()
                            && let Err(stops) = check_stops(&part, &limits, horizon)
                        {
                            faults.extend(stops.iter().map(|fault| format!("{name}.{fault}")));
                        }
                        parts.push(Part {
                            name: name.to_owned(),
                            driver,
                            trajectory: part,
                            kinds,
                            limits,
                        });
                    }
                    None => faults.push(format!("{name}: {WITHOUT_ROS_2}")),
                },
            }
        }
        let mut least_clearance = 0.0;
        if faults.is_empty() {
            match self.least_clearance(&parts) {
                Ok(least) => least_clearance = least,
                Err(touches) => faults.push(touches),
            }
            faults.extend(self.safe_hands(&parts).err());
        }
        if !faults.is_empty() {
            return Err(faults.join("\n"));
        }
        let report = StreamReport {
            duration_s: trajectories
                .iter()
                .map(JointTrajectory::duration)
                .fold(0.0, f64::max),
            points: trajectories
                .iter()
                .map(|trajectory| trajectory.points.len())
                .sum(),
            parts: parts.iter().map(|part| part.name.clone()).collect(),
            least_clearance_m: least_clearance,
        };
        Ok((parts, report))
    }

    /// Arms and axes.
    fn movable(&self) -> Vec<Movable<'_>> {
        let arms = self.arms.iter().map(|arm| {
            let joints = &arm.chain.joints;
            Movable {
                name: &arm.name,
                joints: arm.chain.joint_names(),
                kinds: joints.iter().map(|joint| joint.kind).collect(),
                limits: arm.limits(),
                driver: arm.driver.as_ref(),
            }
        });
        let axes = self.axes.iter().map(|axis| Movable {
            name: &axis.name,
            joints: vec![axis.name.clone()],
            kinds: vec![JointKind::Revolute],
            limits: vec![axis.limits],
            driver: axis.driver.as_ref(),
        });
        arms.chain(axes).collect()
    }

    fn unknown_columns(&self, trajectory: &JointTrajectory) -> Vec<String> {
        let movable = self.movable();
        let unknown = trajectory.columns.iter().filter(|column| {
            !movable.iter().any(|part| {
                let joints = &part.joints;
                part.name == column.part
                    && column
                        .joint
                        .as_ref()
                        .is_none_or(|joint| joints.contains(joint))
            })
        });
        let names: Vec<&str> = movable.iter().map(|part| part.name).collect();
        unknown
            .map(|column| {
                format!(
                    "column `{}`: the cell has no such joint; its arms and axes: {}",
                    column.header(),
                    names.join(", ")
                )
            })
            .collect()
    }

    /// Returns the driver; `None` if this program was built without it.
    pub(super) fn driver(&self, driver: &Driver) -> Option<Box<dyn rodlab_robot::Driver>> {
        let driver: Box<dyn rodlab_robot::Driver> = match driver {
            Driver::File { path, json_lines } => {
                Box::new(FileDriver::new(path.clone(), *json_lines))
            }
            Driver::Rosbridge {
                address,
                ros,
                action,
                joint_states,
            } => {
                let version = ros_version(*ros);
                Box::new(RosbridgeDriver::new(address, version, action, joint_states))
            }
            Driver::Ros1 {
                master,
                action,
                joint_states,
            } => Box::new(Ros1Driver::new(master, action, joint_states)),
            Driver::Ros2(address) => return address.driver(),
            Driver::Stepper {
                port,
                baud,
                steps_per_turn,
            } => Box::new(StepperDriver::new(port, *baud, *steps_per_turn)),
        };
        Some(driver)
    }
}

/// Removes points of a long motion so that its goal fits into a message. A controller that
/// interpolates the remaining points stays within [`THINNING`] of the removed ones.
fn within_a_message(part: PartTrajectory) -> PartTrajectory {
    let numbers = part.times.len() * part.joints.len();
    match numbers > MOST_NUMBERS {
        true => part.thinned(THINNING),
        false => part,
    }
}

/// An arm or an axis that can move.
struct Movable<'a> {
    name: &'a str,
    joints: Vec<String>,
    kinds: Vec<JointKind>,
    limits: Vec<Limits>,
    driver: Option<&'a Driver>,
}

/// The columns in the order of the joints; `None` if one is missing.
fn in_order(
    trajectory: &JointTrajectory,
    columns: &[usize],
    joints: &[String],
) -> Option<Vec<usize>> {
    let of = |joint: &String| {
        let mut columns = columns.iter();
        let found = columns.find(|column| {
            let name = &trajectory.columns[**column].joint;
            name.as_ref().is_none_or(|name| name == joint)
        });
        found.copied()
    };
    joints.iter().map(of).collect()
}
