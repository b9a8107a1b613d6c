//! Scenes in motion: what films and the 3-D page show of a results directory.

mod movie;
mod outline;
mod strip;

pub use movie::{
    Field, Movie, MovieCase, MovieFrame, MovieObstacle, MoviePlane, MovieRod, MovieSeries,
};
pub use strip::Strip;

pub(in crate::figure) use outline::{Outline, centre, outline, placed, room};
