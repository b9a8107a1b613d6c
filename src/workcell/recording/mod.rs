//! Logs of motions and tasks. [`record`] makes one MCAP file of a log, with messages of ROS 2, for
//! Foxglove, `ros2 bag` and other programs.
//!
//! | topic | message | content |
//! |---|---|---|
//! | `/PART/joint_states` | `sensor_msgs/msg/JointState` | reported positions |
//! | `/PART/commanded` | `sensor_msgs/msg/JointState` | points of the trajectory, when they were due |
//! | `/events` | `rcl_interfaces/msg/Log` | events of the motions, named by their folders |
//! | `/signals` | `rcl_interfaces/msg/Log` | messages of safety signals |
//! | `/picture` | `sensor_msgs/msg/CompressedImage` | photographs of the result |
//!
//! The tables and pictures of the log are attached to the file, so that [`unpack`] restores the
//! log. [`replay`] reads the measured motion of a log, and compares it with its plan.

mod attachments;
mod cdr;
mod replay;
mod source;

pub use attachments::unpack;
pub use replay::{HandPath, Replay, ReplayedMotion, replay};

use cdr::{COMPRESSED_IMAGE, JOINT_STATE, LOG, MessageType};
use mcap::records::MessageHeader;
use mcap::{Attachment, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Why a recording cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The directory has no log.
    #[error(
        "{0} has no events.csv of a motion; needed: the log of `rodlab stream` or the results of a task in a cell"
    )]
    NoLog(PathBuf),
    /// The joints of the log belong to another cell.
    #[error(
        "{directory} has no report of an arm of the cell \"{cell}\"; --cell selects another cell"
    )]
    NoArm {
        /// The directory.
        directory: PathBuf,
        /// Title of the cell.
        cell: String,
    },
    /// The log was written by an earlier version.
    #[error(
        "{0} does not begin with the time at which it was opened; earlier versions wrote no time"
    )]
    WithoutTime(PathBuf),
    /// A table is damaged.
    #[error("{path}: {error}")]
    Table {
        /// The table.
        path: PathBuf,
        /// The error.
        error: csv::Error,
    },
    /// A file cannot be read.
    #[error("{path}: {error}")]
    File {
        /// The file.
        path: PathBuf,
        /// The error.
        error: std::io::Error,
    },
    /// A recording is damaged.
    #[error("{path}: {error}")]
    Recording {
        /// The recording.
        path: PathBuf,
        /// The error.
        error: mcap::McapError,
    },
    /// A recording has only messages.
    #[error("{0} has no attached files of a log; `rodlab export --format mcap` attaches them")]
    NoAttachments(PathBuf),
    /// The name of an attached file leads out of the log.
    #[error("{path}: the attached file {name:?} does not belong to a log")]
    AttachmentName {
        /// The recording.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// The recording cannot be encoded.
    #[error(transparent)]
    Mcap(#[from] mcap::McapError),
}

impl RecordingError {
    fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        |error| Self::File { path, error }
    }
}

/// A recording.
pub struct Recording {
    /// The bytes of the file.
    pub file: Vec<u8>,
    /// Number of messages.
    pub messages: usize,
    /// Number of motions.
    pub motions: usize,
    /// Time from the first message to the last one, s.
    pub duration: f64,
}

/// A message before it is written.
struct Message {
    /// ns.
    time: u64,
    topic: String,
    kind: MessageType,
    data: Vec<u8>,
}

/// Makes a recording of the log in a directory.
///
/// # Errors
/// See [`RecordingError`].
pub fn record(directory: &Path) -> Result<Recording, RecordingError> {
    let motions = source::motions(directory)?;
    if motions.is_empty() {
        return Err(RecordingError::NoLog(directory.to_owned()));
    }
    let mut messages = Vec::new();
    for motion in &motions {
        for (time, event) in motion.events() {
            let time = nanoseconds(time);
            messages.push(Message {
                time,
                topic: "/events".into(),
                kind: LOG,
                data: cdr::log(time, &motion.name, event),
            });
        }
        for (table, topic) in [
            ("state.csv", "joint_states"),
            ("commanded.csv", "commanded"),
        ] {
            for joints in motion.joints(table)? {
                let time = nanoseconds(joints.time);
                messages.push(Message {
                    time,
                    topic: format!("/{}/{topic}", joints.part),
                    kind: JOINT_STATE,
                    data: cdr::joint_state(time, &joints.names, &joints.positions),
                });
            }
        }
    }
    for (time, name, content) in source::signals(directory)? {
        let time = nanoseconds(time);
        messages.push(Message {
            time,
            topic: "/signals".into(),
            kind: LOG,
            data: cdr::log(time, &name, &content),
        });
    }
    for (time, file) in source::pictures(directory)? {
        let time = nanoseconds(time);
        messages.push(Message {
            time,
            topic: "/picture".into(),
            kind: COMPRESSED_IMAGE,
            data: cdr::picture(time, &file),
        });
    }
    messages.sort_by_key(|message| message.time);
    let ends = messages.first().zip(messages.last());
    let duration = ends.map_or(0.0, |(first, last)| (last.time - first.time) as f64 * 1e-9);
    Ok(Recording {
        file: encoded(&messages, &attachments::attached(directory)?)?,
        messages: messages.len(),
        motions: motions.len(),
        duration,
    })
}

