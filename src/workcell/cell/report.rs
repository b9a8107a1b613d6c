//! The report of `rodlab check` about a cell.

use super::resolved::{Cell, Driver};
use rodlab_robot::{Posture, Ros2Address, parts};
use serde::Serialize;
use std::fmt;

/// The numbers that follow from a cell file.
#[derive(Clone, Debug, Serialize)]
pub struct CellReport {
    title: String,
    arms: Vec<ArmReport>,
    axes: Vec<AxisReport>,
    table_top: Option<[f64; 3]>,
    obstacles: usize,
    camera: Option<[u32; 2]>,
    warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct ArmReport {
    name: String,
    joints: usize,
    links: usize,
    shapes: usize,
    /// Distance from the first joint to the hand along the links, m.
    reach_m: f64,
    base: [f64; 3],
    home: Posture,
    driver: String,
}

#[derive(Clone, Debug, Serialize)]
struct AxisReport {
    name: String,
    velocity: f64,
    driver: String,
}

impl CellReport {
    /// The report of a cell.
    pub fn new(cell: &Cell) -> Self {
        let arms = cell.arms.iter().map(|arm| {
            let offsets = arm.chain.segments.iter().skip(1).map(|link| link.origin);
            let offsets = offsets.chain([arm.chain.tool]);
            ArmReport {
                name: arm.name.clone(),
                joints: arm.chain.joints.len(),
                links: arm.chain.segments.len(),
                shapes: arm.bodies.len(),
                reach_m: offsets.map(|pose| pose.translation.vector.norm()).sum(),
                base: parts(&arm.base).0,
                home: Posture::new(&arm.chain, &arm.home, None),
                driver: in_words(arm.driver.as_ref()),
            }
        });
        let axes = cell.axes.iter().map(|axis| AxisReport {
            name: axis.name.clone(),
            velocity: axis.limits.velocity,
            driver: in_words(axis.driver.as_ref()),
        });
        Self {
            title: cell.title.clone(),
            arms: arms.collect(),
            axes: axes.collect(),
            table_top: cell.table.map(|table| parts(&table.top).0),
            obstacles: cell.obstacles.len(),
            camera: cell.camera.as_ref().map(|camera| camera.size),
            warnings: cell.warnings.clone(),
        }
    }

    /// The numbers as one line of JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("numbers and names are JSON values")
    }
}

fn in_words(driver: Option<&Driver>) -> String {
    match driver {
        None => "none".to_owned(),
        Some(Driver::File { path: None, .. }) => "standard output".to_owned(),
        Some(Driver::File {
            path: Some(path), ..
        }) => format!("file {}", path.display()),
        Some(Driver::Rosbridge {
            address,
            ros,
            action,
            ..
        }) => format!("ROS {ros}, {action} through rosbridge at {address}"),
        Some(Driver::Ros1 { master, action, .. }) => format!("ROS 1, {action} at {master}"),
        Some(Driver::Ros2(address)) => format!(
            "ROS 2, {} in domain {} over {}{}",
            address.action,
            address.domain,
            address.middleware.name(),
            if Ros2Address::IS_BUILT {
                ""
            } else {
                " (not in this program)"
            }
        ),
        Some(Driver::Stepper { port, baud, .. }) => format!("stepper at {port}, {baud} baud"),
    }
}

impl fmt::Display for CellReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, value: String| writeln!(formatter, "  {name:<26}{value}");
        let place = |[x, y, z]: [f64; 3]| format!("{x:.4}, {y:.4}, {z:.4} m");
        line("title", self.title.clone())?;
        for arm in &self.arms {
            line("arm", arm.name.clone())?;
            line(
                "  joints, links, shapes",
                format!("{}, {}, {}", arm.joints, arm.links, arm.shapes),
            )?;
            line("  reach", format!("{:.3} m", arm.reach_m))?;
            line("  base", place(arm.base))?;
            line("  hand at home", place(arm.home.position))?;
            line(
                "  manipulability there",
                format!("{:.4}", arm.home.manipulability),
            )?;
            line("  driver", arm.driver.clone())?;
        }
        for axis in &self.axes {
            line("axis", axis.name.clone())?;
            line("  greatest speed", format!("{:.3} rad/s", axis.velocity))?;
            line("  driver", axis.driver.clone())?;
        }
        if let Some(top) = self.table_top {
            line("table top", place(top))?;
        }
        if self.obstacles > 0 {
            line("obstacles", self.obstacles.to_string())?;
        }
        if let Some([width, height]) = self.camera {
            line("camera", format!("{width} × {height} pixels"))?;
        }
        for warning in &self.warnings {
            line("note", warning.clone())?;
        }
        Ok(())
    }
}
