//! Cameras by the names of their topics.

use super::{DriverError, PictureTopic, Ros1Camera, RosbridgeCamera, TopicName};

/// Topic in messages about names.
const EXAMPLE: &str = "camera/image_raw";

/// Reason why a camera cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CameraError {
    /// The name is not valid.
    #[error("{0}")]
    Name(String),
    /// The camera does not answer.
    #[error(transparent)]
    Driver(#[from] DriverError),
}

/// Opens the camera with a name; `None` if the text is not the name of a camera. The text may then
/// be the name of a file.
pub fn open_camera(name: &str) -> Option<Result<Box<dyn PictureTopic>, CameraError>> {
    let name = TopicName::parse(name, EXAMPLE)?;
    Some(match name {
        Ok(name) => opened(name).map_err(CameraError::from),
        Err(message) => Err(CameraError::Name(message)),
    })
}

fn opened(name: TopicName) -> Result<Box<dyn PictureTopic>, DriverError> {
    Ok(match name {
        TopicName::Ros1 { master, topic } => Box::new(Ros1Camera::open(&master, &topic)?),
        TopicName::Rosbridge { server, topic } => Box::new(RosbridgeCamera::open(&server, &topic)?),
        TopicName::Ros2(address) => address.open_camera()?,
    })
}