fn nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}

fn encoded(messages: &[Message], attachments: &[Attachment]) -> Result<Vec<u8>, mcap::McapError> {
    let options = WriteOptions::new().compression(None).profile("ros2");
    let mut writer = Writer::with_options(Cursor::new(Vec::new()), options)?;
    let mut channels = BTreeMap::new();
    for (sequence, message) in messages.iter().enumerate() {
        let channel_id = match channels.get(&message.topic) {
            Some(id) => *id,
            None => {
                let kind = message.kind;
                let schema = writer.add_schema(kind.name, "ros2msg", kind.definition.as_bytes())?;
                let id = writer.add_channel(schema, &message.topic, "cdr", &BTreeMap::new())?;
                channels.insert(message.topic.clone(), id);
                id
            }
        };
        let header = MessageHeader {
            channel_id,
            sequence: sequence as u32,
            log_time: message.time,
            publish_time: message.time,
        };
        writer.write_to_known_channel(&header, &message.data)?;
    }
    for attachment in attachments {
        writer.attach(attachment)?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_log_becomes_messages_in_the_order_of_their_times() {
        let directory = tempfile::tempdir().unwrap();
        let directory = directory.path();
        for (motion, opened) in [("laying", 1000.5), ("approach", 990.25)] {
            let folder = directory.join(motion);
            fs::create_dir(&folder).unwrap();
            let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
            write(
                "events.csv",
                &format!("time_s,event\n0.0,\"opened {opened}\"\n0.5,\"started, at last\"\n"),
            );
            let rows = "time_s,part,joint,position\n0.6,arm,a,1.0\n0.6,arm,b,2.0\n0.7,arm,a,1.5\n0.7,arm,b,2.5\n";
            write("state.csv", rows);
            write(
                "commanded.csv",
                "time_s,part,joint,position\n0.55,arm,a,1.25\n",
            );
        }
        fs::write(
            directory.join("signals.csv"),
            "time_s,signal,message\n995.0,stop,false\n",
        )
        .unwrap();
        let recording = record(directory).unwrap();
        assert_eq!((recording.motions, recording.messages), (2, 11));
        assert!((recording.duration - 10.95).abs() < 1e-6);
        let read = mcap::MessageStream::new(&recording.file).unwrap();
        let read: Vec<_> = read.map(Result::unwrap).collect();
        let topics: Vec<_> = read
            .iter()
            .map(|message| message.channel.topic.as_str())
            .collect();
        let motion = [
            "/events",
            "/events",
            "/arm/commanded",
            "/arm/joint_states",
            "/arm/joint_states",
        ];
        let expected = [&motion[..], &["/signals"], &motion[..]].concat();
        assert_eq!(topics, expected);
        assert_eq!(read[3].log_time, 990_850_000_000);
        assert_eq!(
            read[3].data[..],
            cdr::joint_state(990_850_000_000, &["a".into(), "b".into()], &[1.0, 2.0])
        );
        assert_eq!(
            read[3].channel.schema.as_ref().unwrap().name,
            "sensor_msgs/msg/JointState"
        );
    }

    #[test]
    fn directories_without_a_log_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let fault = |directory: &Path| record(directory).err().unwrap().to_string();
        assert!(fault(directory.path()).contains("no events.csv"));
        let events = directory.path().join("events.csv");
        fs::write(&events, "time_s,event\n0.5,\"started\"\n").unwrap();
        assert!(fault(directory.path()).contains("earlier versions"));
        fs::write(&events, "time_s,event\nhalf,\"started\"\n").unwrap();
        assert!(
            fault(directory.path()).contains("events.csv: CSV"),
            "{}",
            fault(directory.path())
        );
    }
}
