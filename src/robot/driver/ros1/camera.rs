//! Pictures of a camera of ROS 1.

use super::super::DriverError;
use super::super::picture::{CameraPicture, PictureTopic, pixels, sends_files};
use super::message::{COMPRESSED_IMAGE, IMAGE, compressed_image, raw_image};
use super::node::{Heard, Node, lock, master_uri, subscriber};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// A topic of pictures.
pub struct Ros1Camera {
    master: String,
    topic: String,
    is_compressed: bool,
    newest: Arc<Newest>,
    _node: Node,
}

/// The newest message; older ones are dropped, since pictures are large.
#[derive(Default)]
struct Newest {
    message: Mutex<Option<Heard>>,
    came: Condvar,
}

impl Newest {
    fn keep(&self, heard: &Receiver<Heard>) {
        for message in heard {
            *lock(&self.message) = Some(message);
            self.came.notify_one();
        }
    }

    fn take(&self, patience: Duration) -> Option<Heard> {
        let waited = self
            .came
            .wait_timeout_while(lock(&self.message), patience, |message| message.is_none());
        let (mut message, _) = waited.unwrap_or_else(PoisonError::into_inner);
        message.take()
    }
}

impl Ros1Camera {
    /// Subscribes to a topic at a master such as `http://10.0.0.1:11311`.
    ///
    /// # Errors
    /// The master does not answer.
    pub fn open(master: &str, topic: &str) -> Result<Self, DriverError> {
        let master = master_uri(master);
        let is_compressed = sends_files(topic);
        let kind = if is_compressed {
            COMPRESSED_IMAGE
        } else {
            IMAGE
        };
        let (node, _, heard) = subscriber(&master, "picture", topic, kind)?;
        let newest = Arc::new(Newest::default());
        let keeper = Arc::clone(&newest);
        std::thread::spawn(move || keeper.keep(&heard));
        Ok(Self {
            master,
            topic: topic.to_owned(),
            is_compressed,
            newest,
            _node: node,
        })
    }
}

impl PictureTopic for Ros1Camera {
    fn picture(&mut self, patience: Duration) -> Result<CameraPicture, DriverError> {
        let newest = self.newest.take(patience).ok_or_else(|| {
            DriverError::Lost(format!(
                "ROS master {}: no picture on {} in {} s; is the camera started, and is this its topic?",
                self.master,
                self.topic,
                patience.as_secs_f64()
            ))
        })?;
        let picture = match &newest {
            Heard::Message(_, bytes) if self.is_compressed => compressed_image(bytes)
                .map(|file| CameraPicture::File(file.to_vec()))
                .ok_or_else(|| "the picture is damaged".to_owned()),
            Heard::Message(_, bytes) => raw_image(bytes)
                .ok_or_else(|| "the picture is damaged".to_owned())
                .and_then(|raw| pixels(&raw).map(CameraPicture::Pixels)),
            Heard::MasterIsGone => Err("the master does not answer".to_owned()),
        };
        picture.map_err(|reason| DriverError::Aborted(format!("{}: {reason}", self.topic)))
    }
}
