//! Reads the keys of a cell file: units, ranges, poses and drivers. Records their faults.

use super::resolved::{Driver, Gripper};
use super::typed::{self, CellFile};
use nalgebra::{Translation3, UnitQuaternion};
use rodlab_lab::scenario::dimension::{Angle, Dimension, Dimensionless, Length};
use rodlab_lab::scenario::{Issue, Issues, KeyPath, Quantity, TypedFile, Vector};
use rodlab_robot::{FileDriver, Middleware, Pose, Ros2Address, pose};
use std::cell::RefCell;
use std::path::PathBuf;

/// Default opening of fingers that hold nothing, m.
const OPEN: f64 = 0.04;
/// Default greatest effort of fingers, N: it holds a rod without damage. For effort controllers 0
/// means no force.
const EFFORT: f64 = 10.0;

/// Reads keys and records their faults; faulty values are replaced by harmless ones, so that all
/// faults of a file are reported together.
pub(super) struct Resolver<'a> {
    pub issues: RefCell<Issues>,
    pub warnings: RefCell<Vec<String>>,
    pub file: &'a TypedFile<CellFile>,
}

impl Resolver<'_> {
    pub fn fault(&self, path: &KeyPath, message: impl Into<String>) {
        self.issue(Issue::new(path.clone(), message));
    }

    pub fn issue(&self, issue: Issue) {
        self.issues.borrow_mut().push(issue);
    }

    /// Path of a file that is named at `path`.
    pub fn file_at(&self, path: &KeyPath, name: &str) -> PathBuf {
        self.file.directory_of(path).join(name)
    }

    pub fn si<D: Dimension>(&self, path: &KeyPath, quantity: &Quantity<D>) -> f64 {
        quantity.si().unwrap_or_else(|message| {
            self.fault(path, message);
            1.0
        })
    }

    pub fn positive(&self, path: &KeyPath, value: f64) -> f64 {
        if value > 0.0 && value.is_finite() {
            return value;
        }
        self.fault(path, format!("{value} must be above 0"));
        1.0
    }

    /// A quantity at a key, or a default value.
    pub fn si_or<D: Dimension>(
        &self,
        path: &KeyPath,
        given: &Option<Quantity<D>>,
        otherwise: f64,
    ) -> f64 {
        given
            .as_ref()
            .map_or(otherwise, |given| self.si(path, given))
    }

    /// Returns a quantity of at least 0, or a default value; `unit` is for the message.
    fn not_negative<D: Dimension>(
        &self,
        path: &KeyPath,
        given: &Option<Quantity<D>>,
        otherwise: f64,
        unit: &str,
    ) -> f64 {
        let value = self.si_or(path, given, otherwise);
        if !(value >= 0.0 && value.is_finite()) {
            self.fault(path, format!("{value} {unit} must be 0 or more"));
        }
        value
    }

    /// The range between the keys `lower` and `upper`, infinite if they are not given.
    pub fn range<D: Dimension>(
        &self,
        path: &KeyPath,
        [lower, upper]: [&Option<Quantity<D>>; 2],
        unit: &str,
    ) -> [f64; 2] {
        let key = path.key("lower");
        let lower = self.si_or(&key, lower, f64::NEG_INFINITY);
        let upper = self.si_or(&path.key("upper"), upper, f64::INFINITY);
        if !(lower < upper) {
            let message = format!("{lower} {unit} must be below `upper`, {upper} {unit}");
            self.fault(&key, message);
        }
        [lower, upper]
    }

    pub fn positive_si<D: Dimension>(&self, path: &KeyPath, quantity: &Quantity<D>) -> f64 {
        self.positive(path, self.si(path, quantity))
    }

    pub fn vector<D: Dimension>(&self, path: &KeyPath, vector: &Vector<D>) -> [f64; 3] {
        std::array::from_fn(|k| self.si(&path.index(k), &vector[k]))
    }

    pub fn sides(&self, path: &KeyPath, size: &Vector<Length>) -> [f64; 3] {
        std::array::from_fn(|k| self.positive_si(&path.index(k), &size[k]))
    }

    /// A pose from a position and either a quaternion or angles.
    pub fn pose(
        &self,
        path: &KeyPath,
        position: &Option<Vector<Length>>,
        quaternion: &Option<[Quantity<Dimensionless>; 4]>,
        rpy: &Option<Vector<Angle>>,
    ) -> Pose {
        let position = position.as_ref().map_or([0.0; 3], |position| {
            self.vector(&path.key("position"), position)
        });
        let angles = rpy.as_ref();
        let [roll, pitch, yaw] =
            angles.map_or([0.0; 3], |angles| self.vector(&path.key("rpy"), angles));
        let mut rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        if let Some(quaternion) = quaternion {
            let key = path.key("quaternion");
            if rpy.is_some() {
                self.fault(&key, "either `quaternion` or `rpy` may be given, not both");
            }
            let parts: [f64; 4] = std::array::from_fn(|k| self.si(&key.index(k), &quaternion[k]));
            let norm = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
            match pose([0.0; 3], parts) {
                Some(turned) if (norm - 1.0).abs() < 1e-3 => rotation = turned.rotation,
                _ => self.fault(
                    &key,
                    format!("w, x, y, z must have length 1 within 0.001, found {norm:.6}"),
                ),
            }
        }
        Pose::from_parts(Translation3::from(position), rotation)
    }

    /// Value of the word at a key; the first allowed word is the default.
    fn choice<T: Copy>(&self, path: &KeyPath, given: &Option<String>, known: &[(&str, T)]) -> T {
        let given = given.as_deref().unwrap_or(known[0].0);
        let found = known.iter().find(|(word, _)| *word == given);
        if found.is_none() {
            let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
            let words = words.join(", ");
            self.fault(
                path,
                format!("{given:?} is not a valid value; allowed: {words}"),
            );
        }
        found.unwrap_or(&known[0]).1
    }

    /// A driver of the given joints.
    pub fn driver(
        &self,
        path: &KeyPath,
        driver: &typed::Driver,
        is_axis: bool,
        joints: &[String],
    ) -> Driver {
        if matches!(driver, typed::Driver::Stepper(_)) && !is_axis {
            self.fault(
                &path.key("kind"),
                "this kind does not fit here; allowed: file, rosbridge, ros1, ros2",
            );
        }
        match driver {
            typed::Driver::File(file) => {
                let formats = [("csv", false), ("json-lines", true)];
                let json_lines = self.choice(&path.key("format"), &file.format, &formats);
                let key = path.key("path");
                let place = (file.path != "-").then(|| self.file_at(&key, &file.path));
                if let Some(place) = &place
                    && let Err(message) = FileDriver::check_place(place, joints, json_lines)
                {
                    self.fault(&key, message);
                }
                Driver::File {
                    path: place,
                    json_lines,
                }
            }
            typed::Driver::Rosbridge(bridge) => {
                let ros = bridge.ros.unwrap_or(1);
                if !(1..=2).contains(&ros) {
                    self.fault(&path.key("ros"), format!("{ros}; allowed: 1 or 2"));
                }
                let server = bridge.address.split('/').next().unwrap_or_default();
                if !has_port(server) {
                    self.fault(
                        &path.key("address"),
                        "host and port are needed, as in \"192.168.1.5:9090\", and a path behind them where the server asks for one",
                    );
                }
                Driver::Rosbridge {
                    address: bridge.address.clone(),
                    ros,
                    action: bridge.action.clone(),
                    joint_states: bridge.joint_states.clone(),
                }
            }
            typed::Driver::Ros1(ros) => {
                let authority = ros.master.strip_prefix("http://").unwrap_or_default();
                if !has_port(authority.trim_end_matches('/')) {
                    self.fault(
                        &path.key("master"),
                        "an address is needed, as in \"http://192.168.1.5:11311\"",
                    );
                }
                Driver::Ros1 {
                    master: ros.master.clone(),
                    action: ros.action.clone(),
                    joint_states: ros.joint_states.clone(),
                }
            }
            typed::Driver::Ros2(ros) => Driver::Ros2(self.ros_2(path, ros)),
            typed::Driver::Stepper(stepper) => {
                if stepper.steps_per_turn == 0 {
                    self.fault(&path.key("steps_per_turn"), "0 must be above 0");
                }
                Driver::Stepper {
                    port: stepper.port.clone(),
                    baud: stepper.baud.unwrap_or(115_200),
                    steps_per_turn: stepper.steps_per_turn.max(1),
                }
            }
        }
    }

    /// A gripper that uses the driver of its arm.
    pub fn gripper(
        &self,
        path: &KeyPath,
        gripper: &typed::Gripper,
        driver: Option<&typed::Driver>,
    ) -> Gripper {
        if !matches!(
            driver,
            Some(typed::Driver::Rosbridge(_) | typed::Driver::Ros1(_) | typed::Driver::Ros2(_))
        ) {
            self.fault(
                path,
                "a gripper uses the driver of its arm, which must be of kind \"rosbridge\", \
                 \"ros1\" or \"ros2\"",
            );
        }
        let opening = |key: &str, given: &Option<Quantity<Length>>, otherwise: f64| {
            self.not_negative(&path.key(key), given, otherwise, "m")
        };
        let effort = path.key("max_effort");
        Gripper {
            max_effort: self.not_negative(&effort, &gripper.max_effort, EFFORT, "N"),
            action: gripper.action.clone(),
            open: opening("open", &gripper.open, OPEN),
            closed: opening("closed", &gripper.closed, 0.0),
            joint: gripper.joint.clone(),
        }
    }

    fn ros_2(&self, path: &KeyPath, ros: &typed::Ros2Driver) -> Ros2Address {
        let domain = ros.domain.unwrap_or(0);
        // Higher domains would need ports out of range.
        if domain > 232 {
            self.fault(
                &path.key("domain"),
                format!("{domain}; allowed: 0 to 232, the robot's ROS_DOMAIN_ID"),
            );
        }
        let kinds = [
            ("fast-dds", Middleware::FastDds),
            ("cyclone-dds", Middleware::CycloneDds),
        ];
        let middleware = self.choice(&path.key("middleware"), &ros.middleware, &kinds);
        let interface = ros.interface.as_ref().and_then(|text| {
            let address = text.parse().ok();
            if address.is_none() {
                self.fault(
                    &path.key("interface"),
                    "an address of this machine is needed, as in \"192.168.1.10\"",
                );
            }
            address
        });
        Ros2Address {
            domain,
            middleware,
            interface,
            action: ros.action.clone(),
            joint_states: ros.joint_states.clone(),
        }
    }
}

/// Whether the address of a server includes a port.
fn has_port(server: &str) -> bool {
    let port = server.rsplit_once(':').map(|(_, port)| port.parse());
    matches!(port, Some(Ok(1..=u16::MAX)))
}
