//! Checkpoints: two rotating files, versioned and checksummed.
//!
//! Layout, integers in little-endian order:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `RODLABCP` |
//! | 4 | version of this layout and of the payload |
//! | 64 | hash of the scenario, hexadecimal |
//! | 8 | sequence number: the larger is the newer |
//! | 8 | length of the payload |
//! | … | payload, postcard |
//! | 32 | BLAKE3 of all before |

use super::{ResultsError, write_whole};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Names of the two files.
pub(super) const SLOTS: [&str; 2] = ["checkpoint.0", "checkpoint.1"];

const MAGIC: &[u8; 8] = b"RODLABCP";
/// Version of the layout. Increase it whenever the layout, the payload's types or the meaning of
/// the state change.
const VERSION: u32 = 15;
const HASH_LENGTH: usize = 64;
const HEADER_LENGTH: usize = 8 + 4 + HASH_LENGTH + 8 + 8;
const CHECKSUM_LENGTH: usize = blake3::OUT_LEN;

/// The two checkpoint files of a results directory.
///
/// Each new checkpoint overwrites the older file, so that one whole checkpoint exists at any time.
pub struct CheckpointFiles {
    directory: PathBuf,
    scenario_hash: String,
    next_sequence: u64,
}

impl CheckpointFiles {
    /// The checkpoints in a directory, for the scenario with the given hash.
    pub fn new(directory: &Path, scenario_hash: &str) -> Self {
        assert_eq!(
            scenario_hash.len(),
            HASH_LENGTH,
            "a BLAKE3 hash in hexadecimal"
        );
        Self {
            directory: directory.to_owned(),
            scenario_hash: scenario_hash.to_owned(),
            next_sequence: 0,
        }
    }

    /// Writes a checkpoint that replaces the older one.
    pub fn write(&mut self, payload: &impl Serialize) -> Result<(), ResultsError> {
        let slot = SLOTS[(self.next_sequence % 2) as usize];
        let bytes = encode(&self.scenario_hash, self.next_sequence, payload);
        write_whole(&self.directory.join(slot), &bytes)?;
        self.next_sequence += 1;
        Ok(())
    }

    /// Reads the newest complete checkpoint that `accept` accepts; `None` if there is none.
    ///
    /// An unusable checkpoint causes a warning; then the older one is tried.
    ///
    /// # Errors
    /// [`ResultsError::Altered`], as returned by `accept`, if it rejected a complete checkpoint
    /// because files do not match it, and no other checkpoint was accepted.
    pub fn read<P: DeserializeOwned, T>(
        &mut self,
        mut accept: impl FnMut(P) -> Result<T, ResultsError>,
    ) -> Result<Option<T>, ResultsError> {
        let mut found: Vec<(u64, PathBuf, Vec<u8>)> = Vec::new();
        for slot in SLOTS {
            let path = self.directory.join(slot);
            match fs::read(&path) {
                Ok(bytes) => match check(&bytes, &self.scenario_hash) {
                    Ok((sequence, payload)) => found.push((sequence, path, payload.to_vec())),
                    Err(reason) => warn_unusable(&path, &reason),
                },
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(error) => warn_unusable(&path, &error.to_string()),
            }
        }
        found.sort_by_key(|(sequence, ..)| std::cmp::Reverse(*sequence));
        let mut altered = None;
        for (sequence, path, payload) in found {
            let accepted = match postcard::from_bytes(&payload) {
                Ok(payload) => accept(payload),
                Err(error) => Err(ResultsError::Damaged {
                    path: path.clone(),
                    reason: error.to_string(),
                }),
            };
            match accepted {
                Ok(accepted) => {
                    self.next_sequence = sequence + 1;
                    return Ok(Some(accepted));
                }
                Err(error @ ResultsError::Altered { .. }) => drop(altered.get_or_insert(error)),
                Err(error) => warn_unusable(&path, &error.to_string()),
            }
        }
        altered.map_or(Ok(None), Err)
    }

    /// Whether any checkpoint exists, usable or not.
    pub fn exist(&self) -> bool {
        SLOTS.iter().any(|slot| self.directory.join(slot).exists())
    }

