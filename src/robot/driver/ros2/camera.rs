//! Pictures of a camera of ROS 2.

use super::super::DriverError;
use super::super::picture::{
    CameraPicture, LARGEST_PICTURE, PictureTopic, RawImage, pixels, sends_files,
};
use super::Ros2Topic;
use super::action::participant;
use super::message::{CompressedImage, Image};
use super::service::{Reader, best_effort, reliable, subscribe};
use rustdds::DomainParticipant;
use serde::de::DeserializeOwned;
use std::time::{Duration, Instant};

/// Polling interval for pictures.
const INTERVAL: Duration = Duration::from_millis(5);

/// A topic of pictures.
pub struct Ros2Camera {
    address: Ros2Topic,
    readers: Readers,
    _participant: DomainParticipant,
}

/// Readers of a topic: a reliable one, and one for best-effort publishers.
enum Readers {
    Pixels([Reader<Image>; 2]),
    Files([Reader<CompressedImage>; 2]),
}

impl Ros2Camera {
    /// Subscribes to a topic.
    ///
    /// # Errors
    /// A message: there is no such network, or no free participant index.
    pub fn open(address: &Ros2Topic) -> Result<Self, String> {
        let participant = participant(address.domain, address.interface)?;
        let topic = format!("rt/{}", address.topic.trim_matches('/'));
        let readers = if sends_files(&address.topic) {
            Readers::Files(both(&participant, &topic, "CompressedImage_")?)
        } else {
            Readers::Pixels(both(&participant, &topic, "Image_")?)
        };
        Ok(Self {
            address: address.clone(),
            readers,
            _participant: participant,
        })
    }

    /// The newest picture received.
    fn newest(&mut self) -> Result<Option<CameraPicture>, String> {
        match &mut self.readers {
            Readers::Pixels(readers) => {
                let Some(image) = newest(readers)? else {
                    return Ok(None);
                };
                let raw = RawImage {
                    size: [image.width, image.height],
                    encoding: image.encoding,
                    is_big_endian: image.is_bigendian != 0,
                    step: image.step as usize,
                    data: bounded(&image.data)?,
                };
                pixels(&raw).map(|pixels| Some(CameraPicture::Pixels(pixels)))
            }
            Readers::Files(readers) => {
                let Some(image) = newest(readers)? else {
                    return Ok(None);
                };
                bounded(&image.data)?;
                Ok(Some(CameraPicture::File(image.data)))
            }
        }
    }
}

fn both<T>(
    participant: &DomainParticipant,
    topic: &str,
    kind: &str,
) -> Result<[Reader<T>; 2], String> {
    let kind = format!("sensor_msgs::msg::dds_::{kind}");
    Ok([
        subscribe(participant, topic, &kind, &reliable())?,
        subscribe(participant, topic, &kind, &best_effort())?,
    ])
}

fn newest<T: DeserializeOwned>(readers: &mut [Reader<T>; 2]) -> Result<Option<T>, String> {
    let mut newest = None;
    for reader in readers {
        while let Some(message) = reader.next()? {
            newest = Some(message);
        }
    }
    Ok(newest)
}

fn bounded(data: &[u8]) -> Result<&[u8], String> {
    if data.len() > LARGEST_PICTURE {
        return Err(format!(
            "a picture of {} bytes; allowed: at most {LARGEST_PICTURE}",
            data.len()
        ));
    }
    Ok(data)
}

impl PictureTopic for Ros2Camera {
    fn picture(&mut self, patience: Duration) -> Result<CameraPicture, DriverError> {
        let begin = Instant::now();
        let topic = self.address.topic.clone();
        loop {
            let newest = self.newest();
            let newest =
                newest.map_err(|reason| DriverError::Aborted(format!("{topic}: {reason}")))?;
            if let Some(picture) = newest {
                return Ok(picture);
            }
            if begin.elapsed() > patience {
                return Err(DriverError::Lost(format!(
                    "ROS 2, domain {}: no picture on {topic} in {} s; is the camera started, is \
                     this its topic, and is {} its ROS_DOMAIN_ID?",
                    self.address.domain,
                    patience.as_secs_f64(),
                    self.address.domain
                )));
            }
            std::thread::sleep(INTERVAL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::message::Header;
    use super::super::service::{Encoded, publish};
    use super::*;
    use std::net::{IpAddr, Ipv4Addr};
    use std::sync::atomic::{AtomicBool, Ordering};

    const LOOPBACK: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

    fn address(topic: &str) -> Ros2Topic {
        let process = std::process::id();
        Ros2Topic {
            domain: (process % 100 + 1) as u16,
            interface: Some(LOOPBACK),
            topic: format!("/camera_{process}/{topic}"),
        }
    }

    /// Publishes a message repeatedly while `during` runs.
    fn published<R>(
        address: &Ros2Topic,
        kind: &str,
        message: &impl serde::Serialize,
        during: impl FnOnce() -> R,
    ) -> R {
        let participant = participant(address.domain, Some(LOOPBACK)).unwrap();
        let topic = format!("rt/{}", address.topic.trim_matches('/'));
        let kind = format!("sensor_msgs::msg::dds_::{kind}");
        let message = Encoded::of(message).unwrap();
        let writer = publish(&participant, &topic, &kind).unwrap();
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    // There may be no subscriber yet.
                    let _ = writer.write(message.clone(), None);
                    std::thread::sleep(Duration::from_millis(50));
                }
            });
            let result = during();
            is_over.store(true, Ordering::Relaxed);
            result
        })
    }

    const PATIENCE: Duration = Duration::from_secs(15);

    #[test]
    fn pixels_and_files_come_through() {
        // The picture is larger than a datagram.
        let (width, height) = (320, 240);
        let data: Vec<u8> = (0..3 * width * height).map(|k| (k % 251) as u8).collect();
        let image = Image {
            header: Header::default(),
            height,
            width,
            encoding: "rgb8".into(),
            is_bigendian: 0,
            step: 3 * width,
            data: data.clone(),
        };
        let place = address("image_raw");
        let found = published(&place, "Image_", &image, || {
            Ros2Camera::open(&place).unwrap().picture(PATIENCE)
        });
        let CameraPicture::Pixels(pixels) = found.unwrap() else {
            panic!("it sends pixels");
        };
        assert_eq!(pixels.dimensions(), (width, height));
        assert_eq!(pixels.as_raw()[..], data);

        let file = CompressedImage {
            header: Header::default(),
            format: "png".into(),
            data: vec![1, 2, 3],
        };
        let place = address("image_raw/compressed");
        let found = published(&place, "CompressedImage_", &file, || {
            Ros2Camera::open(&place).unwrap().picture(PATIENCE)
        });
        assert_eq!(found.unwrap(), CameraPicture::File(vec![1, 2, 3]));
    }

    #[test]
    fn a_topic_without_a_camera_is_named() {
        let place = address("absent");
        let error = Ros2Camera::open(&place)
            .unwrap()
            .picture(Duration::from_millis(100))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(&place.topic) && error.contains("ROS_DOMAIN_ID"),
            "{error}"
        );
    }
}
