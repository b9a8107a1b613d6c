//! Planar chains of rigid links by an explicit method, independent of the discrete rods.

use nalgebra::Vector2;

/// Largest product of the time step and the frequency of the fastest bending wave; the method is
/// stable up to 2.8.
const STEP_TIMES_FREQUENCY: f64 = 2.0;

/// A rod of unit mass per length that does not stretch, in a plane, as a chain of rigid links of
/// length h with masses at their ends (h, and h/2 at both ends of the chain) and springs of the
/// stiffness EI/h at the inner masses:
///
/// ```text
/// mᵢ aᵢ = fᵢ + λᵢ dᵢ − λᵢ₋₁ dᵢ₋₁,   dᵢ = xᵢ₊₁ − xᵢ,   dᵢ·ḋᵢ' + |ḋᵢ|² = 0 with ḋᵢ' = aᵢ₊₁ − aᵢ
/// ```
///
/// The multipliers λ follow from a tridiagonal system. The motion is that of the rod to second
/// order in h.
pub(super) struct Links {
    /// EI.
    pub bending: f64,
    /// Length.
    pub length: f64,
    /// Start, and direction from it.
    pub start: [Vector2<f64>; 2],
    /// Whether the start stays at its place.
    pub is_hinged: bool,
    /// Acceleration of gravity.
    pub gravity: Vector2<f64>,
    /// Force on the start and moment on the first link over time.
    pub load: fn(f64) -> (Vector2<f64>, f64),
}

/// Positions and velocities.
#[derive(Clone)]
struct State {
    positions: Vec<Vector2<f64>>,
    velocities: Vec<Vector2<f64>>,
}

impl Links {
    /// Returns the positions of both ends at the given time, extrapolated from chains of
    /// `links` and twice as many links.
    pub fn ends(&self, time: f64, links: usize) -> [Vector2<f64>; 2] {
        let [coarse, fine] = [links, 2 * links].map(|links| {
            let end = self.moved(time, links).positions;
            [end[0], end[links]]
        });
        std::array::from_fn(|end| (4.0 * fine[end] - coarse[end]) / 3.0)
    }

    /// Moves a chain at rest for some time by the Runge–Kutta method of fourth order.
    fn moved(&self, end: f64, links: usize) -> State {
        let h = self.length / links as f64;
        let [origin, direction] = self.start;
        let place = |k: usize| origin + direction * (k as f64 * h);
        let mut state = State {
            positions: (0..=links).map(place).collect(),
            velocities: vec![Vector2::zeros(); links + 1],
        };
        let fastest = 4.0 * self.bending.sqrt() / (h * h);
        let steps = (end * fastest / STEP_TIMES_FREQUENCY).ceil();
        let step = end / steps;
        for k in 0..steps as usize {
            let time = k as f64 * step;
            let first = self.rates(time, &state);
            let second = self.rates(time + 0.5 * step, &state.after(&first, 0.5 * step));
            let third = self.rates(time + 0.5 * step, &state.after(&second, 0.5 * step));
            let fourth = self.rates(time + step, &state.after(&third, step));
            for (rates, part) in [(first, 1.0), (second, 2.0), (third, 2.0), (fourth, 1.0)] {
                state = state.after(&rates, step * part / 6.0);
            }
        }
        state
    }

    /// Velocities and accelerations, as the rates of a state.
    fn rates(&self, time: f64, state: &State) -> State {
        let links = state.positions.len() - 1;
        let h = self.length / links as f64;
        let mut masses = vec![h; links + 1];
        (masses[0], masses[links]) = (0.5 * h, 0.5 * h);
        let mut forces: Vec<Vector2<f64>> = masses.iter().map(|m| self.gravity * *m).collect();
        let difference = |of: &[Vector2<f64>]| -> Vec<Vector2<f64>> {
            of.windows(2).map(|w| w[1] - w[0]).collect()
        };
        let (along, apart) = (difference(&state.positions), difference(&state.velocities));
        // A moment on a link is a pair of forces across it.
        let mut turn = |link: usize, moment: f64| {
            let across = Vector2::new(-along[link].y, along[link].x) * (moment / (h * h));
            forces[link] -= across;
            forces[link + 1] += across;
        };
        for inner in 1..links {
            let [before, after] = [along[inner - 1], along[inner]];
            let angle = libm::atan2(before.perp(&after), before.dot(&after));
            let moment = self.bending * angle / h;
            turn(inner - 1, moment);
            turn(inner, -moment);
        }
        let (force, moment) = (self.load)(time);
        turn(0, moment);
        forces[0] += force;
        let mut inverse: Vec<f64> = masses.iter().map(|mass| 1.0 / mass).collect();
        if self.is_hinged {
            inverse[0] = 0.0;
        }
        let free: Vec<Vector2<f64>> = forces.iter().zip(&inverse).map(|(f, w)| f * *w).collect();
        let pulls = tensions(&along, &apart, &free, &inverse);
        let mut accelerations = free;
        for link in 0..links {
            let pull = pulls[link] * along[link];
            accelerations[link] += pull * inverse[link];
            accelerations[link + 1] -= pull * inverse[link + 1];
        }
        State {
            positions: state.velocities.clone(),
            velocities: accelerations,
        }
    }
}

/// The multipliers λ that keep the lengths of the links, by elimination without pivoting.
fn tensions(
    along: &[Vector2<f64>],
    apart: &[Vector2<f64>],
    free: &[Vector2<f64>],
    inverse: &[f64],
) -> Vec<f64> {
    let links = along.len();
    let (mut diagonal, mut right) = (vec![0.0; links], vec![0.0; links]);
    let beside = |link: usize| -inverse[link] * along[link - 1].dot(&along[link]);
    for link in 0..links {
        let own = (inverse[link] + inverse[link + 1]) * along[link].norm_squared();
        let gain = along[link].dot(&(free[link + 1] - free[link])) + apart[link].norm_squared();
        (diagonal[link], right[link]) = (own, gain);
        if link > 0 {
            let factor = beside(link) / diagonal[link - 1];
            diagonal[link] -= factor * beside(link);
            right[link] -= factor * right[link - 1];
        }
    }
    let mut pulls = vec![0.0; links];
    for link in (0..links).rev() {
        let next = if link + 1 < links {
            beside(link + 1) * pulls[link + 1]
        } else {
            0.0
        };
        pulls[link] = (right[link] - next) / diagonal[link];
    }
    pulls
}

impl State {
    /// The state after some time at constant rates.
    fn after(&self, rates: &Self, time: f64) -> Self {
        let moved = |of: &[Vector2<f64>], rates: &[Vector2<f64>]| {
            of.iter().zip(rates).map(|(x, v)| x + v * time).collect()
        };
        Self {
            positions: moved(&self.positions, &rates.positions),
            velocities: moved(&self.velocities, &rates.velocities),
        }
    }
}
