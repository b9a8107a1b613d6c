//! Pictures of a recording of ROS 1: a bag of version 2.0, as written by `rosbag record` and Intel
//! RealSense cameras.
//!
//! A bag is a sequence of records: a header of named fields, then data. Connections (op 7) name
//! topics, messages (op 2) have a time and a connection, chunks (op 5) hold both, plain or
//! compressed. All connections are repeated at its end.

use super::super::picture::{CameraPicture, pixels};
use super::bag_record::{decompressed, field, op, read_record, split_record, u32_of};
use super::bag_topic::{Topic, chosen, picture_topic};
use super::message::{compressed_image, raw_image};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

const MESSAGE: u8 = 2;
const BAG_HEADER: u8 = 3;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;

/// Reason why the pictures of a bag cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct BagError {
    /// The file.
    pub path: PathBuf,
    /// The error and the allowed values.
    pub reason: String,
}

/// A picture and the time of its recording.
#[derive(Clone, Debug, PartialEq)]
pub struct BagPicture {
    /// Seconds from the first picture of its topic.
    pub time: f64,
    /// The picture.
    pub picture: CameraPicture,
}

/// The pictures of a topic, in the order of the recording.
pub struct Bag {
    path: PathBuf,
    file: BufReader<File>,
    /// Numbers of the connections of the topic, and whether they send files.
    connections: Vec<(u32, bool)>,
    first: Option<f64>,
    /// Messages of the last chunk.
    waiting: VecDeque<Message>,
}

struct Message {
    nanoseconds: u64,
    is_compressed: bool,
    bytes: Vec<u8>,
}

impl Bag {
    /// Opens a bag at a picture topic: the named one, the only one, or the only one in colour.
    ///
    /// # Errors
    /// The file is not a bag of version 2.0, was not closed, or has no such topic.
    pub fn open(path: &Path, topic: Option<&str>) -> Result<Self, BagError> {
        let fault = |reason: String| BagError {
            path: path.to_owned(),
            reason,
        };
        let (file, topics) = open(path).map_err(&fault)?;
        let connections = chosen(topics, topic).map_err(fault)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            connections,
            first: None,
            waiting: VecDeque::new(),
        })
    }

    /// The next message of the topic; `None` at the end.
    fn next_message(&mut self) -> Result<Option<Message>, String> {
        loop {
            if let Some(message) = self.waiting.pop_front() {
                return Ok(Some(message));
            }
            let Some(record) = read_record(&mut self.file)? else {
                return Ok(None);
            };
            self.take(&record.header, record.data)?;
        }
    }

    /// Stores the messages of a record.
    fn take(&mut self, header: &[u8], data: Vec<u8>) -> Result<(), String> {
        match op(header) {
            Some(CHUNK) => {
                let size = field(header, "size").and_then(u32_of);
                let size = size.ok_or("a chunk has no size")? as usize;
                let chunk = decompressed(field(header, "compression"), data, size)?;
                let mut rest = &chunk[..];
                while !rest.is_empty() {
                    let (header, data) =
                        split_record(&mut rest).ok_or("a chunk holds a damaged record")?;
                    self.keep(header, || data.to_vec())?;
                }
                Ok(())
            }
            Some(_) => self.keep(header, || data),
            None => Err("a record has no type (`op`)".into()),
        }
    }

    /// Stores a message of the topic.
    fn keep(&mut self, header: &[u8], bytes: impl FnOnce() -> Vec<u8>) -> Result<(), String> {
        if op(header) != Some(MESSAGE) {
            return Ok(());
        }
        let connection = field(header, "conn").and_then(u32_of);
        let connection = connection.ok_or("a message has no connection (`conn`)")?;
        let Some((_, is_compressed)) = self
            .connections
            .iter()
            .find(|(number, _)| *number == connection)
        else {
            return Ok(());
        };
        let time = field(header, "time")
            .and_then(|time| Some((u32_of(time.get(..4)?)?, u32_of(time.get(4..)?)?)));
        let (seconds, nanoseconds) = time.ok_or("a message has no time")?;
        self.waiting.push_back(Message {
            nanoseconds: u64::from(seconds) * 1_000_000_000 + u64::from(nanoseconds),
            is_compressed: *is_compressed,
            bytes: bytes(),
        });
        Ok(())
    }

    fn picture(&mut self, message: &Message) -> Result<BagPicture, String> {
        const DAMAGED: &str = "a picture is damaged";
        let picture = if message.is_compressed {
            let file = compressed_image(&message.bytes).ok_or(DAMAGED)?;
            CameraPicture::File(file.to_vec())
        } else {
            let raw = raw_image(&message.bytes).ok_or(DAMAGED)?;
            CameraPicture::Pixels(pixels(&raw)?)
        };
        let time = message.nanoseconds as f64 * 1e-9;
        let first = *self.first.get_or_insert(time);
        Ok(BagPicture {
            time: time - first,
            picture,
        })
    }
}

