//! Services of ROS 2 as topics of DDS, for two kinds of middleware.
//!
//! With Fast DDS, an answer identifies its request in parameters outside the message. With Cyclone
//! DDS, request and answer begin with 16 bytes that identify the request. A server of either kind
//! does not answer clients of the other kind.

use super::Middleware;
use rustdds::bytes::Bytes;
use rustdds::no_key::{
    DataReader, DataWriter, Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter,
};
use rustdds::policy::{Durability, History, Reliability};
use rustdds::serialization::{deserialize_from_cdr_with_rep_id, to_writer_with_rep_id};
use rustdds::{
    DomainParticipant, QosPolicies, QosPolicyBuilder, RepresentationIdentifier, SampleIdentity,
    TopicKind, WriteOptionsBuilder,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::convert::Infallible;
use std::fmt::Display;
use std::marker::PhantomData;

/// Depth of the history of every topic, as in ROS 2.
const DEPTH: i32 = 10;
/// Longest wait for space in the queue of unacknowledged messages, ms.
const WRITE_PATIENCE: i32 = 100;

/// A message encoded in CDR. Code that reads and writes topics is compiled for this type only.
#[derive(Clone, Debug)]
pub struct Encoded {
    bytes: Vec<u8>,
    encoding: RepresentationIdentifier,
}

impl Encoded {
    /// Encodes a message.
    ///
    /// # Errors
    /// A message about the failure.
    pub fn of(message: &impl Serialize) -> Result<Self, String> {
        let (mut bytes, encoding) = (Vec::new(), RepresentationIdentifier::CDR_LE);
        to_writer_with_rep_id(&mut bytes, message, encoding).map_err(in_words)?;
        Ok(Self { bytes, encoding })
    }

    /// Decodes it.
    ///
    /// # Errors
    /// A message about the failure.
    fn decoded<T: DeserializeOwned>(&self) -> Result<T, String> {
        let decoded = deserialize_from_cdr_with_rep_id(&self.bytes, self.encoding);
        Ok(decoded.map_err(in_words)?.0)
    }
}

/// Passes messages to and from topics unchanged.
#[derive(Clone, Copy, Debug)]
pub struct AsTheyAre;

impl DeserializerAdapter<Encoded> for AsTheyAre {
    type Error = Infallible;
    type Decoded = Encoded;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[
            RepresentationIdentifier::CDR_BE,
            RepresentationIdentifier::CDR_LE,
            RepresentationIdentifier::PL_CDR_LE,
        ]
    }

    fn transform_decoded(decoded: Encoded) -> Encoded {
        decoded
    }
}

impl DefaultDecoder<Encoded> for AsTheyAre {
    type Decoder = Self;
    const DECODER: Self = Self;
}

impl Decode<'_, Encoded> for AsTheyAre {
    type Error = Infallible;

    fn decode_bytes(
        self,
        bytes: &[u8],
        encoding: RepresentationIdentifier,
    ) -> Result<Encoded, Infallible> {
        let bytes = bytes.to_vec();
        Ok(Encoded { bytes, encoding })
    }
}

impl SerializerAdapter<Encoded> for AsTheyAre {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(message: &Encoded) -> Result<Bytes, Infallible> {
        Ok(message.bytes.clone().into())
    }
}

/// Publisher of a topic.
pub type Writer = DataWriter<Encoded, AsTheyAre>;

/// Subscriber of a topic.
pub struct Reader<T> {
    reader: DataReader<Encoded, AsTheyAre>,
    messages: PhantomData<fn() -> T>,
}

impl<T: DeserializeOwned> Reader<T> {
    /// The next message, if one has arrived.
    ///
    /// # Errors
    /// A message about the failure.
    pub fn next(&mut self) -> Result<Option<T>, String> {
        let sample = self.reader.take_next_sample().map_err(in_words)?;
        sample.map(|sample| sample.value().decoded()).transpose()
    }
}

/// Quality of service of services, and of feedback.
pub fn reliable() -> QosPolicies {
    let max_blocking_time = rustdds::Duration::from_millis(WRITE_PATIENCE.into());
    profile(Reliability::Reliable { max_blocking_time })
}

/// Quality of service of joint states; compatible with publishers of either kind.
pub fn best_effort() -> QosPolicies {
    profile(Reliability::BestEffort)
}

/// Quality of service of publishers that send their last messages to later subscribers.
pub fn latched() -> QosPolicies {
    let max_blocking_time = rustdds::Duration::from_millis(WRITE_PATIENCE.into());
    durable(
        Reliability::Reliable { max_blocking_time },
        Durability::TransientLocal,
    )
}

fn profile(reliability: Reliability) -> QosPolicies {
    durable(reliability, Durability::Volatile)
}

fn durable(reliability: Reliability, durability: Durability) -> QosPolicies {
    QosPolicyBuilder::new()
        .reliability(reliability)
        .durability(durability)
        .history(History::KeepLast { depth: DEPTH })
        .build()
}

