//! Selection of the picture topic of a bag.

use super::bag_record::{Record, field, u32_of};
use super::message::{COMPRESSED_IMAGE, IMAGE};

/// A topic of pictures.
pub struct Topic {
    /// Number of its connection.
    pub connection: u32,
    /// Name, such as `/camera/image_raw`.
    pub name: String,
    /// Whether the topic sends files.
    pub is_compressed: bool,
}

/// The topic of a connection record, if it carries pictures.
pub fn picture_topic(record: &Record) -> Option<Topic> {
    let kind = field(&record.data, "type")?;
    let is_compressed = kind == COMPRESSED_IMAGE.name.as_bytes();
    if !is_compressed && kind != IMAGE.name.as_bytes() {
        return None;
    }
    let name = field(&record.header, "topic")?;
    Some(Topic {
        connection: field(&record.header, "conn").and_then(u32_of)?,
        name: String::from_utf8_lossy(name).into_owned(),
        is_compressed,
    })
}

/// Connections of the selected topic: the named one, the only one, or the only one in colour.
///
/// # Errors
/// A message if there is no such topic, or several.
pub fn chosen(topics: Vec<Topic>, wanted: Option<&str>) -> Result<Vec<(u32, bool)>, String> {
    let mut names: Vec<&str> = topics.iter().map(|topic| topic.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let known = names.join(", ");
    if names.is_empty() {
        return Err(
            "it has no topic of type sensor_msgs/Image or sensor_msgs/CompressedImage".into(),
        );
    }
    let in_colour: Vec<&str> = names
        .iter()
        .copied()
        .filter(|name| name.to_ascii_lowercase().contains("color"))
        .collect();
    let name = match (wanted, &names[..], &in_colour[..]) {
        (Some(wanted), names, _) if names.contains(&wanted) => wanted,
        (Some(wanted), ..) => {
            return Err(format!(
                "it has no pictures on topic {wanted}; it has {known}"
            ));
        }
        (None, [only], _) | (None, _, [only]) => *only,
        _ => {
            return Err(format!(
                "it has several topics of pictures; choose one of: {known}"
            ));
        }
    };
    let chosen = topics.iter().filter(|topic| topic.name == name);
    Ok(chosen
        .map(|topic| (topic.connection, topic.is_compressed))
        .collect())
}
