//! Smoothed laws of a single contact: a path along which Newton's method finds the solution when
//! it would otherwise cycle.
//!
//! With a width ν (N), the half line and the disk of [`RigidContact`] become
//!
//! ```text
//! λ_n ρ w_n = ν²,   ρ w_t = −2 ν² λ_t/(μ² λ_n² − ‖λ_t‖²),
//! ```
//!
//! which for ν = 0 are the laws of Signorini and Coulomb: they have logarithmic barriers at both
//! surfaces, as in interior point methods. Solved for the force that belongs to λ − ρ w, the first
//! is Chen, Harker, Kanzow and Smale's function ½ (z + √(z² + 4ν²)). A contact between pressing
//! and open yields like its inertia at any force, so that there are no states among which to
//! cycle.

use super::{RigidContact, SHUT, State};
use crate::mechanics::{Matrix3, Vector3};

/// ρ of these laws in units of that of the contact points alone: other contacts stiffen them.
const STIFFENED: f64 = 4.0;
/// Radius of the disk, in units of ν, below which there is no friction.
const LEAST_DISK: f64 = 1e-6;
/// Maximum number of iterations for friction on the disk, which mostly takes three or four.
const RESOLVING_ITERATIONS: usize = 60;
/// Change, as a fraction of the disk, at which these iterations end.
const RESOLVED_CHANGE: f64 = 1e-12;

/// Forces of the smoothed laws.
struct Smoothed {
    pressure: f64,
    /// Friction along `direction`; below, the fraction of μ λ_n that friction leaves unused.
    rest: f64,
    direction: Vector3,
}

impl RigidContact {
    /// The smoothed laws of width ν (N), linearised where they hold near the last motion.
    pub(super) fn smooth(&mut self, width: f64) -> State {
        let found = self.resolve(width);
        let Smoothed {
            pressure,
            rest,
            direction,
        } = found;
        let part = 1.0 - rest;
        let (inertia, shut) = (STIFFENED * self.inertia, SHUT * self.inertia);
        self.projected = self.normal * pressure + direction * (self.friction * pressure * part);
        let pressing = (inertia * (pressure / width).powi(2)).min(shut);
        let gap = width * width / (inertia * pressure);
        let mut apart = self.normal * gap;
        let mut stiffness = self.normal * self.normal.transpose() * pressing;
        let disk = self.friction * pressure;
        // Friction of a contact with a force far below ν vanishes.
        if disk > LEAST_DISK * width {
            let room = rest * (2.0 - rest);
            let softness = 2.0 * (width / disk).powi(2) / (inertia * room);
            apart -= direction * (softness * disk * part);
            let across = (1.0 / softness).min(shut);
            let along = (room / (softness * (1.0 + part * part))).min(shut);
            let follows = 2.0 * part / (1.0 + part * part);
            let sideways = Matrix3::identity() - self.normal * self.normal.transpose();
            let own = direction * direction.transpose();
            stiffness += (sideways - own) * across
                + own * along
                + direction * self.normal.transpose() * (self.friction * follows * pressing);
        }
        State {
            force: self.projected + stiffness * (apart - self.start),
            stiffness,
        }
    }

    /// Violation of the smoothed laws by λ, w, N.
    pub(super) fn smoothed_violation(&self, width: f64) -> f64 {
        let Smoothed {
            pressure,
            rest,
            direction,
        } = self.resolve(width);
        let friction = self.friction * pressure * (1.0 - rest);
        let resolved = self.normal * pressure + direction * friction;
        (resolved - self.wanted).norm()
    }

    /// The forces that belong to λ − ρ w.
    fn resolve(&self, width: f64) -> Smoothed {
        let towards = self.wanted - self.apart * (STIFFENED * self.inertia);
        let along = self.normal.dot(&towards);
        let root = libm::hypot(along, 2.0 * width);
        let pressure = if along > 0.0 {
            0.5 * (along + root)
        } else {
            2.0 * width * width / (root - along)
        };
        let sideways = towards - self.normal * along;
        let (size, disk) = (sideways.norm(), self.friction * pressure);
        if size == 0.0 || disk == 0.0 {
            return Smoothed {
                pressure,
                rest: 1.0,
                direction: Vector3::zeros(),
            };
        }
        Smoothed {
            pressure,
            rest: rest_of_disk(size / disk, 2.0 * (width / disk).powi(2)),
            direction: sideways / size,
        }
    }
}

