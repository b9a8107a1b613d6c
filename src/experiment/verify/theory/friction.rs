//! Dry friction after Coulomb.

/// Acceleration g (sin α − μ cos α) of a body that slides down an incline of angle α.
pub fn sliding_acceleration(gravity: f64, incline: f64, friction: f64) -> f64 {
    gravity * (incline.sin() - friction * incline.cos())
}

/// Greater tension of a rope that is about to slide around a post by the wrap angle φ:
/// (T₂ − EI/2ρ²) = (T₁ − EI/2ρ²) exp(μ φ), where ρ is the radius of the rope's centreline
/// (the capstan equation with bending stiffness: on the post the curvature is 1/ρ, and
/// T + EI κ²/2 is what balances contact; Stuart 1961).
pub fn capstan_tension(
    lesser_tension: f64,
    friction: f64,
    wrap_angle: f64,
    bending_stiffness: f64,
    radius: f64,
) -> f64 {
    let bending = bending_stiffness / (2.0 * radius * radius);
    bending + (lesser_tension - bending) * (friction * wrap_angle).exp()
}
