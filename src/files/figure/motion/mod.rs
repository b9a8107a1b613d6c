//! Scenes in motion, for films and the 3-D page of a results directory.

mod movie;
mod outline;
mod strip;

pub use movie::{
    Field, Movie, MovieCase, MovieFrame, MovieObstacle, MoviePlane, MovieRod, MovieSeries,
};
pub use strip::Strip;

pub(in crate::figure) use strip::{square_to, tangent, turned};

pub(in crate::figure) use outline::{Outline, centre, outline, placed, room};
