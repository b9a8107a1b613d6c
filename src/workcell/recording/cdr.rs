//! Messages of ROS 2 in CDR, little-endian: numbers at multiples of their size, texts with a
//! closing zero, sequences after their lengths.

/// A type of ROS 2 messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageType {
    /// Name, such as `sensor_msgs/msg/JointState`.
    pub name: &'static str,
    /// Definition, followed by those of the types in it.
    pub definition: &'static str,
}

/// Definition of a time, which follows those that have one.
macro_rules! time {
    () => {
        "\
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"
    };
}

/// Definition of a header, which follows those that have one.
macro_rules! header {
    () => {
        concat!(
            "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
",
            time!()
        )
    };
}

/// Positions of joints.
pub const JOINT_STATE: MessageType = MessageType {
    name: "sensor_msgs/msg/JointState",
    definition: concat!(
        "std_msgs/Header header\nstring[] name\n",
        "float64[] position\nfloat64[] velocity\nfloat64[] effort\n",
        header!()
    ),
};

/// A picture as a file.
pub const COMPRESSED_IMAGE: MessageType = MessageType {
    name: "sensor_msgs/msg/CompressedImage",
    definition: concat!(
        "std_msgs/Header header\nstring format\nuint8[] data\n",
        header!()
    ),
};

/// A line of a log.
pub const LOG: MessageType = MessageType {
    name: "rcl_interfaces/msg/Log",
    definition: concat!(
        "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\n",
        "string file\nstring function\nuint32 line\n",
        time!()
    ),
};

/// Level of a [`LOG`] that only informs.
const INFO: u8 = 20;

/// The bytes of a message.
struct Encoder(Vec<u8>);

impl Encoder {
    /// Length of the header, which names the encoding.
    const HEADER: usize = 4;

    fn new() -> Self {
        Self(vec![0, 1, 0, 0])
    }

    fn align(&mut self, size: usize) {
        while !(self.0.len() - Self::HEADER).is_multiple_of(size) {
            self.0.push(0);
        }
    }

    fn u32(&mut self, number: u32) {
        self.align(4);
        self.0.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    fn texts(&mut self, texts: &[String]) {
        self.u32(texts.len() as u32);
        texts.iter().for_each(|text| self.text(text));
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.u32(numbers.len() as u32);
        for number in numbers {
            self.align(8);
            self.0.extend(number.to_le_bytes());
        }
    }

    /// A time, ns.
    fn time(&mut self, time: u64) {
        self.u32((time / 1_000_000_000) as u32);
        self.u32((time % 1_000_000_000) as u32);
    }
}

/// A `sensor_msgs/msg/JointState` at a time, ns.
pub fn joint_state(time: u64, names: &[String], positions: &[f64]) -> Vec<u8> {
    let mut message = Encoder::new();
    message.time(time);
    message.text("");
    message.texts(names);
    message.numbers(positions);
    message.numbers(&[]);
    message.numbers(&[]);
    message.0
}

/// A `rcl_interfaces/msg/Log` at a time, ns.
pub fn log(time: u64, name: &str, what: &str) -> Vec<u8> {
    let mut message = Encoder::new();
    message.time(time);
    message.0.push(INFO);
    message.text(name);
    message.text(what);
    message.text("");
    message.text("");
    message.u32(0);
    message.0
}

/// A `sensor_msgs/msg/CompressedImage` at a time, ns: a PNG file.
pub fn picture(time: u64, file: &[u8]) -> Vec<u8> {
    let mut message = Encoder::new();
    message.time(time);
    message.text("camera");
    message.text("png");
    message.u32(file.len() as u32);
    message.0.extend(file);
    message.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The expected bytes were encoded by hand from the rules of CDR.
    #[test]
    fn numbers_lie_at_multiples_of_their_size() {
        let message = joint_state(1_500_000_000, &["j".into()], &[2.0]);
        let mut expected = vec![0, 1, 0, 0];
        let words = |bytes: &mut Vec<u8>, numbers: &[u32]| {
            bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        };
        words(&mut expected, &[1, 500_000_000, 1]);
        // The closing zero of an empty text, and three bytes up to the next number.
        expected.extend([0; 4]);
        words(&mut expected, &[1, 2]);
        expected.extend([b'j', 0, 0, 0]);
        words(&mut expected, &[1]);
        // 32 bytes after the header, the number is at a multiple of eight.
        assert_eq!(expected.len() - 4, 32);
        expected.extend(2.0_f64.to_le_bytes());
        words(&mut expected, &[0, 0]);
        assert_eq!(message, expected);
    }
}
