//! Services of ROS 2 as topics of DDS, in the two ways in which robots have them.
//!
//! Behind Fast DDS an answer names its request in the parameters beside the message; behind Cyclone DDS request and
//! answer begin with 16 bytes that name the request. Either kind of server keeps silent to the other kind of client.

use super::Middleware;
use rustdds::no_key::{DataReader, DataWriter};
use rustdds::policy::{Durability, History, Reliability};
use rustdds::{
    CDRDeserializerAdapter, CDRSerializerAdapter, DomainParticipant, QosPolicies, QosPolicyBuilder,
    SampleIdentity, TopicKind, WriteOptionsBuilder,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// Depth of the history of every topic, as ROS 2 has it.
const DEPTH: i32 = 10;
/// Longest wait for a place among messages that are not confirmed yet, ms.
const WRITE_PATIENCE: i32 = 100;

type Writer<T> = DataWriter<T, CDRSerializerAdapter<T>>;
type Reader<T> = DataReader<T, CDRDeserializerAdapter<T>>;

/// Quality of service of services, and of feedback.
pub fn reliable() -> QosPolicies {
    let max_blocking_time = rustdds::Duration::from_millis(WRITE_PATIENCE.into());
    profile(Reliability::Reliable { max_blocking_time })
}

/// Quality of service of joint states: it fits publishers of either kind.
pub fn best_effort() -> QosPolicies {
    profile(Reliability::BestEffort)
}

fn profile(reliability: Reliability) -> QosPolicies {
    QosPolicyBuilder::new()
        .reliability(reliability)
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: DEPTH })
        .build()
}

/// Subscribes a topic of DDS.
///
/// # Errors
/// In words.
pub fn subscribe<T: DeserializeOwned + 'static>(
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
    subscriber
        .create_datareader_no_key_cdr(&topic, None)
        .map_err(in_words)
}

/// Publishes a topic of DDS.
///
/// # Errors
/// In words.
pub fn publish<T: Serialize>(
    participant: &DomainParticipant,
    topic: &str,
    kind: &str,
) -> Result<Writer<T>, String> {
    let quality = reliable();
    let name = (topic.to_owned(), kind.to_owned());
    let topic = participant
        .create_topic(name.0, name.1, &quality, TopicKind::NoKey)
        .map_err(in_words)?;
    let publisher = participant.create_publisher(&quality).map_err(in_words)?;
    publisher
        .create_datawriter_no_key_cdr(&topic, None)
        .map_err(in_words)
}

fn in_words(error: impl Display) -> String {
    error.to_string()
}

/// A message behind Cyclone DDS with the name of its request: half of the client's identity and a number.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Named<T> {
    client: [u8; 8],
    number: i64,
    message: T,
}

/// A client of a service, with one request at a time.
pub struct Service<Q: Serialize, A: DeserializeOwned + 'static> {
    requests_topic: String,
    answers_topic: String,
    wire: Wire<Q, A>,
}

enum Wire<Q: Serialize, A: DeserializeOwned + 'static> {
    FastDds {
        requests: Writer<Q>,
        answers: Reader<A>,
        pending: Option<SampleIdentity>,
    },
    CycloneDds {
        requests: Writer<Named<Q>>,
        answers: Reader<Named<A>>,
        client: [u8; 8],
        number: i64,
    },
}

impl<Q: Serialize, A: DeserializeOwned + 'static> Service<Q, A> {
    /// A client of the service `name`, without a slash in front, whose messages are of the kind `package::srv::dds_::Kind`.
    ///
    /// # Errors
    /// In words.
    pub fn new(
        participant: &DomainParticipant,
        middleware: Middleware,
        name: &str,
        kind: &str,
    ) -> Result<Self, String> {
        let requests_topic = format!("rq/{name}Request");
        let answers_topic = format!("rr/{name}Reply");
        let (request, answer) = (format!("{kind}_Request_"), format!("{kind}_Response_"));
        let wire = match middleware {
            Middleware::FastDds => Wire::FastDds {
                answers: subscribe(participant, &answers_topic, &answer, &reliable())?,
                requests: publish(participant, &requests_topic, &request)?,
                pending: None,
            },
            Middleware::CycloneDds => {
                let answers = subscribe(participant, &answers_topic, &answer, &reliable())?;
                let requests: Writer<Named<Q>> = publish(participant, &requests_topic, &request)?;
                let mut client = [0; 8];
                client.copy_from_slice(&rustdds::RTPSEntity::guid(&requests).to_bytes()[8..]);
                Wire::CycloneDds {
                    requests,
                    answers,
                    client,
                    number: 0,
                }
            }
        };
        Ok(Self {
            requests_topic,
            answers_topic,
            wire,
        })
    }

    /// Whether somebody listens to the requests, and somebody answers.
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

    /// Sends a request; an answer to one before is not waited for any more.
    ///
    /// # Errors
    /// In words.
    pub fn ask(&mut self, request: Q) -> Result<(), String> {
        match &mut self.wire {
            Wire::FastDds {
                requests, pending, ..
            } => {
                let options = WriteOptionsBuilder::new().build();
                let sent = requests.write_with_options(request, options);
                *pending = Some(sent.map_err(|error| error.forget_data().to_string())?);
            }
            Wire::CycloneDds {
                requests,
                client,
                number,
                ..
            } => {
                *number += 1;
                let named = Named {
                    client: *client,
                    number: *number,
                    message: request,
                };
                let sent = requests.write(named, None);
                sent.map_err(|error| error.forget_data().to_string())?;
            }
        }
        Ok(())
    }

    /// The answer to the last request, once it is there.
    ///
    /// # Errors
    /// In words.
    pub fn answer(&mut self) -> Result<Option<A>, String> {
        match &mut self.wire {
            Wire::FastDds {
                answers, pending, ..
            } => {
                while let Some(sample) = answers.take_next_sample().map_err(in_words)? {
                    let answered = sample.sample_info().related_sample_identity();
                    if answered.is_some() && answered == *pending {
                        return Ok(Some(sample.into_value()));
                    }
                }
            }
            Wire::CycloneDds {
                answers,
                client,
                number,
                ..
            } => {
                while let Some(sample) = answers.take_next_sample().map_err(in_words)? {
                    let named = sample.into_value();
                    if (named.client, named.number) == (*client, *number) {
                        return Ok(Some(named.message));
                    }
                }
            }
        }
        Ok(None)
    }
}