    /// Removes both files.
    pub fn remove(&self) -> Result<(), ResultsError> {
        for slot in SLOTS {
            let path = self.directory.join(slot);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(ResultsError::io("remove", path)(error));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

fn warn_unusable(path: &Path, reason: &str) {
    tracing::warn!("checkpoint `{}` cannot be used: {reason}", path.display());
}

fn encode(scenario_hash: &str, sequence: u64, payload: &impl Serialize) -> Vec<u8> {
    let payload = postcard::to_stdvec(payload).expect("plain data can be encoded");
    let mut bytes = Vec::with_capacity(HEADER_LENGTH + payload.len() + CHECKSUM_LENGTH);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(scenario_hash.as_bytes());
    bytes.extend_from_slice(&sequence.to_le_bytes());
    bytes.extend_from_slice(&(payload.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&payload);
    let checksum = blake3::hash(&bytes);
    bytes.extend_from_slice(checksum.as_bytes());
    bytes
}

/// Sequence number and payload of a checkpoint, or the reason why it is unusable.
fn check<'a>(bytes: &'a [u8], scenario_hash: &str) -> Result<(u64, &'a [u8]), String> {
    let Some((content, checksum)) = bytes.split_last_chunk::<CHECKSUM_LENGTH>() else {
        return Err("it is too short".into());
    };
    if !content.starts_with(MAGIC) {
        return Err("it is not a checkpoint".into());
    }
    if blake3::hash(content) != blake3::Hash::from_bytes(*checksum) {
        return Err("its checksum is wrong".into());
    }
    let Some((header, payload)) = content.split_first_chunk::<HEADER_LENGTH>() else {
        return Err("it is too short".into());
    };
    let (version, rest) = header[MAGIC.len()..].split_at(4);
    let (hash, rest) = rest.split_at(HASH_LENGTH);
    let (sequence, length) = rest.split_at(8);
    if version != VERSION.to_le_bytes() {
        return Err("it was written by another version of rodlab".into());
    }
    if hash != scenario_hash.as_bytes() {
        return Err("it belongs to another scenario".into());
    }
    if length != (payload.len() as u64).to_le_bytes() {
        return Err("its length is wrong".into());
    }
    let sequence = u64::from_le_bytes(sequence.try_into().expect("eight bytes"));
    Ok((sequence, payload))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::scenario_hash;
    use proptest::prelude::*;

    type Payload = (u64, Vec<f64>, Option<String>);

    fn payload(k: u64) -> Payload {
        (
            k,
            vec![0.1 * k as f64, f64::MIN_POSITIVE / 3.0, f64::INFINITY, -0.0],
            Some("state".into()),
        )
    }

    fn files(directory: &Path) -> CheckpointFiles {
        CheckpointFiles::new(directory, &scenario_hash("a = 1"))
    }

    fn read(directory: &Path) -> Option<Payload> {
        files(directory).read(Ok::<Payload, _>).unwrap()
    }

    #[test]
    fn the_newest_is_read_back_bit_for_bit() {
        let directory = tempfile::tempdir().unwrap();
        assert_eq!(read(directory.path()), None);
        let mut writer = files(directory.path());
        for k in 0..5 {
            writer.write(&payload(k)).unwrap();
            let (number, values, text) = read(directory.path()).unwrap();
            assert_eq!((number, text), (k, payload(k).2));
            for (value, expected) in values.iter().zip(payload(k).1) {
                assert_eq!(value.to_bits(), expected.to_bits());
            }
        }
    }

    #[test]
    fn after_reading_the_older_checkpoint_is_overwritten() {
        let directory = tempfile::tempdir().unwrap();
        let mut writer = files(directory.path());
        (0..3).for_each(|k| writer.write(&payload(k)).unwrap());
        let mut continued = files(directory.path());
        continued.read(Ok::<Payload, _>).unwrap();
        continued.write(&payload(3)).unwrap();
        // The file of checkpoint 3 is damaged; checkpoint 2 must still exist.
        fs::write(directory.path().join(SLOTS[1]), "").unwrap();
        assert_eq!(read(directory.path()).unwrap().0, 2);
    }

    #[test]
    fn the_older_one_is_used_where_the_newest_is_damaged_or_refused() {
        let directory = tempfile::tempdir().unwrap();
        let mut writer = files(directory.path());
        (0..2).for_each(|k| writer.write(&payload(k)).unwrap());
        let refused = files(directory.path()).read(|found: Payload| {
            if found.0 == 1 {
                Err(ResultsError::Damaged {
                    path: SERIES_PATH.into(),
                    reason: "short".into(),
                })
            } else {
                Ok(found)
            }
        });
        assert_eq!(refused.unwrap().unwrap().0, 0);
        let newest = directory.path().join(SLOTS[1]);
        let whole = fs::read(&newest).unwrap();
        fs::write(&newest, &whole[..whole.len() - 1]).unwrap();
        assert_eq!(read(directory.path()).unwrap().0, 0);
        fs::write(directory.path().join(SLOTS[0]), "rubbish").unwrap();
        assert_eq!(read(directory.path()), None);
    }

    const SERIES_PATH: &str = "series.csv";

    #[test]
    fn checkpoints_of_another_scenario_are_not_used() {
        let directory = tempfile::tempdir().unwrap();
        files(directory.path()).write(&payload(0)).unwrap();
        let mut other = CheckpointFiles::new(directory.path(), &scenario_hash("a = 2"));
        assert!(other.read(Ok::<Payload, _>).unwrap().is_none());
    }

    proptest! {
        #[test]
        fn any_flipped_byte_is_noticed(position: prop::sample::Index, flip in 1u8..) {
            let hash = scenario_hash("a = 1");
            let mut bytes = encode(&hash, 7, &payload(3));
            prop_assert_eq!(check(&bytes, &hash).unwrap().0, 7);
            let position = position.index(bytes.len());
            bytes[position] ^= flip;
            prop_assert!(check(&bytes, &hash).is_err());
        }

        #[test]
        fn no_bytes_panic(bytes: Vec<u8>) {
            prop_assert!(check(&bytes, &scenario_hash("a = 1")).is_err());
        }
    }
}
