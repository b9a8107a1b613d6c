//! Optimal grasps at many points of (l̄_s, κ̄, 1/k̄_s): samples for a network (thesis 5.3.4).

mod figure;
mod files;
mod hanging_rod;
mod keys;
mod kind;
mod row;
mod samples;

pub use kind::GRASP_SAMPLES;
