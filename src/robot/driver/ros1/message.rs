//! The ROS 1 messages of a trajectory, in their binary form: little-endian numbers, texts and
//! arrays after their lengths.

use super::super::Interpolant;
use super::super::diagnostics::DiagnosticStatus;
use super::super::picture::RawImage;

/// Type of a topic: name and MD5 sum of its definition.
#[derive(Clone, Copy, Debug)]
pub struct MessageType {
    /// Name, such as `sensor_msgs/JointState`.
    pub name: &'static str,
    /// MD5 sum, such as `3066dcd76a6cfaef579bd0f34173e9fd`.
    pub md5: &'static str,
}

impl MessageType {
    /// Longest message that is read, bytes.
    pub fn longest(self) -> usize {
        match self.name {
            "sensor_msgs/Image" | "sensor_msgs/CompressedImage" => 64 << 20,
            _ => 1 << 20,
        }
    }
}

/// Positions of joints.
pub const JOINT_STATE: MessageType = MessageType {
    name: "sensor_msgs/JointState",
    md5: "3066dcd76a6cfaef579bd0f34173e9fd",
};
/// The goal of a motion.
pub const GOAL: MessageType = MessageType {
    name: "control_msgs/FollowJointTrajectoryActionGoal",
    md5: "cff5c1d533bf2f82dd0138d57f4304bb",
};
/// The feedback of a motion.
pub const FEEDBACK: MessageType = MessageType {
    name: "control_msgs/FollowJointTrajectoryActionFeedback",
    md5: "d8920dc4eae9fc107e00999cce4be641",
};
/// Its result.
pub const RESULT: MessageType = MessageType {
    name: "control_msgs/FollowJointTrajectoryActionResult",
    md5: "c4fb3b000dc9da4fd99699380efcc5d9",
};
/// The cancellation of a motion.
pub const CANCEL: MessageType = MessageType {
    name: "actionlib_msgs/GoalID",
    md5: "302881f31927c1df708a2dbab0e80ee8",
};
/// The goal of a gripper.
pub const GRIPPER_GOAL: MessageType = MessageType {
    name: "control_msgs/GripperCommandActionGoal",
    md5: "aa581f648a35ed681db2ec0bf7a82bea",
};
/// Its result.
pub const GRIPPER_RESULT: MessageType = MessageType {
    name: "control_msgs/GripperCommandActionResult",
    md5: "143702cb2df0f163c5283cedc5efc6b6",
};
/// Time of a simulated robot.
pub const CLOCK: MessageType = MessageType {
    name: "rosgraph_msgs/Clock",
    md5: "a9c97c1d230cfc112e270351a944ee47",
};

/// A picture as its pixels.
pub const IMAGE: MessageType = MessageType {
    name: "sensor_msgs/Image",
    md5: "060021388200f6f0f447d0fcd9c64743",
};
/// A picture as a PNG or JPEG file.
pub const COMPRESSED_IMAGE: MessageType = MessageType {
    name: "sensor_msgs/CompressedImage",
    md5: "8f7a12909da2c9d3332d540a0977563f",
};

/// Statuses for monitors.
pub const DIAGNOSTICS: MessageType = MessageType {
    name: "diagnostic_msgs/DiagnosticArray",
    md5: "60810da900de1dd6ddd437c3503511da",
};

/// Writes a message.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn u32(&mut self, number: u32) {
        self.0.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.u32(text.len() as u32);
        self.0.extend(text.as_bytes());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.u32(numbers.len() as u32);
        numbers
            .iter()
            .for_each(|number| self.0.extend(number.to_le_bytes()));
    }

    /// Writes a header without a time, which means "at once".
    pub(super) fn header(&mut self) {
        (0..3).for_each(|_| self.u32(0));
        self.text("");
    }

    fn duration(&mut self, seconds: f64) {
        let nanoseconds = (seconds * 1e9).round() as u64;
        self.u32((nanoseconds / 1_000_000_000) as u32);
        self.u32((nanoseconds % 1_000_000_000) as u32);
    }

    fn goal_id(&mut self, id: &str) {
        (0..2).for_each(|_| self.u32(0));
        self.text(id);
    }
}

