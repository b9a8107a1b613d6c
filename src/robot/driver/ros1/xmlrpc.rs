//! XML-RPC over HTTP, as used by ROS 1 masters and nodes.

use rodlab_files::input;
use roxmltree::{Document, ParsingOptions};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Longest wait for a whole message.
const PATIENCE: Duration = Duration::from_millis(1500);
/// Longest message, bytes.
const LONGEST: usize = 1 << 20;
/// Largest number of nodes of a message: elements and texts.
const MOST_NODES: u32 = 100_000;

/// A value of a call or an answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// An integer, or a boolean as 0 or 1.
    Integer(i64),
    /// Text.
    Text(String),
    /// Values in order.
    Array(Vec<Value>),
    /// Anything else.
    Other,
}

impl Value {
    /// A text.
    pub fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    /// The text, if the value is a text.
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The values, if the value is an array.
    pub fn as_array(&self) -> Option<&[Value]> {
        match self {
            Self::Array(values) => Some(values),
            _ => None,
        }
    }

    /// The texts in an array; empty for other values.
    pub fn texts(&self) -> Vec<String> {
        let values = self.as_array().unwrap_or_default().iter();
        let texts = values.filter_map(Self::as_text);
        texts.map(str::to_owned).collect()
    }

    fn to_xml(&self) -> String {
        match self {
            Self::Integer(number) => format!("<value><int>{number}</int></value>"),
            Self::Text(text) => {
                let escaped = text.replace('&', "&amp;").replace('<', "&lt;");
                format!("<value><string>{escaped}</string></value>")
            }
            Self::Array(values) => {
                let inner: String = values.iter().map(Self::to_xml).collect();
                format!("<value><array><data>{inner}</data></array></value>")
            }
            Self::Other => "<value><string></string></value>".to_owned(),
        }
    }

    fn from_xml(value: roxmltree::Node<'_, '_>) -> Self {
        let Some(typed) = value.children().find(roxmltree::Node::is_element) else {
            // Text without a type is a string.
            return Self::Text(value.text().unwrap_or_default().to_owned());
        };
        let text = typed.text().unwrap_or_default();
        match typed.tag_name().name() {
            "int" | "i4" | "boolean" => text.trim().parse().map_or(Self::Other, Self::Integer),
            "string" => Self::Text(text.to_owned()),
            "array" => {
                let data = typed.children().filter(|child| child.has_tag_name("data"));
                let values = data.flat_map(|data| data.children());
                let values = values.filter(|child| child.has_tag_name("value"));
                Self::Array(values.map(Self::from_xml).collect())
            }
            _ => Self::Other,
        }
    }
}

/// Host and port of an address such as `http://robot:11311/`.
pub fn authority(uri: &str) -> Option<&str> {
    let rest = uri.strip_prefix("http://")?;
    rest.split('/')
        .next()
        .filter(|authority| authority.contains(':'))
}

/// Calls a method of a node or a master and returns the third part of its answer, after code and message.
///
/// # Errors
/// There is no answer, the answer is not XML-RPC, or its code is not 1.
pub fn call(uri: &str, method: &str, parameters: &[Value]) -> io::Result<Value> {
    let broken =
        |what: &str| io::Error::new(io::ErrorKind::InvalidData, format!("{method}: {what}"));
    let authority =
        authority(uri).ok_or_else(|| broken("not an address of the form http://host:port/"))?;
    let address = authority
        .to_socket_addrs()?
        .next()
        .ok_or_else(|| broken("the host has no address"))?;
    let mut stream = TcpStream::connect_timeout(&address, PATIENCE)?;
    let parameters: String = parameters
        .iter()
        .map(|value| format!("<param>{}</param>", value.to_xml()))
        .collect();
    let body = format!(
        "<?xml version=\"1.0\"?><methodCall><methodName>{method}</methodName><params>{parameters}</params></methodCall>"
    );
    write!(
        stream,
        "POST /RPC2 HTTP/1.0\r\nHost: {authority}\r\nContent-Type: text/xml\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    )?;
    let text = read_body(&mut BufReader::new(Timely::new(&stream)))?;
    let document = parse(&text).map_err(|reason| broken(&format!("the answer: {reason}")))?;
    let value = document
        .descendants()
        .find(|node| node.has_tag_name("value"));
    let value = value
        .map(Value::from_xml)
        .ok_or_else(|| broken("the answer has no value"))?;
    match value.as_array() {
        Some([Value::Integer(1), _, result]) => Ok(result.clone()),
        Some([_, Value::Text(message), ..]) => Err(broken(message.as_str())),
        _ => Err(broken("the answer is not a ROS response")),
    }
}

/// A call of a method.
pub struct Call {
    /// The method.
    pub method: String,
    /// Parameters of the call.
    pub parameters: Vec<Value>,
}

/// Reads a call.
///
/// # Errors
/// The call is not XML-RPC, or does not arrive in time.
pub fn read_call(stream: &TcpStream) -> io::Result<Call> {
    let text = read_body(&mut BufReader::new(Timely::new(stream)))?;
    let document = parse(&text).map_err(|reason| invalid(&format!("a call: {reason}")))?;
    Ok(call_in(&document))
}

fn call_in(document: &Document<'_>) -> Call {
    let method = document
        .descendants()
        .find(|node| node.has_tag_name("methodName"));
    let parameters = document
        .descendants()
        .filter(|node| node.has_tag_name("param"))
        .filter_map(|param| param.children().find(|child| child.has_tag_name("value")));
    Call {
        method: method
            .and_then(|node| node.text())
            .unwrap_or_default()
            .trim()
            .to_owned(),
        parameters: parameters.map(Value::from_xml).collect(),
    }
}

/// The document of a message. The depth of the document is checked first, since [`Value::from_xml`]
/// recurses.
fn parse(text: &str) -> Result<Document<'_>, String> {
    if text.len() > LONGEST {
        return Err(format!("longer than {LONGEST} bytes"));
    }
    input::check_nesting(text)?;
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).map_err(|error| format!("not XML: {error}"))
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.to_owned())
}

