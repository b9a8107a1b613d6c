//! Faults to inject into a virtual cell.

use std::fmt;
use std::str::FromStr;

/// Kinds of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// All connections are cut; new ones are accepted.
    DropLink,
    /// The joint that moves fastest at that time stops permanently.
    FreezeJoint,
    /// The gripper loses the rod or the sheet.
    SlipGrasp,
    /// The camera stops sending pictures.
    LoseCamera,
}

/// Names of faults.
const KINDS: [(&str, FaultKind); 4] = [
    ("drop-link", FaultKind::DropLink),
    ("freeze-joint", FaultKind::FreezeJoint),
    ("slip-grasp", FaultKind::SlipGrasp),
    ("lose-camera", FaultKind::LoseCamera),
];

/// A fault with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Time of the fault, s of the cell's clock. This time is counted only while an arm moves, so
    /// that pauses between motions do not matter.
    pub time: f64,
}

impl FromStr for Fault {
    type Err = String;

    /// Parses a fault such as `drop-link@3s`.
    fn from_str(text: &str) -> Result<Self, String> {
        let shape = || {
            let names: Vec<&str> = KINDS.iter().map(|(name, _)| *name).collect();
            format!(
                "a fault and a time are needed, as in drop-link@3s; faults: {}",
                names.join(", ")
            )
        };
        let (name, time) = text.split_once('@').ok_or_else(shape)?;
        let known = KINDS.iter().find(|(known, _)| *known == name.trim());
        let (_, kind) = known.ok_or_else(shape)?;
        let number = time.trim().trim_end_matches('s').trim().parse().ok();
        let time = number.filter(|time: &f64| (0.0..=1e6).contains(time));
        Ok(Self {
            kind: *kind,
            time: time.ok_or_else(|| format!("{text}: a time from 0 to 1e6 s is needed"))?,
        })
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = KINDS.iter().find(|(_, kind)| kind == self);
        formatter.write_str(named.map_or("", |(name, _)| name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_named_with_their_times() {
        let fault: Fault = "freeze-joint@2.5s".parse().unwrap();
        assert_eq!((fault.kind, fault.time), (FaultKind::FreezeJoint, 2.5));
        assert_eq!(fault.kind.to_string(), "freeze-joint");
        assert_eq!("drop-link@3".parse::<Fault>().unwrap().time, 3.0);
        for text in ["drop-link", "drop@3s", "drop-link@-1s", "drop-link@NaN"] {
            let error = text.parse::<Fault>().unwrap_err();
            assert!(error.contains("needed"), "{error}");
        }
    }
}
