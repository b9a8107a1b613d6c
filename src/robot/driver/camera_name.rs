//! Cameras by their names: `ros1://host:port/topic`, `rosbridge://host:port/topic`, `ros2://domain/topic`.

use super::{
    DriverError, PictureTopic, Ros1Camera, Ros2Address, Ros2CameraAddress, RosbridgeCamera,
};

/// Highest domain with valid DDS ports.
const LAST_DOMAIN: u16 = 232;

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
    let (scheme, place) = name.split_once("://")?;
    Some(match opened(scheme, place) {
        Ok(camera) => camera.map_err(CameraError::from),
        Err(shape) => Err(CameraError::Name(format!("{name}: {shape}"))),
    })
}

/// Opens a camera; otherwise returns the expected form of its name.
fn opened(
    scheme: &str,
    place: &str,
) -> Result<Result<Box<dyn PictureTopic>, DriverError>, &'static str> {
    const ROS_1: &str =
        "expected ros1://host:port/topic, such as ros1://192.168.1.5:11311/camera/image_raw";
    const ROSBRIDGE: &str = "expected rosbridge://host:port/topic, such as rosbridge://192.168.1.5:9090/camera/image_raw";
    const ROS_2: &str = "expected ros2://domain/topic, such as ros2://0/camera/image_raw, where \
                         domain is the camera's ROS_DOMAIN_ID; or ros2://domain@address/topic with \
                         the address of this machine on the camera's network";
    let (server, topic) = match place.split_once('/') {
        Some((server, topic)) if !topic.is_empty() => (server, format!("/{topic}")),
        _ => (place, String::new()),
    };
    let is_whole = server.contains(':') && !topic.is_empty();
    match scheme {
        "ros1" if is_whole => {
            let camera = Ros1Camera::open(&format!("http://{server}"), &topic);
            Ok(camera.map(boxed))
        }
        "rosbridge" if is_whole => {
            let camera = RosbridgeCamera::open(server, &topic);
            Ok(camera.map(boxed))
        }
        "ros2" => {
            let (domain, interface) = match server.split_once('@') {
                Some((domain, address)) => (domain, Some(address.parse().map_err(|_| ROS_2)?)),
                None => (server, None),
            };
            let domain = domain.parse().ok().filter(|domain| *domain <= LAST_DOMAIN);
            if !Ros2Address::IS_BUILT {
                return Err("this program was built without cameras of ROS 2 (cargo feature ros2)");
            }
            let address = Ros2CameraAddress {
                domain: domain.filter(|_| !topic.is_empty()).ok_or(ROS_2)?,
                interface,
                topic,
            };
            Ok(address.open())
        }
        "ros1" => Err(ROS_1),
        "rosbridge" => Err(ROSBRIDGE),
        _ => Err("expected a camera name that starts with ros1://, rosbridge:// or ros2://"),
    }
}

fn boxed<T: PictureTopic + 'static>(camera: T) -> Box<dyn PictureTopic> {
    Box::new(camera)
}
