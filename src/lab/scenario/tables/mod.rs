//! Tables of keys, each declared once: as typed, as resolved, and the checks between its keys.

mod body;
mod continuation;
mod flow;
mod joint;
mod load;
mod plane;
mod probe;
mod run;
mod stiffness;

pub use body::{Body, BodyKeys, BodyShape, bodies};
pub use continuation::{Continuation, ContinuationKeys, PathMethod, continuation};
pub use flow::{Flow, FlowKeys, FlowKind};
pub use joint::{Joint, JointKeys, JointKind, SpringOnly, joints};
pub use load::{Load, LoadFrame, LoadKeys, LoadKind, loads};
pub use plane::{Plane, PlaneKeys, planes};
pub use probe::{Probe, ProbeKeys, ProbeKind, StopKeys, StopWhen, Summary, probes, stop_when};
pub use run::{Output, OutputKeys, Solver, SolverKeys};
pub use stiffness::{Stiffness, StiffnessKeys};
