//! A WebSocket to a rosbridge server.

use serde_json::Value;
use std::io::ErrorKind;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Longest time for a connection, and for sending a message.
const PATIENCE: Duration = Duration::from_secs(2);
/// Largest message of a server, bytes; states and results are far smaller.
pub(super) const LARGEST_MESSAGE: usize = 1 << 20;

/// Opens a WebSocket to the server at `host:port`, or `host:port/path` if the server requires a
/// path, for messages of at most `largest` bytes.
///
/// # Errors
/// A message about the failure.
pub(super) fn open_socket(address: &str, largest: usize) -> Result<WebSocket<TcpStream>, String> {
    let (server, path) = address.split_once('/').unwrap_or((address, ""));
    let resolved = server
        .to_socket_addrs()
        .map_err(|error| error.to_string())?;
    let mut stream = Err(std::io::Error::from(ErrorKind::AddrNotAvailable));
    for address in resolved {
        stream = TcpStream::connect_timeout(&address, PATIENCE);
        if stream.is_ok() {
            break;
        }
    }
    let stream =
        stream.map_err(|error| format!("no connection: {error}; is the server started?"))?;
    stream
        .set_nodelay(true)
        .and_then(|()| stream.set_read_timeout(Some(PATIENCE)))
        .map_err(|error| error.to_string())?;
    let url = format!("ws://{server}/{path}");
    let config = WebSocketConfig::default()
        .max_message_size(Some(largest))
        .max_frame_size(Some(largest));
    let (socket, _) = tungstenite::client::client_with_config(url, stream, Some(config))
        .map_err(|error| format!("no WebSocket: {error}"))?;
    Ok(socket)
}

/// Opens a non-blocking WebSocket.
///
/// # Errors
/// A message about the failure.
pub(super) fn open_quiet_socket(address: &str) -> Result<WebSocket<TcpStream>, String> {
    let socket = open_socket(address, LARGEST_MESSAGE)?;
    let quiet = socket.get_ref().set_nonblocking(true);
    quiet.map_err(|error| error.to_string())?;
    Ok(socket)
}

/// Sends a message on a socket, blocking or not.
///
/// # Errors
/// The message cannot be sent in time, or the connection is lost.
pub(super) fn send(
    socket: &mut WebSocket<TcpStream>,
    value: &Value,
) -> Result<(), tungstenite::Error> {
    let mut result = socket.send(Message::text(value.to_string()));
    let begin = Instant::now();
    // A long goal may fill the socket's buffer; the rest follows as the server reads.
    while let Err(tungstenite::Error::Io(error)) = &result {
        if error.kind() != ErrorKind::WouldBlock || begin.elapsed() > PATIENCE {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
        result = socket.flush();
    }
    result
}

/// Reads the next message; `Null` if it is not JSON, `None` if no message has arrived.
///
/// # Errors
/// The connection is closed ([`tungstenite::Error::ConnectionClosed`]) or lost.
pub(super) fn read(socket: &mut WebSocket<TcpStream>) -> Result<Option<Value>, tungstenite::Error> {
    match socket.read() {
        Ok(Message::Text(text)) => Ok(Some(serde_json::from_str(&text).unwrap_or_default())),
        Ok(Message::Close(_)) => Err(tungstenite::Error::ConnectionClosed),
        Ok(_) => Ok(Some(Value::Null)),
        Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
    }
}

/// Describes how a connection ended.
pub(super) fn end_in_words(error: &tungstenite::Error) -> String {
    match error {
        tungstenite::Error::ConnectionClosed => "the server closed the connection".to_owned(),
        error => format!("the connection is lost: {error}"),
    }
}

/// The error that a server reports in a message, if there is one.
pub(super) fn complaint(message: &Value) -> Option<&str> {
    let is_error = message["op"] == "status" && message["level"] == "error";
    is_error.then(|| {
        message["msg"]
            .as_str()
            .unwrap_or("an error without a message")
    })
}
