//! Helical rods (thesis 6): where they lose stability, and how they are manipulated.

pub mod manipulation;
pub mod stability;