/// Subscribes to a topic of DDS.
///
/// # Errors
/// A message about the failure.
pub fn subscribe<T>(
    participant: &DomainParticipant,
    topic: &str,
    kind: &str,
    quality: &QosPolicies,
) -> Result<Reader<T>, String> {
    let name = (topic.to_owned(), kind.to_owned());
    let topic = participant
        .create_topic(name.0, name.1, quality, TopicKind::NoKey)
        .map_err(in_words)?;
    let subscriber = participant.create_subscriber(quality).map_err(in_words)?;
    let reader = subscriber.create_datareader_no_key(&topic, None);
    Ok(Reader {
        reader: reader.map_err(in_words)?,
        messages: PhantomData,
    })
}

/// Publishes a topic of DDS.
///
/// # Errors
/// A message about the failure.
pub fn publish(participant: &DomainParticipant, topic: &str, kind: &str) -> Result<Writer, String> {
    let quality = reliable();
    let name = (topic.to_owned(), kind.to_owned());
    let topic = participant
        .create_topic(name.0, name.1, &quality, TopicKind::NoKey)
        .map_err(in_words)?;
    let publisher = participant.create_publisher(&quality).map_err(in_words)?;
    publisher
        .create_datawriter_no_key(&topic, None)
        .map_err(in_words)
}

fn in_words(error: impl Display) -> String {
    error.to_string()
}

/// Place of the request identifier in an answer.
enum Naming {
    /// In parameters outside the message, as the identity of the last request: Fast DDS.
    Beside(Option<SampleIdentity>),
    /// At the beginning of the message, as half of the client's identity and the number of the
    /// last request: Cyclone DDS.
    InFront([u8; 8], i64),
}

/// A client of a service, with one request at a time.
pub struct Service<Q, A> {
    requests_topic: String,
    answers_topic: String,
    requests: Writer,
    answers: Reader<A>,
    naming: Naming,
    asks: PhantomData<fn(Q)>,
}

impl<Q: Serialize, A: DeserializeOwned> Service<Q, A> {
    /// A client of the service `name`, without a leading slash, with messages of the kind
    /// `package::srv::dds_::Kind`.
    ///
    /// # Errors
    /// A message about the failure.
    pub fn new(
        participant: &DomainParticipant,
        middleware: Middleware,
        name: &str,
        kind: &str,
    ) -> Result<Self, String> {
        let requests_topic = format!("rq/{name}Request");
        let answers_topic = format!("rr/{name}Reply");
        let (request, answer) = (format!("{kind}_Request_"), format!("{kind}_Response_"));
        let answers = subscribe(participant, &answers_topic, &answer, &reliable())?;
        let requests = publish(participant, &requests_topic, &request)?;
        let naming = match middleware {
            Middleware::FastDds => Naming::Beside(None),
            Middleware::CycloneDds => {
                let mut client = [0; 8];
                client.copy_from_slice(&rustdds::RTPSEntity::guid(&requests).to_bytes()[8..]);
                Naming::InFront(client, 0)
            }
        };
        Ok(Self {
            requests_topic,
            answers_topic,
            requests,
            answers,
            naming,
            asks: PhantomData,
        })
    }

    /// Whether a server reads the requests and writes the answers.
    pub fn is_served(&self, participant: &DomainParticipant) -> bool {
        let readers = participant.discovered_readers();
        let writers = participant.discovered_writers();
        readers
            .iter()
            .any(|reader| *reader.subscription_topic_data.topic_name() == self.requests_topic)
            && writers
                .iter()
                .any(|writer| *writer.publication_topic_data.topic_name() == self.answers_topic)
    }

    /// Sends a request; answers to earlier ones are ignored.
    ///
    /// # Errors
    /// A message about the failure.
    pub fn ask(&mut self, request: Q) -> Result<(), String> {
        let message = match &mut self.naming {
            Naming::Beside(_) => Encoded::of(&request)?,
            Naming::InFront(client, number) => {
                *number += 1;
                Encoded::of(&(*client, *number, request))?
            }
        };
        let options = WriteOptionsBuilder::new().build();
        let sent = self.requests.write_with_options(message, options);
        let sent = sent.map_err(|error| error.forget_data().to_string())?;
        if let Naming::Beside(pending) = &mut self.naming {
            *pending = Some(sent);
        }
        Ok(())
    }

    /// The answer to the last request, once it has arrived.
    ///
    /// # Errors
    /// A message about the failure.
    pub fn answer(&mut self) -> Result<Option<A>, String> {
        while let Some(sample) = self.answers.reader.take_next_sample().map_err(in_words)? {
            match self.naming {
                Naming::Beside(pending) => {
                    let answered = sample.sample_info().related_sample_identity();
                    if answered.is_some() && answered == pending {
                        return sample.value().decoded().map(Some);
                    }
                }
                Naming::InFront(client, number) => {
                    let (to, of, message): ([u8; 8], i64, A) = sample.value().decoded()?;
                    if (to, of) == (client, number) {
                        return Ok(Some(message));
                    }
                }
            }
        }
        Ok(None)
    }
}