impl Iterator for Bag {
    type Item = Result<BagPicture, BagError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_message().transpose()?;
        let picture = next.and_then(|message| self.picture(&message));
        Some(picture.map_err(|reason| BagError {
            path: self.path.clone(),
            reason,
        }))
    }
}

/// Opens a file; returns a reader after its bag header, and its picture topics.
fn open(path: &Path) -> Result<(BufReader<File>, Vec<Topic>), String> {
    let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
    if !path.metadata().map_err(unreadable)?.is_file() {
        return Err("it is not a regular file".into());
    }
    let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut magic = [0; MAGIC.len()];
    if file.read_exact(&mut magic).is_err() || magic != MAGIC {
        return Err("it is not a bag of ROS 1, version 2.0".into());
    }
    let head = read_record(&mut file)?.filter(|record| op(&record.header) == Some(BAG_HEADER));
    let head = head.ok_or("its first record is not a bag header")?;
    let chunks = file.stream_position().map_err(unreadable)?;
    let index = field(&head.header, "index_pos").and_then(|bytes| bytes.try_into().ok());
    let index = u64::from_le_bytes(index.ok_or("its header has no index_pos")?);
    if index < chunks {
        return Err("the recording was not closed; repair it with `rosbag reindex`".into());
    }
    file.seek(SeekFrom::Start(index)).map_err(unreadable)?;
    let mut topics = Vec::new();
    while let Some(record) = read_record(&mut file)? {
        if op(&record.header) == Some(CONNECTION) {
            topics.extend(picture_topic(&record));
        }
    }
    file.seek(SeekFrom::Start(chunks)).map_err(unreadable)?;
    Ok((file, topics))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record.
    fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
        let mut header = Vec::new();
        for (name, value) in fields {
            header.extend(((name.len() + 1 + value.len()) as u32).to_le_bytes());
            header.extend(name.as_bytes());
            header.push(b'=');
            header.extend(*value);
        }
        let mut record = (header.len() as u32).to_le_bytes().to_vec();
        record.extend(header);
        record.extend((data.len() as u32).to_le_bytes());
        record.extend(data);
        record
    }

    fn connection(number: u32, topic: &str, kind: &str) -> Vec<u8> {
        let entry = format!("type={kind}");
        let mut data = (entry.len() as u32).to_le_bytes().to_vec();
        data.extend(entry.as_bytes());
        let fields = [
            ("op", &[CONNECTION][..]),
            ("conn", &number.to_le_bytes()),
            ("topic", topic.as_bytes()),
        ];
        record(&fields, &data)
    }

    fn message(number: u32, seconds: u32, data: &[u8]) -> Vec<u8> {
        let mut time = seconds.to_le_bytes().to_vec();
        time.extend(500_000_000u32.to_le_bytes());
        let fields = [
            ("op", &[MESSAGE][..]),
            ("conn", &number.to_le_bytes()),
            ("time", &time),
        ];
        record(&fields, data)
    }

    /// `sensor_msgs/Image` with two pixels.
    fn image(encoding: &str, pixels: &[u8]) -> Vec<u8> {
        let mut data = vec![0; 16];
        for number in [1, 2, encoding.len() as u32] {
            data.extend(number.to_le_bytes());
        }
        data.extend(encoding.as_bytes());
        data.push(0);
        for number in [pixels.len() as u32; 2] {
            data.extend(number.to_le_bytes());
        }
        data.extend(pixels);
        data
    }

    const COLOUR: &str = "/device_0/sensor_1/Color_0/image/data";
    const DEPTH: &str = "/device_0/sensor_0/Depth_0/image/data";

    /// A bag like those of RealSense: depth and colour, one chunk per time.
    fn bag(compression: &str, is_closed: bool) -> Vec<u8> {
        let connections = [
            connection(0, DEPTH, "sensor_msgs/Image"),
            connection(1, COLOUR, "sensor_msgs/Image"),
            connection(2, "/imu", "sensor_msgs/Imu"),
        ];
        let mut chunks = Vec::new();
        for moment in 0..3u8 {
            let mut chunk = connections.concat();
            let seconds = 1_700_000_000 + u32::from(moment);
            chunk.extend(message(0, seconds, &image("mono16", &[9; 4])));
            chunk.extend(message(2, seconds, b"turning"));
            let pixels = [moment, 1, 2, 3, 4, 5];
            chunk.extend(message(1, seconds, &image("rgb8", &pixels)));
            let size = (chunk.len() as u32).to_le_bytes();
            if compression == "lz4" {
                // A frame with one stored block.
                let mut frame = vec![0x04, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82];
                frame.extend((chunk.len() as u32 | 1 << 31).to_le_bytes());
                frame.extend(chunk);
                frame.extend([0; 4]);
                chunk = frame;
            }
            let fields = [
                ("op", &[CHUNK][..]),
                ("compression", compression.as_bytes()),
                ("size", &size),
            ];
            chunks.extend(record(&fields, &chunk));
            chunks.extend(record(&[("op", &[4])], b"an index"));
        }
        let head = |index: u64| {
            let fields = [
                ("op", &[BAG_HEADER][..]),
                ("index_pos", &index.to_le_bytes()),
            ];
            [MAGIC, &record(&fields, b"   ")].concat()
        };
        let index = if is_closed {
            (head(0).len() + chunks.len()) as u64
        } else {
            0
        };
        [head(index), chunks, connections.concat()].concat()
    }

    fn opened(bytes: &[u8], topic: Option<&str>) -> Result<Vec<BagPicture>, BagError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.bag");
        std::fs::write(&path, bytes).unwrap();
        Bag::open(&path, topic)?.collect()
    }

    #[test]
    fn pictures_in_colour_come_in_the_order_of_their_recording() {
        for compression in ["none", "lz4"] {
            let pictures = opened(&bag(compression, true), None).unwrap();
            let times: Vec<f64> = pictures.iter().map(|picture| picture.time).collect();
            assert_eq!(times, [0.0, 1.0, 2.0]);
            for (moment, picture) in (0..).zip(&pictures) {
                let CameraPicture::Pixels(pixels) = &picture.picture else {
                    panic!("it was recorded as pixels");
                };
                assert_eq!(pixels.as_raw()[..], [moment, 1, 2, 3, 4, 5]);
            }
        }
        assert_eq!(opened(&bag("none", true), Some(DEPTH)).unwrap().len(), 3);
    }

    #[test]
    fn faults_name_the_file_and_what_is_allowed() {
        let fault = |bytes: &[u8], topic| opened(bytes, topic).unwrap_err().to_string();
        let whole = bag("none", true);
        let error = fault(&whole, Some("/camera"));
        assert!(
            error.contains("scene.bag") && error.contains(COLOUR),
            "{error}"
        );
        assert!(fault(&bag("none", false), None).contains("rosbag reindex"));
        assert!(fault(&bag("bz2", true), None).contains("rosbag decompress"));
        assert!(fault(b"SQLite format 3\0", None).contains("not a bag of ROS 1"));
        // One bag is truncated in the connections at its end, another one in a chunk.
        let cut = fault(&whole[..whole.len() - 3], None);
        assert!(cut.contains("truncated"), "{cut}");
    }

    #[test]
    fn damage_is_refused_or_read_but_never_panics() {
        let whole = bag("lz4", true);
        let mut seed = 7u64;
        for _ in 0..2000 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1);
                let place = (seed >> 33) as usize % bytes.len();
                bytes[place] = (seed >> 25) as u8;
            }
            // The result may be a picture or a fault.
            let _ = opened(&bytes, None);
        }
    }
}
