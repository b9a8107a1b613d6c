//! Experiments: a scenario becomes a scene, is run, and gives an outcome.