/// A connection whose whole message must arrive within [`PATIENCE`], in any number of pieces.
struct Timely<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl<'a> Timely<'a> {
    fn new(stream: &'a TcpStream) -> Self {
        Self {
            stream,
            end: Instant::now() + PATIENCE,
        }
    }
}

impl Read for Timely<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(buffer)
    }
}

/// Answers a call with success.
///
/// # Errors
/// The caller has disconnected.
pub fn answer(mut stream: &TcpStream, result: Value) -> io::Result<()> {
    let answer = Value::Array(vec![Value::Integer(1), Value::text(""), result]);
    let body = format!(
        "<?xml version=\"1.0\"?><methodResponse><params><param>{}</param></params></methodResponse>",
        answer.to_xml()
    );
    write!(
        stream,
        "HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Type: text/xml\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    )
}

/// The body of an HTTP message.
fn read_body(reader: &mut impl BufRead) -> io::Result<String> {
    let mut length = None;
    let mut total = 0;
    loop {
        let mut line = String::new();
        total += reader.by_ref().take(4096).read_line(&mut line)?;
        if line.trim_end().is_empty() {
            break;
        }
        if total > 1 << 16 {
            return Err(invalid("the header does not end"));
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse::<usize>().ok();
        }
    }
    if length.is_some_and(|length| length > LONGEST) {
        return Err(invalid(&format!("longer than {LONGEST} bytes")));
    }
    let mut body = Vec::new();
    let limit = length.unwrap_or(LONGEST);
    reader.take(limit as u64).read_to_end(&mut body)?;
    String::from_utf8(body).map_err(|_| invalid("text that is not UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn values_read_back() {
        let value = Value::Array(vec![
            Value::Integer(-3),
            Value::text("a <b> & c"),
            Value::Array(vec![Value::text("TCPROS")]),
        ]);
        let text = value.to_xml();
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(Value::from_xml(document.root_element()), value);
        let bare = roxmltree::Document::parse("<value>bare</value>").unwrap();
        assert_eq!(Value::from_xml(bare.root_element()), Value::text("bare"));
    }

    fn call_of_text(text: &str) -> Result<Call, String> {
        parse(text).map(|document| call_in(&document))
    }

    #[test]
    fn nested_and_long_messages_are_refused() {
        let nested = |depth: usize| {
            let (open, close) = ("<value><array><data>", "</data></array></value>");
            let values = format!("{}{}", open.repeat(depth), close.repeat(depth));
            format!("<methodCall><params><param>{values}</param></params></methodCall>")
        };
        assert_eq!(call_of_text(&nested(30)).unwrap().parameters.len(), 1);
        let refused = |text: &str| call_of_text(text).err().unwrap();
        assert!(refused(&nested(10_000)).contains("nested more than 100 levels"));
        assert!(refused(&" ".repeat(LONGEST + 1)).contains("longer than"));
        assert!(refused(&format!("<a>{}</a>", "<b/>".repeat(200_000))).contains("not XML"));
    }

    #[test]
    fn addresses_have_host_and_port() {
        assert_eq!(authority("http://10.0.0.1:11311/"), Some("10.0.0.1:11311"));
        assert_eq!(authority("http://robot"), None);
        assert_eq!(authority("robot:11311"), None);
    }

    proptest! {
        #[test]
        fn no_call_panics(text in "(<(/|)(value|array|data|int|string|param|methodName)(/|)>|[a-z0-9<&;]){0,60}") {
            let _ = call_of_text(&format!("<methodCall>{text}</methodCall>"));
            let _ = call_of_text(&text);
            let _ = read_body(&mut text.as_bytes());
        }
    }
}
