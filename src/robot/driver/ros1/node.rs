//! A node of ROS 1: topics in and out over TCPROS, and the XML-RPC interface for discovery.

use super::super::DriverError;
use super::message::MessageType;
use super::xmlrpc::{self, Value, answer, authority, call, read_call};
use crate::unix_time::unix_time;
use std::collections::BTreeSet;
use std::io::{self, Read, Write};
use std::net::{IpAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Size of the queue of messages. Faster publishers are blocked by their full connections.
const MOST_WAITING: usize = 64;
/// Maximum number of connections to a node, and of publishers from which it reads a topic.
const MOST_CONNECTIONS: usize = 64;
const MOST_PUBLISHERS: usize = 16;
/// Time between checks of the master.
const MASTER_INTERVAL: Duration = Duration::from_millis(150);
/// Longest time for a connection to a publisher, and for sending a message to a subscriber.
const PATIENCE: Duration = Duration::from_secs(2);

/// An event of a subscription.
pub enum Heard {
    /// A message of a topic.
    Message(&'static str, Vec<u8>),
    /// The master no longer answers.
    MasterIsGone,
}

/// A node. The threads of a node end when it is dropped.
pub struct Node {
    inner: Arc<Inner>,
}

struct Inner {
    name: String,
    master: String,
    uri: String,
    host: IpAddr,
    topics_port: u16,
    closed: AtomicBool,
    subscriptions: Mutex<Vec<Arc<Subscription>>>,
    publications: Mutex<Vec<Arc<Publication>>>,
}

struct Subscription {
    /// Label for the receiver.
    label: &'static str,
    topic: String,
    kind: MessageType,
    sender: SyncSender<Heard>,
    publishers: Mutex<BTreeSet<String>>,
}

/// A topic that this node publishes.
pub struct Publication {
    topic: String,
    kind: MessageType,
    subscribers: Mutex<Vec<TcpStream>>,
}

/// The two ends of a bounded queue of messages.
pub fn mailbox() -> (SyncSender<Heard>, Receiver<Heard>) {
    sync_channel(MOST_WAITING)
}

/// The content of a lock, even if it was poisoned.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A node at a master that subscribes to one topic, and both ends of the queue of its messages.
///
/// # Errors
/// The master does not answer.
pub fn subscriber(
    master: &str,
    label: &'static str,
    topic: &str,
    kind: MessageType,
) -> Result<(Node, SyncSender<Heard>, Receiver<Heard>), DriverError> {
    let lost = |error| without_master(master, &error);
    let (sender, heard) = mailbox();
    let node = Node::start(master).map_err(lost)?;
    node.subscribe(label, topic, kind, &sender).map_err(lost)?;
    Ok((node, sender, heard))
}

/// A node at a master that publishes one topic.
///
/// # Errors
/// The master does not answer.
pub fn publisher(
    master: &str,
    topic: &str,
    kind: MessageType,
) -> Result<(Node, Arc<Publication>), DriverError> {
    let lost = |error| without_master(master, &error);
    let node = Node::start(master).map_err(lost)?;
    let publication = node.advertise(topic, kind).map_err(lost)?;
    Ok((node, publication))
}

fn without_master(master: &str, error: &io::Error) -> DriverError {
    DriverError::Lost(format!(
        "ROS master {master}: {error}; is it started, and is this its address?"
    ))
}

/// The address of a master with a trailing slash.
pub fn master_uri(master: &str) -> String {
    format!("{}/", master.trim_end_matches('/'))
}

impl Node {
    /// Starts a node with a unique name at a master, such as `http://10.0.0.1:11311/`.
    ///
    /// # Errors
    /// The master does not answer, or no port can be opened.
    pub fn start(master: &str) -> io::Result<Self> {
        let unique = unix_time().as_micros();
        let name = format!("/rodlab_{}_{unique}", std::process::id());
        call(master, "getPid", &[Value::text(&name)])?;
        // The master can reach the local address of the connection to it.
        let authority = authority(master).unwrap_or_default();
        let host = TcpStream::connect(authority)?.local_addr()?.ip();
        let (calls, topics) = (TcpListener::bind((host, 0))?, TcpListener::bind((host, 0))?);
        let inner = Arc::new(Inner {
            name,
            master: master.to_owned(),
            uri: format!("http://{}/", calls.local_addr()?),
            host,
            topics_port: topics.local_addr()?.port(),
            closed: AtomicBool::new(false),
            subscriptions: Mutex::default(),
            publications: Mutex::default(),
        });
        accept(calls, Arc::clone(&inner), |inner, stream| {
            // Invalid calls are ignored.
            let _ = inner.serve(&stream);
        });
        accept(topics, Arc::clone(&inner), |inner, stream| {
            let _ = inner.welcome(stream);
        });
        Ok(Self { inner })
    }

    /// Subscribes to a topic; its messages go to `sender` with `label`.
    ///
    /// # Errors
    /// The master rejects the subscription.
    pub fn subscribe(
        &self,
        label: &'static str,
        topic: &str,
        kind: MessageType,
        sender: &SyncSender<Heard>,
    ) -> io::Result<()> {
        let subscription = Arc::new(Subscription {
            label,
            topic: topic.to_owned(),
            kind,
            sender: sender.clone(),
            publishers: Mutex::default(),
        });
        lock(&self.inner.subscriptions).push(Arc::clone(&subscription));
        let publishers = self.inner.register("registerSubscriber", topic, kind)?;
        connect_all(&self.inner, &subscription, &publishers);
        Ok(())
    }

    /// Advertises a topic.
    ///
    /// # Errors
    /// The master rejects the topic.
    pub fn advertise(&self, topic: &str, kind: MessageType) -> io::Result<Arc<Publication>> {
        let publication = Arc::new(Publication {
            topic: topic.to_owned(),
            kind,
            subscribers: Mutex::default(),
        });
        lock(&self.inner.publications).push(Arc::clone(&publication));
        self.inner.register("registerPublisher", topic, kind)?;
        Ok(publication)
    }

    /// Checks the master periodically, and reports when it no longer answers.
    pub fn watch_master(&self, sender: &SyncSender<Heard>) {
        let (inner, sender) = (Arc::clone(&self.inner), sender.clone());
        std::thread::spawn(move || {
            while !inner.closed.load(Ordering::Relaxed) {
                if call(&inner.master, "getPid", &[Value::text(&inner.name)]).is_err() {
                    // Sending fails only if the receiver is closed.
                    let _ = sender.send(Heard::MasterIsGone);
                    return;
                }
                std::thread::sleep(MASTER_INTERVAL);
            }
        });
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        self.inner.closed.store(true, Ordering::Relaxed);
        let topics = |method: &str, topic: &str| {
            let parameters = [&self.inner.name, topic, &self.inner.uri].map(Value::text);
            // The master may no longer exist.
            let _ = call(&self.inner.master, method, &parameters);
        };
        for subscription in lock(&self.inner.subscriptions).drain(..) {
            topics("unregisterSubscriber", &subscription.topic);
        }
        for publication in lock(&self.inner.publications).drain(..) {
            topics("unregisterPublisher", &publication.topic);
        }
        // Connects to the own ports, so that the listening threads wake up.
        let port = authority(&self.inner.uri).and_then(|at| at.rsplit_once(':')?.1.parse().ok());
        for port in [Some(self.inner.topics_port), port].into_iter().flatten() {
            let _ = TcpStream::connect((self.inner.host, port));
        }
    }
}

/// Runs a thread for every connection until the node is closed.
fn accept(listener: TcpListener, inner: Arc<Inner>, handle: fn(&Arc<Inner>, TcpStream)) {
    std::thread::spawn(move || {
        let open = Arc::new(AtomicUsize::new(0));
        for stream in listener.incoming() {
            if inner.closed.load(Ordering::Relaxed) {
                return;
            }
            let Ok(stream) = stream else { continue };
            if open.load(Ordering::Relaxed) >= MOST_CONNECTIONS {
                continue;
            }
            open.fetch_add(1, Ordering::Relaxed);
            let (inner, open) = (Arc::clone(&inner), Arc::clone(&open));
            std::thread::spawn(move || {
                handle(&inner, stream);
                open.fetch_sub(1, Ordering::Relaxed);
            });
        }
    });
}

impl Inner {
    fn register(&self, method: &str, topic: &str, kind: MessageType) -> io::Result<Vec<String>> {
        let parameters = [&self.name, topic, kind.name, &self.uri].map(Value::text);
        Ok(call(&self.master, method, &parameters)?.texts())
    }

    /// Answers a call from the master or another node.
    fn serve(self: &Arc<Self>, stream: &TcpStream) -> io::Result<()> {
        let call = read_call(stream)?;
        let text = |k: usize| call.parameters.get(k).and_then(Value::as_text);
        match (call.method.as_str(), text(1)) {
            ("requestTopic", Some(_)) => {
                let port = Value::Integer(i64::from(self.topics_port));
                let host = Value::Text(self.host.to_string());
                answer(
                    stream,
                    Value::Array(vec![Value::text("TCPROS"), host, port]),
                )
            }
            ("publisherUpdate", Some(topic)) => {
                let publishers = call.parameters.get(2).map(Value::texts);
                let publishers = publishers.unwrap_or_default();
                let ours: Vec<Arc<Subscription>> = lock(&self.subscriptions)
                    .iter()
                    .filter(|subscription| subscription.topic == topic)
                    .cloned()
                    .collect();
                for subscription in ours {
                    connect_all(self, &subscription, &publishers);
                }
                answer(stream, Value::Integer(0))
            }
            ("getPid", _) => answer(stream, Value::Integer(i64::from(std::process::id()))),
            _ => answer(stream, Value::Integer(0)),
        }
    }

    /// Accepts a subscriber of one of the node's topics.
    fn welcome(&self, mut stream: TcpStream) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_nodelay(true)?;
        let fields = read_header(&mut stream)?;
        let field = |name: &str| {
            fields
                .iter()
                .find(|(key, _)| key == name)
                .map(|(_, value)| value.as_str())
        };
        let publication = lock(&self.publications)
            .iter()
            .find(|publication| Some(publication.topic.as_str()) == field("topic"))
            .cloned();
        let Some(publication) = publication else {
            return write_header(&mut stream, &[("error", "no such topic")]);
        };
        let kind = publication.kind;
        if !matches!(field("md5sum"), Some(md5) if md5 == "*" || md5 == kind.md5) {
            let error = format!("{} is defined differently here: {}", kind.name, kind.md5);
            return write_header(&mut stream, &[("error", &error)]);
        }
        let answer = [
            ("callerid", self.name.as_str()),
            ("latching", "0"),
            ("md5sum", kind.md5),
            ("message_definition", ""),
            ("topic", &publication.topic),
            ("type", kind.name),
        ];
        write_header(&mut stream, &answer)?;
        lock(&publication.subscribers).push(stream);
        Ok(())
    }
}

impl Publication {
    /// Number of subscribers.
    pub fn subscribers(&self) -> usize {
        lock(&self.subscribers).len()
    }

    /// Sends a message to all subscribers, removes disconnected ones and returns the number of
    /// receivers.
    pub fn publish(&self, message: &[u8]) -> usize {
        let mut framed = (message.len() as u32).to_le_bytes().to_vec();
        framed.extend(message);
        let mut subscribers = lock(&self.subscribers);
        subscribers.retain_mut(|stream| stream.write_all(&framed).is_ok());
        subscribers.len()
    }
}

/// Connects to new publishers of a topic.
fn connect_all(inner: &Arc<Inner>, subscription: &Arc<Subscription>, publishers: &[String]) {
    for publisher in publishers {
        let mut known = lock(&subscription.publishers);
        if known.len() >= MOST_PUBLISHERS || !known.insert(publisher.clone()) {
            continue;
        }
        drop(known);
        let (inner, subscription, publisher) = (
            Arc::clone(inner),
            Arc::clone(subscription),
            publisher.clone(),
        );
        std::thread::spawn(move || {
            if let Err(error) = listen(&inner, &subscription, &publisher) {
                tracing::debug!("{} from {publisher}: {error}", subscription.topic);
            }
            // The publisher may reconnect under the same address.
            lock(&subscription.publishers).remove(&publisher);
        });
    }
}

/// Reads from one publisher until the publisher or the node ends.
fn listen(inner: &Inner, subscription: &Subscription, publisher: &str) -> io::Result<()> {
    let broken = |what: String| io::Error::new(io::ErrorKind::InvalidData, what);
    let protocols = Value::Array(vec![Value::Array(vec![Value::text("TCPROS")])]);
    let parameters = [
        Value::text(&inner.name),
        Value::text(&subscription.topic),
        protocols,
    ];
    let place = xmlrpc::call(publisher, "requestTopic", &parameters)?;
    let Some([_, Value::Text(host), Value::Integer(port)]) = place.as_array() else {
        return Err(broken("the publisher does not offer TCPROS".into()));
    };
    let port =
        u16::try_from(*port).map_err(|_| broken("the publisher sent an invalid port".into()))?;
    let mut stream = TcpStream::connect((host.as_str(), port))?;
    stream.set_nodelay(true)?;
    // With a timeout, the thread notices the end of the node.
    stream.set_read_timeout(Some(Duration::from_secs(1)))?;
    let kind = subscription.kind;
    let header = [
        ("callerid", inner.name.as_str()),
        ("md5sum", kind.md5),
        ("tcp_nodelay", "1"),
        ("topic", &subscription.topic),
        ("type", kind.name),
    ];
    write_header(&mut stream, &header)?;
    let answer = read_header(&mut stream)?;
    if let Some((_, error)) = answer.iter().find(|(key, _)| key == "error") {
        tracing::warn!(
            "{}: the publisher rejected the subscription: {error}",
            subscription.topic
        );
        return Err(broken(error.clone()));
    }
    loop {
        let mut length = [0; 4];
        if !read_whole(inner, &mut stream, &mut length)? {
            return Ok(());
        }
        let length = u32::from_le_bytes(length) as usize;
        if length > kind.longest() {
            return Err(broken(format!("a message of {length} bytes")));
        }
        let mut message = vec![0; length];
        if !read_whole(inner, &mut stream, &mut message)? {
            return Ok(());
        }
        if subscription
            .sender
            .send(Heard::Message(subscription.label, message))
            .is_err()
        {
            return Ok(());
        }
    }
}

/// Fills the buffer; `false` if the node is closed first.
fn read_whole(inner: &Inner, stream: &mut TcpStream, bytes: &mut [u8]) -> io::Result<bool> {
    let mut done = 0;
    while done < bytes.len() {
        match stream.read(&mut bytes[done..]) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => done += count,
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                ) =>
            {
                if inner.closed.load(Ordering::Relaxed) {
                    return Ok(false);
                }
            }
            Err(error) => return Err(error),
        }
    }
    Ok(true)
}

