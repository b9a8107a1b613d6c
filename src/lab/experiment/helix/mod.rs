//! Helical rods (thesis 6): their loss of stability, and their manipulation.

pub mod manipulation;
pub mod stability;