/// Solves x + a x/(1 − x²) = `size` for y = 1 − x from 0 to 1, with a = `width`. Newton's method is
/// used in y, since x may be too close to 1 to leave digits of y; bisection replaces an iterate
/// outside the bracket.
fn rest_of_disk(size: f64, width: f64) -> f64 {
    let over = size - 1.0;
    let root = libm::hypot(over, (2.0 * width).sqrt());
    // Where the cube of y vanishes.
    let start = if over > 0.0 {
        width / (over + root)
    } else {
        0.5 * (root - over)
    };
    let (mut low, mut high, mut rest) = (0.0, 1.0, start.min(1.0));
    for _ in 0..RESOLVING_ITERATIONS {
        let room = rest * (2.0 - rest);
        let excess = width * (1.0 - rest) - (over + rest) * room;
        if excess > 0.0 {
            low = rest;
        } else {
            high = rest;
        }
        let slope = -width - room - (over + rest) * 2.0 * (1.0 - rest);
        let next = rest - excess / slope;
        let next = if low < next && next < high {
            next
        } else {
            0.5 * (low + high)
        };
        let change = next - rest;
        rest = next;
        if change.abs() <= RESOLVED_CHANGE * rest {
            break;
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::uniform_numbers;

    /// Contacts that press, gape and slide by forces of decades.
    fn contacts() -> Vec<RigidContact> {
        let mut number = uniform_numbers(5);
        let mut symmetric = || 2.0 * number() - 1.0;
        let mut vector = || Vector3::from_fn(|_, _| symmetric());
        (0..200)
            .map(|k| {
                let size = 10f64.powi(k % 5 - 2);
                let (normal, inertia) = (vector().normalize(), 30.0);
                let mut contact = RigidContact::beginning_with(
                    normal,
                    0.4,
                    vector() * (size / inertia),
                    inertia,
                    vector() * size,
                );
                contact.apart = contact.start;
                contact
            })
            .collect()
    }

    #[test]
    fn the_linear_law_touches_the_smoothed_one() {
        let mut direction = uniform_numbers(9);
        for width in [1e-3, 0.1, 1.0] {
            for mut contact in contacts() {
                let stiffened = STIFFENED * contact.inertia;
                let towards = contact.wanted - contact.apart * stiffened;
                let law = contact.smooth(width);
                let (force, size) = (contact.projected, contact.projected.norm());
                // Solution of the smoothed laws; from there the contact points move by the amount
                // by which they yield.
                let holds = (force - towards) / stiffened - contact.start;
                let far = size / law.stiffness.norm();
                let by = Vector3::from_fn(|_, _| direction() - 0.5) * far;
                let errors = [0.0, 1e-2, 1e-3].map(|part| {
                    contact.follow(&law, &(holds + by * part));
                    contact.smoothed_violation(width) / size
                });
                // To second order, except for closed contacts, which yield a little.
                assert!(errors[0] < 1e-9, "{width}: {errors:?}");
                assert!(errors[1] < 1e-2, "{width}: {errors:?}");
                assert!(errors[2] < 2e-2 * errors[1] + 1e-7, "{width}: {errors:?}");
            }
        }
    }

    #[test]
    fn narrow_laws_are_those_of_signorini_and_coulomb() {
        for mut contact in contacts() {
            contact.smooth(1e-9);
            let towards = contact.wanted - contact.apart * (STIFFENED * contact.inertia);
            let pressure = contact.normal.dot(&towards).max(0.0);
            let sideways = towards - contact.normal * contact.normal.dot(&towards);
            let expected = contact.normal * pressure
                + crate::mechanics::contact::cut(sideways, contact.friction * pressure);
            assert!((contact.projected - expected).norm() < 1e-7);
        }
    }

    #[test]
    fn friction_on_the_disk_is_found_over_decades() {
        for size in [1e-6, 0.3, 1.0, 1.0 + 1e-9, 2.0, 1e6] {
            for width in [1e-18, 1e-12, 1e-6, 1.0, 1e6] {
                let rest = rest_of_disk(size, width);
                let force = (1.0 - rest) * (1.0 + width / (rest * (2.0 - rest)));
                let error = (force / size - 1.0).abs();
                // Where friction uses hardly any of the disk, rounding matters.
                let rounding = 2e-12 / (1.0 - rest);
                assert!(error < 1e-9 + rounding, "{size} {width}: {rest} {error}");
            }
        }
    }
}
