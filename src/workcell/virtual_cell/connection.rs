//! One client of a virtual cell: a non-blocking WebSocket with limits on all input and output.

use super::pace::Pace;
use super::subscription::{Subscription, Wish};
use super::topics::CLOCK;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::handshake::HandshakeError;
use tungstenite::handshake::server::{
    Callback, ErrorResponse, Request as Handshake, Response, ServerHandshake,
};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Largest message of a client, bytes: enough for a long trajectory of many joints.
const LARGEST_MESSAGE: usize = 32 << 20;
/// Largest number of bytes that wait for a client that reads slowly: a picture and a few seconds
/// of reports.
const MOST_WAITING: usize = 32 << 20;
/// Longest time for the handshake of a client.
const HANDSHAKE: Duration = Duration::from_secs(2);
/// Largest number of messages of any kind that are read from a client at a time.
const AT_A_TIME: usize = 32;
/// Number of bytes after which no more messages are read at a time.
const BYTES_AT_A_TIME: usize = 1 << 20;
/// Time after which a silent client without subscriptions may lose its place to another client.
const IDLE: Duration = Duration::from_secs(1);
/// Largest number of subscriptions of a client.
const MOST_TOPICS: usize = 64;

/// Accepts only clients that send the token as the path of the server.
#[derive(Clone)]
struct Doorkeeper {
    token: Option<String>,
}

impl Callback for Doorkeeper {
    fn on_request(
        self,
        request: &Handshake,
        response: Response,
    ) -> Result<Response, ErrorResponse> {
        let path = request.uri().path().trim_start_matches('/');
        let is_known = self.token.as_ref().is_none_or(|token| {
            // The comparison takes the same time for an almost correct token as for any other of
            // that length.
            let pairs = token.bytes().zip(path.bytes());
            let differences = pairs.fold(0, |sum, (one, other)| sum | (one ^ other));
            token.len() == path.len() && differences == 0
        });
        if is_known {
            return Ok(response);
        }
        let mut refusal = ErrorResponse::new(Some("the token is wrong".into()));
        *refusal.status_mut() = StatusCode::UNAUTHORIZED;
        Err(refusal)
    }
}

enum Link {
    Opening(Box<tungstenite::handshake::MidHandshake<ServerHandshake<TcpStream, Doorkeeper>>>),
    Open(Box<WebSocket<TcpStream>>),
    Closed,
}

/// A client.
pub struct Connection {
    /// Number of the client.
    pub id: u64,
    link: Link,
    since: Instant,
    /// Time of the client's last message.
    heard: Instant,
    topics: BTreeMap<String, Subscription>,
    /// Progress of a client that has subscribed to the clock.
    pace: Option<Pace>,
    /// Whether some of the last message still waits to be sent.
    is_full: bool,
}

impl Connection {
    /// Accepts a client that has connected. If the server has a token, the client must present it.
    /// `None` if the client has already disconnected.
    pub fn accept(id: u64, stream: TcpStream, token: Option<&str>) -> Option<Self> {
        let prepared = stream.set_nonblocking(true).and(stream.set_nodelay(true));
        prepared.ok()?;
        let config = WebSocketConfig::default()
            .max_message_size(Some(LARGEST_MESSAGE))
            .max_frame_size(Some(LARGEST_MESSAGE))
            .max_write_buffer_size(MOST_WAITING);
        let doorkeeper = Doorkeeper {
            token: token.map(str::to_owned),
        };
        let begun = tungstenite::accept_hdr_with_config(stream, doorkeeper, Some(config));
        let mut connection = Self {
            id,
            link: Link::Closed,
            since: Instant::now(),
            heard: Instant::now(),
            topics: BTreeMap::new(),
            pace: None,
            is_full: false,
        };
        connection.shake(begun);
        (!connection.is_closed()).then_some(connection)
    }

    fn shake(
        &mut self,
        result: Result<
            WebSocket<TcpStream>,
            HandshakeError<ServerHandshake<TcpStream, Doorkeeper>>,
        >,
    ) {
        self.link = match result {
            Ok(socket) => Link::Open(Box::new(socket)),
            Err(HandshakeError::Interrupted(begun)) if self.since.elapsed() < HANDSHAKE => {
                Link::Opening(Box::new(begun))
            }
            Err(_) => Link::Closed,
        };
    }

    /// Whether the client has disconnected.
    pub fn is_closed(&self) -> bool {
        matches!(self.link, Link::Closed)
    }

    /// Idle time of the client, if its place may be given to another client: its handshake is
    /// incomplete, or it is silent and has no subscriptions.
    pub fn idle(&self) -> Option<Duration> {
        match self.link {
            Link::Opening(_) => Some(self.since.elapsed()),
            Link::Open(_) if self.topics.is_empty() => {
                Some(self.heard.elapsed()).filter(|silence| *silence > IDLE)
            }
            _ => None,
        }
    }