/// Writes a goal to be followed at once, with the tolerances of the controller.
pub fn goal(joints: &[String], motion: &Interpolant, id: &str) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.header();
    writer.goal_id(id);
    writer.header();
    writer.u32(joints.len() as u32);
    joints.iter().for_each(|joint| writer.text(joint));
    writer.u32(motion.points().len() as u32);
    for (time, point, velocities) in motion.rows() {
        writer.numbers(point);
        writer.numbers(velocities);
        writer.numbers(&[]);
        writer.numbers(&[]);
        writer.duration(time);
    }
    writer.u32(0);
    writer.u32(0);
    writer.duration(0.0);
    writer.0
}

/// Writes statuses with a time since 1970.
pub fn diagnostics(time: std::time::Duration, statuses: &[DiagnosticStatus]) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.u32(0);
    writer.u32(time.as_secs() as u32);
    writer.u32(time.subsec_nanos());
    writer.text("");
    writer.u32(statuses.len() as u32);
    for status in statuses {
        writer.0.push(status.level as u8);
        writer.text(&status.name);
        writer.text(&status.message);
        writer.text(&status.hardware);
        writer.u32(status.values.len() as u32);
        for (key, value) in &status.values {
            writer.text(key);
            writer.text(value);
        }
    }
    writer.0
}

/// Writes the goal of an opening of a gripper, m, with a maximum effort, N.
pub fn gripper_goal(opening: f64, max_effort: f64, id: &str) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.header();
    writer.goal_id(id);
    for number in [opening, max_effort] {
        writer.0.extend(number.to_le_bytes());
    }
    writer.0
}

/// Writes a cancellation.
pub fn cancel(id: &str) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.goal_id(id);
    writer.0
}

/// Reads a message.
pub(super) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// Reads from the first byte on.
    pub(super) fn new(message: &'a [u8]) -> Self {
        Self(message)
    }

    pub(super) fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.0.split_at_checked(count)?;
        self.0 = tail;
        Some(head)
    }

    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.bytes(4)?.try_into().ok()?))
    }

    pub(super) fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        Some(String::from_utf8_lossy(self.bytes(length)?).into_owned())
    }

    fn texts(&mut self) -> Option<Vec<String>> {
        let count = self.u32()?;
        (0..count).map(|_| self.text()).collect()
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.bytes(8)?.try_into().ok()?))
    }

    fn numbers(&mut self) -> Option<Vec<f64>> {
        let count = self.u32()? as usize;
        let bytes = self.bytes(count.checked_mul(8)?)?;
        let numbers = bytes
            .chunks_exact(8)
            .map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap_or_default()));
        Some(numbers.collect())
    }

    fn time(&mut self) -> Option<f64> {
        let (seconds, nanoseconds) = (self.u32()?, self.u32()?);
        Some(f64::from(seconds) + 1e-9 * f64::from(nanoseconds))
    }

    /// The time of a `std_msgs/Header`, s.
    pub(super) fn header(&mut self) -> Option<f64> {
        self.u32()?;
        let time = self.time()?;
        self.text().map(|_| time)
    }
}

/// Reported joints.
pub struct JointStates {
    /// Time of the report, s.
    pub time: f64,
    /// Names of joints.
    pub names: Vec<String>,
    /// Their positions, rad or m.
    pub positions: Vec<f64>,
    /// Their efforts, N m or N; empty if none are reported.
    pub efforts: Vec<f64>,
}

/// The joints of a joint state; `None` if the message is damaged.
pub fn joint_state(message: &[u8]) -> Option<JointStates> {
    let mut reader = Reader(message);
    let time = reader.header()?;
    let (names, positions) = (reader.texts()?, reader.numbers()?);
    let _velocities = reader.numbers()?;
    Some(JointStates {
        time,
        names,
        positions,
        efforts: reader.numbers()?,
    })
}

/// Identifier and status of a goal.
#[derive(Debug, PartialEq, Eq)]
pub struct GoalStatus {
    /// Its id.
    pub id: String,
    /// `actionlib_msgs/GoalStatus`.
    pub status: u8,
    /// Words.
    pub text: String,
}

fn goal_status(reader: &mut Reader<'_>) -> Option<GoalStatus> {
    reader.header()?;
    reader.bytes(8)?;
    let id = reader.text()?;
    let status = reader.bytes(1)?[0];
    let text = reader.text()?;
    Some(GoalStatus { id, status, text })
}

/// The status at the beginning of a feedback or a result.
pub fn status_of(message: &[u8]) -> Option<GoalStatus> {
    goal_status(&mut Reader(message))
}

