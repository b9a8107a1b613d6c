//! Converts the cell file as typed to the cell in SI units.

use super::resolve_chain::resolve_arm;
use super::resolve_signals::signals;
use super::resolved::{Arm, Axis, Camera, Cell, Chuck, Obstacle, Table};
use super::resolver::Resolver;
use super::safety::Safety;
use super::typed::{self, CellFile};
use rodlab_lab::scenario::dimension::{Angle, Length, Time};
use rodlab_lab::scenario::{KeyPath, Quantity, ScenarioError, TypedFile};
use rodlab_robot::{Limits, StreamBounds, Tolerance, TopicName};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

impl Cell {
    /// Reads a cell file. Names of files in it are relative to the file that contains them.
    ///
    /// # Errors
    /// All faults of the file, with file, line and column.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file: TypedFile<CellFile> = TypedFile::read(path)?;
        let resolver = Resolver {
            issues: RefCell::default(),
            warnings: RefCell::default(),
            file: &file,
        };
        let cell = resolver.cell(path);
        let issues = resolver.issues.into_inner();
        issues.or_ok(cell).map_err(|issues| file.locate(issues))
    }
}

impl Resolver<'_> {
    fn cell(&self, path: &Path) -> Cell {
        let typed = &self.file.typed;
        let root = KeyPath::root();
        if typed.arms.is_empty() && typed.axes.is_empty() {
            self.fault(
                &root,
                "a cell needs an arm ([[arms]]) or an axis ([[axes]])",
            );
        }
        self.unique_names();
        let arms = typed.arms.iter().enumerate();
        let arms = arms.filter_map(|(k, arm)| resolve_arm(self, &root.key("arms").index(k), arm));
        let arms: Vec<Arm> = arms.collect();
        let axes = typed.axes.iter().enumerate();
        let axes = axes.map(|(k, axis)| self.axis(&root.key("axes").index(k), axis));
        let axes = axes.collect();
        let obstacles = typed.obstacles.iter().enumerate().map(|(k, obstacle)| {
            let path = root.key("obstacles").index(k);
            Obstacle {
                name: obstacle.name.clone(),
                pose: self.pose(
                    &path,
                    &obstacle.position,
                    &obstacle.quaternion,
                    &obstacle.rpy,
                ),
                size: self.sides(&path.key("size"), &obstacle.size),
            }
        });
        let obstacles = obstacles.collect();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let safety = self.safety(&arms);
        Cell {
            title: typed.title.clone().unwrap_or_else(|| stem.into_owned()),
            arms,
            axes,
            table: typed.table.as_ref().map(|table| self.table(table)),
            obstacles,
            chuck: typed.chuck.as_ref().map(|chuck| self.chuck(chuck)),
            camera: typed.camera.as_ref().map(|camera| self.camera(camera)),
            rod: typed.rod.as_ref().map(|rod| self.rod(rod)),
            safety,
            streaming: self.streaming(),
            diagnostics: self.diagnostics(),
            warnings: self.warnings.take(),
        }
    }

    fn unique_names(&self) {
        let typed = &self.file.typed;
        let arms = typed.arms.iter().map(|arm| &arm.name).enumerate();
        let axes = typed.axes.iter().map(|axis| &axis.name).enumerate();
        let mut known = BTreeSet::new();
        for (table, k, name) in arms
            .map(|(k, name)| ("arms", k, name))
            .chain(axes.map(|(k, name)| ("axes", k, name)))
        {
            let path = KeyPath::from(table).index(k).key("name");
            if name.is_empty() || name.contains(['.', ',']) {
                self.fault(&path, "a name without points and commas is needed");
            }
            if !known.insert(name) {
                self.fault(&path, format!("another arm or axis is called {name:?}"));
            }
        }
    }

    fn axis(&self, path: &KeyPath, axis: &typed::Axis) -> Axis {
        let [lower, upper] = self.range(path, [&axis.lower, &axis.upper], "rad");
        let jerk = axis.jerk.unwrap_or(f64::INFINITY);
        if !(jerk > 0.0) {
            self.fault(&path.key("jerk"), format!("{jerk} must be above 0"));
        }
        Axis {
            name: axis.name.clone(),
            limits: Limits {
                lower,
                upper,
                velocity: self.positive_si(&path.key("velocity"), &axis.velocity),
                acceleration: self.positive(&path.key("acceleration"), axis.acceleration),
                jerk,
            },
            driver: axis.driver.as_ref().map(|driver| {
                let joints = std::slice::from_ref(&axis.name);
                self.driver(&path.key("driver"), driver, true, joints)
            }),
        }
    }

    fn rod(&self, rod: &typed::SuppliedRod) -> PathBuf {
        let path = KeyPath::from("rod").key("file");
        let file = self.file_at(&path, &rod.file);
        if !file.is_file() {
            self.fault(&path, format!("file {} does not exist", file.display()));
        }
        file
    }

    fn chuck(&self, chuck: &typed::Chuck) -> Chuck {
        let path = KeyPath::from("chuck");
        let axes = self.file.typed.axes.iter();
        let names: Vec<&str> = axes.map(|axis| axis.name.as_str()).collect();
        let axis = names.iter().position(|name| *name == chuck.axis);
        Chuck {
            axis: axis.unwrap_or_else(|| {
                let known = match names.is_empty() {
                    true => "the cell has no [[axes]]".to_owned(),
                    false => format!("there are {}", names.join(", ")),
                };
                self.fault(
                    &path.key("axis"),
                    format!("no axis is called {:?}; {known}", chuck.axis),
                );
                0
            }),
            pose: self.pose(&path, &chuck.position, &chuck.quaternion, &chuck.rpy),
        }
    }

    fn table(&self, table: &typed::Table) -> Table {
        let path = KeyPath::from("table");
        Table {
            top: self.pose(&path, &table.position, &table.quaternion, &table.rpy),
            size: self.sides(&path.key("size"), &table.size),
        }
    }

    fn camera(&self, camera: &typed::Camera) -> Camera {
        let path = KeyPath::from("camera");
        for (key, pixels) in [("width", camera.width), ("height", camera.height)] {
            if pixels == 0 {
                self.fault(&path.key(key), "0 must be above 0");
            }
        }
        self.positive(&path.key("fx"), camera.fx);
        self.positive(&path.key("fy"), camera.fy);
        // `rodlab trace` locates points at this height.
        if let Some(height) = &camera.table_height {
            self.si(&path.key("table_height"), height);
        }
        if camera.distortion.len() > 5 {
            self.fault(
                &path.key("distortion"),
                "k1, k2, p1, p2, k3 are allowed: five numbers at most",
            );
        }
        Camera {
            size: [camera.width, camera.height],
            intrinsics: [camera.fx, camera.fy, camera.cx, camera.cy],
            distortion: camera.distortion.clone(),
            pose: self.pose(&path, &camera.position, &camera.quaternion, &None),
            source: camera.source.clone(),
        }
    }

    /// Tolerances of the joints: those of revolute joints are under a key of `[streaming]`, those
    /// of prismatic joints under the same key with `_prismatic`.
    fn tolerance(
        &self,
        key: &str,
        turning: &Option<Quantity<Angle>>,
        sliding: &Option<Quantity<Length>>,
        otherwise: Tolerance,
    ) -> Tolerance {
        let streaming = KeyPath::from("streaming");
        let turns = streaming.key(key);
        let slides = streaming.key(&format!("{key}_prismatic"));
        Tolerance {
            revolute: self.positive(&turns, self.si_or(&turns, turning, otherwise.revolute)),
            prismatic: self.positive(&slides, self.si_or(&slides, sliding, otherwise.prismatic)),
        }
    }

    /// Limits of the hands. The hands of all arms must be inside the box at home.
    fn safety(&self, arms: &[Arm]) -> Safety {
        let Some(typed) = &self.file.typed.safety else {
            return Safety::default();
        };
        let path = KeyPath::from("safety");
        let workspace = typed.workspace.as_ref().map(|typed| {
            let path = path.key("workspace");
            let lower = self.vector(&path.key("lower"), &typed.lower);
            let upper = self.vector(&path.key("upper"), &typed.upper);
            if (0..3).any(|axis| !(lower[axis] < upper[axis])) {
                let message = "each coordinate must be below that of `upper`";
                self.fault(&path.key("lower"), message);
            }
            [lower, upper]
        });
        let hand_speed = typed.hand_speed.as_ref();
        let safety = Safety {
            workspace,
            hand_speed: hand_speed.map(|speed| self.positive_si(&path.key("hand_speed"), speed)),
            first_run: typed.first_run.inspect(|speed| {
                if !(0.01..=1.0).contains(speed) {
                    let message = format!("{speed}; allowed: 0.01 to 1");
                    self.fault(&path.key("first_run"), message);
                }
            }),
            signals: signals(self, &path.key("signals"), &typed.signals),
        };
        for arm in arms {
            let hand = arm.hand(&arm.home).translation.vector;
            if let Some(message) = safety.outside(&hand, 0.0) {
                let message = format!("{}, at home: {message}", arm.name);
                self.fault(&path.key("workspace"), message);
            }
        }
        safety
    }

    fn diagnostics(&self) -> Option<TopicName> {
        let name = self.file.typed.streaming.as_ref()?.diagnostics.as_ref()?;
        let message = match TopicName::parse(name, "diagnostics") {
            Some(Ok(topic @ (TopicName::Ros1 { .. } | TopicName::Ros2(_)))) => return Some(topic),
            Some(Err(message)) => message,
            _ => format!("{name}: needed: ros1://host:port/topic or ros2://domain/topic"),
        };
        self.fault(&KeyPath::from("streaming").key("diagnostics"), message);
        None
    }

    fn streaming(&self) -> StreamBounds {
        let default = StreamBounds::default();
        let Some(typed) = &self.file.typed.streaming else {
            return default;
        };
        let path = KeyPath::from("streaming");
        let duration = |key: &str, given: &Option<Quantity<Time>>, least: f64, most: f64| {
            let path = path.key(key);
            let seconds = self.si(&path, given.as_ref()?);
            if !(least..=most).contains(&seconds) {
                self.fault(
                    &path,
                    format!("{seconds} s; allowed: {least} s to {most} s"),
                );
                return None;
            }
            Some(Duration::from_secs_f64(seconds))
        };
        StreamBounds {
            start: self.tolerance(
                "start_tolerance",
                &typed.start_tolerance,
                &typed.start_tolerance_prismatic,
                default.start,
            ),
            tracking: self.tolerance(
                "tracking_tolerance",
                &typed.tracking_tolerance,
                &typed.tracking_tolerance_prismatic,
                default.tracking,
            ),
            watchdog: duration("watchdog", &typed.watchdog, 0.02, 10.0).unwrap_or(default.watchdog),
            longest_pause: duration("longest_pause", &typed.longest_pause, 0.0, 86_400.0)
                .or(default.longest_pause),
            horizon: duration("horizon", &typed.horizon, 1.0, 600.0).or(default.horizon),
        }
    }
}
