//! Equilibria: Newton without inertia.