/// The goal of a feedback message, the names of the joints and the setpoint, rad or m. Missing
/// names and setpoints are empty.
pub fn feedback(message: &[u8]) -> Option<(GoalStatus, Vec<String>, Vec<f64>)> {
    let mut reader = Reader(message);
    let status = goal_status(&mut reader)?;
    let setpoint = reader.header().and_then(|_| {
        let names = reader.texts()?;
        Some((names, reader.numbers()?))
    });
    let (names, positions) = setpoint.unwrap_or_default();
    Some((status, names, positions))
}

/// The status of a result, its code and its message.
pub fn result(message: &[u8]) -> Option<(GoalStatus, i32, String)> {
    let mut reader = Reader(message);
    let status = goal_status(&mut reader)?;
    let code = reader.u32()? as i32;
    Some((status, code, reader.text()?))
}

/// Whether the result of a gripper reports that its fingers exert their maximum effort and do not
/// move.
pub fn is_stalled(message: &[u8]) -> bool {
    let mut reader = Reader(message);
    let stalled = goal_status(&mut reader).and_then(|_| {
        reader.bytes(2 * size_of::<f64>())?;
        reader.bytes(1)
    });
    stalled.is_some_and(|byte| byte[0] != 0)
}

/// The time of a simulated robot, s; `None` if the message is damaged.
pub fn clock(message: &[u8]) -> Option<f64> {
    Reader(message).time()
}

/// A picture as its pixels; `None` if the message is damaged.
pub fn raw_image(message: &[u8]) -> Option<RawImage<'_>> {
    let mut reader = Reader(message);
    reader.header()?;
    let (height, width) = (reader.u32()?, reader.u32()?);
    let encoding = reader.text()?;
    let is_big_endian = reader.bytes(1)?[0] != 0;
    let step = reader.u32()? as usize;
    let length = reader.u32()? as usize;
    Some(RawImage {
        size: [width, height],
        encoding,
        is_big_endian,
        step,
        data: reader.bytes(length)?,
    })
}

/// The file in a `sensor_msgs/CompressedImage`; `None` if the message is damaged.
pub fn compressed_image(message: &[u8]) -> Option<&[u8]> {
    let mut reader = Reader(message);
    reader.header()?;
    reader.text()?;
    let length = reader.u32()? as usize;
    reader.bytes(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_joint_state_is_read() {
        let mut writer = Writer::default();
        [1, 20, 500_000_000].iter().for_each(|n| writer.u32(*n));
        writer.text("base");
        writer.u32(2);
        writer.text("a");
        writer.text("bc");
        writer.numbers(&[1.0, -2.5]);
        writer.numbers(&[]);
        writer.numbers(&[3.0, 4.0]);
        let JointStates {
            time,
            names,
            positions,
            efforts,
        } = joint_state(&writer.0).unwrap();
        assert_eq!(time, 20.5);
        assert_eq!(names, ["a", "bc"]);
        assert_eq!(positions, [1.0, -2.5]);
        assert_eq!(efforts, [3.0, 4.0]);
        assert!((0..writer.0.len()).all(|end| joint_state(&writer.0[..end]).is_none()));
    }

    #[test]
    fn a_feedback_is_read_with_and_without_a_setpoint() {
        let mut writer = Writer::default();
        writer.header();
        writer.goal_id("g");
        writer.0.push(1);
        writer.text("");
        let without = feedback(&writer.0).unwrap();
        assert_eq!((without.0.id.as_str(), without.1.len()), ("g", 0));
        writer.header();
        writer.u32(1);
        writer.text("a");
        writer.numbers(&[0.5]);
        let (_, names, positions) = feedback(&writer.0).unwrap();
        assert_eq!((names, positions), (vec!["a".to_owned()], vec![0.5]));
    }

    #[test]
    fn times_never_have_a_billion_nanoseconds() {
        let mut writer = Writer::default();
        writer.duration(1.999_999_999_9);
        assert_eq!(writer.0, [2, 0, 0, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn a_clock_is_read() {
        let mut writer = Writer::default();
        writer.duration(12.25);
        assert_eq!(clock(&writer.0), Some(12.25));
        assert_eq!(clock(&writer.0[..7]), None);
    }

    proptest! {
        #[test]
        fn no_bytes_cause_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
            let _ = (joint_state(&bytes), status_of(&bytes), result(&bytes), feedback(&bytes));
            let _ = clock(&bytes);
            let _ = (raw_image(&bytes), compressed_image(&bytes));
        }
    }
}
