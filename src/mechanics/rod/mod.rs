//! The discrete elastic rod: topology, frames, strains, energies and their derivatives.