/// Writes a connection header: the length of all fields, then `key=value` fields, each after its
/// length.
fn write_header(stream: &mut TcpStream, fields: &[(&str, &str)]) -> io::Result<()> {
    let mut body = Vec::new();
    for (key, value) in fields {
        body.extend(((key.len() + 1 + value.len()) as u32).to_le_bytes());
        body.extend(format!("{key}={value}").as_bytes());
    }
    let mut message = (body.len() as u32).to_le_bytes().to_vec();
    message.extend(body);
    stream.write_all(&message)
}

fn read_header(stream: &mut TcpStream) -> io::Result<Vec<(String, String)>> {
    let mut length = [0; 4];
    stream.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length) as usize;
    let broken = || io::Error::new(io::ErrorKind::InvalidData, "a damaged connection header");
    if length > 1 << 20 {
        return Err(broken());
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    let mut rest = body.as_slice();
    let mut fields = Vec::new();
    while !rest.is_empty() {
        let (size, tail) = rest.split_at_checked(4).ok_or_else(broken)?;
        let size = u32::from_le_bytes(size.try_into().unwrap_or_default()) as usize;
        let (field, tail) = tail.split_at_checked(size).ok_or_else(broken)?;
        let field = String::from_utf8_lossy(field);
        let (key, value) = field.split_once('=').ok_or_else(broken)?;
        fields.push((key.to_owned(), value.to_owned()));
        rest = tail;
    }
    Ok(fields)
}