    /// Cuts it.
    pub fn cut(&mut self) {
        self.link = Link::Closed;
    }

    /// Messages since the last call.
    pub fn receive(&mut self) -> Vec<String> {
        let mut texts = Vec::new();
        if let Link::Opening(_) = self.link {
            if let Link::Opening(begun) = std::mem::replace(&mut self.link, Link::Closed) {
                self.shake(begun.handshake());
            }
            return texts;
        }
        let Link::Open(socket) = &mut self.link else {
            return texts;
        };
        let (mut is_open, mut count, mut bytes) = (true, 0, 0);
        // Pings and binary messages count, too: a flood of them must not block other clients.
        while is_open && count < AT_A_TIME && bytes < BYTES_AT_A_TIME {
            let read = socket.read();
            count += 1;
            if let Ok(message) = &read {
                bytes += message.len();
                self.heard = Instant::now();
            }
            match read {
                Ok(Message::Text(text)) => texts.push(text.as_str().to_owned()),
                Ok(Message::Close(_)) => is_open = false,
                Ok(Message::Pong(payload)) => {
                    self.pace.iter_mut().for_each(|pace| pace.pong(&payload));
                }
                Ok(_) => {}
                Err(error) if would_block(&error) => break,
                Err(_) => is_open = false,
            }
        }
        if !is_open {
            self.cut();
        }
        texts
    }

    /// Sends a message. Bytes that the client does not read at once are queued; a client with too
    /// many queued bytes is disconnected.
    pub fn send(&mut self, text: &str) {
        let Link::Open(socket) = &mut self.link else {
            return;
        };
        let sent = socket.send(Message::text(text.to_owned()));
        self.settle(sent);
    }

    /// Sends a message of a topic if the client has subscribed to it, now or after the time
    /// between messages of its subscription.
    pub fn publish(&mut self, topic: &str, text: &str) {
        let subscription = self.topics.get_mut(topic);
        if let Some(text) = subscription.and_then(|known| known.take(text)) {
            self.send(&text);
        }
    }

    /// Asks a client that has subscribed to the clock to answer when it has read all messages up
    /// to `now`, s of the cell's clock.
    pub fn ping(&mut self, now: f64) {
        if !self.topics.contains_key(CLOCK) {
            self.pace = None;
            return;
        }
        let pace = self.pace.get_or_insert_with(|| Pace::new(now));
        if let Some(payload) = pace.ping(now)
            && let Link::Open(socket) = &mut self.link
        {
            let sent = socket.send(Message::Ping(payload.to_vec().into()));
            self.settle(sent);
        }
    }

    /// The last time of the cell's clock, s, that the client has seen, if the clock waits for the
    /// client, at most for `patience`.
    pub fn seen(&self, patience: Duration) -> Option<f64> {
        self.pace.as_ref()?.seen(patience)
    }

    /// Sends the waiting bytes.
    pub fn flush(&mut self) {
        let due: Vec<String> = self
            .topics
            .values_mut()
            .filter_map(Subscription::next)
            .collect();
        due.iter().for_each(|text| self.send(text));
        if let Link::Open(socket) = &mut self.link
            && self.is_full
        {
            let flushed = socket.flush();
            self.settle(flushed);
        }
    }

    fn settle(&mut self, sent: Result<(), tungstenite::Error>) {
        match sent {
            Ok(()) => self.is_full = false,
            Err(error) if would_block(&error) => self.is_full = true,
            Err(_) => self.cut(),
        }
    }

    /// Whether bytes still wait to be sent.
    pub fn is_full(&self) -> bool {
        self.is_full
    }

    /// Subscribes the client to a topic.
    ///
    /// # Errors
    /// There are too many subscriptions.
    pub fn subscribe(&mut self, topic: String, wish: Wish) -> Result<(), String> {
        let count: usize = self.topics.values().map(Subscription::count).sum();
        if count >= MOST_TOPICS {
            return Err(format!("at most {MOST_TOPICS} subscriptions are allowed"));
        }
        self.topics.entry(topic).or_default().add(wish);
        Ok(())
    }

    /// Ends the subscription with an id, or all subscriptions to the topic.
    pub fn unsubscribe(&mut self, topic: &str, id: Option<&str>) {
        if let Some(subscription) = self.topics.get_mut(topic)
            && !subscription.remove(id)
        {
            self.topics.remove(topic);
        }
    }

    /// Whether the client has subscribed to a topic and a message may be sent now.
    pub fn awaits(&self, topic: &str) -> bool {
        self.topics.get(topic).is_some_and(Subscription::is_due)
    }
}

/// Whether an error means that reading or writing would block.
fn would_block(error: &tungstenite::Error) -> bool {
    matches!(error, tungstenite::Error::Io(error) if error.kind() == ErrorKind::WouldBlock)
}
