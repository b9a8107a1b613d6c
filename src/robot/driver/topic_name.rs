//! Topics by their names: `ros1://host:port/topic`, `rosbridge://host:port/topic`,
//! `ros2://domain/topic`.

use super::{Ros2Address, Ros2Topic};

/// Highest domain with valid DDS ports.
const LAST_DOMAIN: u16 = 232;

/// The place of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TopicName {
    /// At a master of ROS 1.
    Ros1 {
        /// Such as `http://10.0.0.1:11311`.
        master: String,
        /// The topic, with its first slash.
        topic: String,
    },
    /// Behind a rosbridge server.
    Rosbridge {
        /// `host:port`.
        server: String,
        /// The topic, with its first slash.
        topic: String,
    },
    /// In a domain of ROS 2.
    Ros2(Ros2Topic),
}

impl TopicName {
    /// The topic with a name; `None` if the text has no scheme, and may be the name of a file.
    /// `example` is a topic for the messages.
    ///
    /// # Errors
    /// A message with the expected form.
    pub fn parse(name: &str, example: &str) -> Option<Result<Self, String>> {
        let (scheme, place) = name.split_once("://")?;
        Some(parsed(scheme, place, example).map_err(|shape| format!("{name}: {shape}")))
    }

    /// The topic, with its first slash.
    pub fn topic(&self) -> &str {
        match self {
            Self::Ros1 { topic, .. } | Self::Rosbridge { topic, .. } => topic,
            Self::Ros2(address) => &address.topic,
        }
    }
}

fn parsed(scheme: &str, place: &str, example: &str) -> Result<TopicName, String> {
    let (server, topic) = match place.split_once('/') {
        Some((server, topic)) if !topic.is_empty() => (server, format!("/{topic}")),
        _ => (place, String::new()),
    };
    let is_whole = server.contains(':') && !topic.is_empty();
    match scheme {
        "ros1" if is_whole => Ok(TopicName::Ros1 {
            master: format!("http://{server}"),
            topic,
        }),
        "rosbridge" if is_whole => Ok(TopicName::Rosbridge {
            server: server.to_owned(),
            topic,
        }),
        "ros2" => {
            let expected = || {
                format!(
                    "expected ros2://domain/topic, such as ros2://0/{example}, where domain is \
                     its ROS_DOMAIN_ID; or ros2://domain@address/topic with the address of this \
                     machine on its network"
                )
            };
            let (domain, interface) = match server.split_once('@') {
                Some((domain, address)) => (domain, Some(address.parse().map_err(|_| expected())?)),
                None => (server, None),
            };
            if !Ros2Address::IS_BUILT {
                return Err("this program was built without ROS 2 (cargo feature ros2)".into());
            }
            let domain = domain.parse().ok().filter(|domain| *domain <= LAST_DOMAIN);
            Ok(TopicName::Ros2(Ros2Topic {
                domain: domain.filter(|_| !topic.is_empty()).ok_or_else(expected)?,
                interface,
                topic,
            }))
        }
        "ros1" => Err(format!(
            "expected ros1://host:port/topic, such as ros1://192.168.1.5:11311/{example}"
        )),
        "rosbridge" => Err(format!(
            "expected rosbridge://host:port/topic, such as rosbridge://192.168.1.5:9090/{example}"
        )),
        _ => Err("expected a name that starts with ros1://, rosbridge:// or ros2://".into()),
    }
}
