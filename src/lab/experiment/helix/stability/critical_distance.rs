//! The loss of stability along one direction.

use super::discrete_rod::{DiscreteRod, END, deviation};
use super::keys::{HelixSearch, HelixStability};
use rodlab_engine::mechanics::SceneError;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use rodlab_engine::mechanics::kirchhoff::numerics::find_zero;
use rodlab_engine::mechanics::kirchhoff::{CriticalDistance, Helix};

/// Twisting over bending stiffness at Poisson's ratio 1/2. Stability does not depend on it.
const STIFFNESS_RATIO: f64 = 1.0 / 1.5;
/// Step along a direction without a guess. Stability is not regained farther out, so a step that is
/// too long does no harm unless Newton's method fails.
const STEP: f64 = 2.0;
/// Half-width of the first bracket about a guess, as a fraction of the guess, over the square of
/// the angle by which the rod turns from edge to edge: the guess is that of a coarser mesh.
const NEAR: f64 = 0.25;
/// Growth of the steps away from the guess while the sign of the stiffness does not change.
const GROWTH: f64 = 4.0;
/// Fractions of the distance to a place where Newton's method fails, at which the search tries
/// again.
const ELSEWHERE: [f64; 6] = [0.97, 0.9, 0.75, 0.5, 0.3, 0.1];
/// Step along a path, on which each equilibrium is found from the last one. Longer steps may leave
/// the branch.
const PATH_STEP: f64 = 0.2;
/// Newton's method may leave an unstable helix and find an equilibrium of another shape.
const NO_HELIX: SceneError =
    SceneError::Unsuitable("the equilibrium that was found is not a helix");
/// The search received a request to stop.
const STOPPED: SceneError = SceneError::Unsuitable("the search was stopped");
/// Largest distance of a node from the helix, over its radius, at which the rod still counts as
/// this helix. The mesh alone causes 1e-3 with 100 edges.
const LEFT: f64 = 0.1;
/// Limit of this distance over the length of the rod, for nearly straight helices, whose distance
/// over the radius may be larger because of the mesh. Equilibria of other shapes are as far away
/// as they are from the straight rod.
const LEFT_STRAIGHT: f64 = 1e-3;
/// Limit of this distance over the length, for a rod along a path: it leaves the helix smoothly.
const LEFT_PATH: f64 = 1e-3;
/// Round-off, over the length.
const ROUND_OFF: f64 = 1e-6;
/// A path ends when the step is this short, as a fraction of the distance. Near the loss of
/// stability Newton's method converges slowly, which causes an error of about the same size.
const PATH_PRECISION: f64 = 1e-6;
/// The search ends when the bracket is this narrow, as a fraction of the distance. The error is of
/// the order of its square. In a narrower one, where the Hessian is nearly singular, Newton's
/// method fails.
const PRECISION: f64 = 1e-6;

/// Distance at which a helical rod with `edges` edges along the direction of `helix` loses
/// stability. `None` if it is stable up to a distance of `edges`/2, beyond which the mesh is too
/// coarse.
///
/// # Errors
/// [`SimulationError::NoConvergence`] if no equilibrium is found next to the helix.
pub fn discrete_critical_distance(
    helix: &Helix,
    edges: usize,
) -> Result<Option<f64>, SimulationError> {
    let rod = DiscreteRod {
        edges,
        stiffness_ratio: STIFFNESS_RATIO,
        bending_stiffness: 1.0,
    };
    let largest = HelixStability::LARGEST_TURN * edges as f64;
    rod.critical_distance(helix, HelixSearch::Fast, largest, None, &|| true)
}

/// The critical distance with an estimate of its error. The error of the mesh falls with the
/// square of the edge length, so it is 4/3 of the difference from a mesh twice as fine.
///
/// # Errors
/// See [`discrete_critical_distance`].
pub fn estimated_critical_distance(
    helix: &Helix,
    edges: usize,
) -> Result<Option<CriticalDistance>, SimulationError> {
    let Some(distance) = discrete_critical_distance(helix, edges)? else {
        return Ok(None);
    };
    let finer = discrete_critical_distance(helix, 2 * edges)?;
    Ok(finer.map(|finer| CriticalDistance {
        distance,
        error_estimate: 4.0 / 3.0 * (finer - distance).abs(),
    }))
}

impl DiscreteRod {
    /// Distance at which the rod loses stability along the direction of `helix`; `None` if it is
    /// stable up to `largest`. A good `guess`, for example from a coarser mesh, saves a third of
    /// the time of the fast search.
    ///
    /// # Errors
    /// [`SimulationError::NoConvergence`] if no equilibrium is found; also an error if `goes_on`
    /// returns false.
    pub fn critical_distance(
        &self,
        helix: &Helix,
        search: HelixSearch,
        largest: f64,
        guess: Option<f64>,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<f64>, SimulationError> {
        let direction = helix.scaled(1.0 / helix.distance());
        match search {
            HelixSearch::Fast => self.at_once(&direction, largest, guess, goes_on),
            HelixSearch::Path => self.along_path(&direction, largest, goes_on),
        }
    }

    /// Finds each equilibrium from the helix itself, and the distance at which its stiffness is zero.
    fn at_once(
        &self,
        direction: &Helix,
        largest: f64,
        guess: Option<f64>,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<f64>, SimulationError> {
        let stiffness =
            |before, distance| self.helix_stiffness(direction, before, distance, goes_on);
        let mut step = guess.map_or(STEP, |guess| {
            2.0 * (NEAR * (guess / self.edges as f64).powi(2)).max(PRECISION) * guess
        });
        let growth = guess.map_or(1.0, |_| GROWTH);
        let first = guess.map_or(STEP, |guess| guess - 0.5 * step).min(largest);
        let mut newest = stiffness(0.0, first)?;
        let is_stable = newest.1 > 0.0;
        let bracket = loop {
            let before = newest;
            if is_stable && before.0 == largest {
                return Ok(None);
            }
            // Inwards, at most half the way to the straight rod, which is stable.
            let next = if is_stable {
                (before.0 + step).min(largest)
            } else {
                (before.0 - step).max(0.5 * before.0)
            };
            newest = stiffness(before.0, next)?;
            if (newest.1 > 0.0) != is_stable {
                let [stable, lost] = if is_stable {
                    [before, newest]
                } else {
                    [newest, before]
                };
                break [stable, lost];
            }
            step *= growth;
        };
        Ok(Some(find_zero(bracket, PRECISION, stiffness)?))
    }

    /// Stiffness of the helix at `distance`, positive where it is stable. Where the Hessian is
    /// nearly singular, Newton's method may fail or leave the helix; then a place between `before`
    /// and `distance` is tested instead. Also returns the tested place.
    fn helix_stiffness(
        &self,
        direction: &Helix,
        before: f64,
        distance: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<(f64, f64), SimulationError> {
        let judge = |distance: f64| {
            if !goes_on() {
                return Err(STOPPED.into());
            }
            let helix = direction.scaled(distance);
            let scene = self.on_helix(&helix);
            let mut simulation = Simulation::new(&scene, &IntegrationParameters::default())?;
            let stiffness = simulation.find_nearby_stiffness()?;
            if deviation(&simulation, &helix, 1.0) > farthest(&helix) {
                return Err(NO_HELIX.into());
            }
            Ok((distance, stiffness))
        };
        let mut found = judge(distance);
        for part in ELSEWHERE {
            if found.is_ok() {
                break;
            }
            found = judge(before + part * (distance - before));
        }
        found
    }

    /// Finds each equilibrium from the previous one, as the end of the rod moves. The step is
    /// halved if the next equilibrium is unstable, is not found, or is not a helix. Past a
    /// supercritical pitchfork the rod is stable, and leaves the helix with the square root of the
    /// distance.
    fn along_path(
        &self,
        direction: &Helix,
        largest: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<f64>, SimulationError> {
        let mut simulation = Simulation::new(&self.straight(), &IntegrationParameters::default())?;
        let mut state = simulation.state();
        let (mut stable, mut step) = (0.0, PATH_STEP);
        while stable < largest {
            if !goes_on() {
                return Err(STOPPED.into());
            }
            let distance = (stable + step).min(largest);
            let helix = direction.scaled(distance);
            simulation.move_clamp(END, self.end_on_helix(&helix));
            let found = simulation.find_nearby_equilibrium();
            let largest = LEFT_PATH.min(farthest(&helix));
            let left = deviation(&simulation, &helix, self.enlargement(&helix)) > largest;
            if matches!(found, Ok(0)) && !left {
                stable = distance;
                state = simulation.state();
                continue;
            }
            if step <= PATH_PRECISION * distance {
                return Ok(Some(stable + 0.5 * step));
            }
            step *= 0.5;
            simulation.restore(state.clone())?;
        }
        Ok(None)
    }
}

/// Largest distance of a node from a helix, over the length, at which the rod still counts as this
/// helix.
fn farthest(helix: &Helix) -> f64 {
    let radius = helix.radius();
    radius.min(LEFT_STRAIGHT).max(LEFT * radius) + ROUND_OFF
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::kirchhoff::critical_distance;

    fn helix(curvature: f64, torsion: f64, twisting_moment: f64) -> Helix {
        Helix {
            curvature,
            torsion,
            twisting_moment,
        }
    }

    #[test]
    fn the_distance_converges_to_the_theory_with_the_square_of_the_edge_length() {
        for direction in [
            helix(1.0, 1.0, 1.0),
            helix(1.0, 1.0, -1.0),
            helix(0.594, 0.698, 0.4),
            helix(0.0, 1.0, 0.0),
            helix(0.0, 0.0, 1.0),
        ] {
            let expected = critical_distance(&direction).unwrap().distance;
            let error = |edges| {
                let found = discrete_critical_distance(&direction, edges).unwrap();
                found.unwrap() / expected - 1.0
            };
            let [coarse, fine] = [40, 80].map(error);
            assert!(fine.abs() < 2e-3, "{direction:?}: {fine:e}");
            let order = (coarse / fine).log2();
            assert!((order - 2.0).abs() < 0.1, "{direction:?}: order {order}");
        }
    }

    /// A rod bent to a full circle rotates freely about its tangent at the clamps, on any mesh.
    #[test]
    fn the_planar_ring_is_exact() {
        let found = discrete_critical_distance(&helix(1.0, 0.0, 0.0), 20).unwrap();
        assert!((found.unwrap() - std::f64::consts::TAU).abs() < 1e-7);
    }

    #[test]
    fn the_error_estimate_is_that_of_the_mesh() {
        let direction = helix(1.0, 1.0, -1.0);
        let expected = critical_distance(&direction).unwrap().distance;
        let found = estimated_critical_distance(&direction, 40)
            .unwrap()
            .unwrap();
        let error = (found.distance - expected).abs();
        assert!((found.error_estimate / error - 1.0).abs() < 0.05);
    }

    #[test]
    fn the_path_from_the_straight_rod_leads_to_the_same_boundary() {
        let rod = DiscreteRod {
            edges: 100,
            stiffness_ratio: STIFFNESS_RATIO,
            bending_stiffness: 1.0,
        };
        for direction in [
            helix(1.0, 1.0, 1.0),
            helix(1.0, 1.0, -1.0),
            helix(0.594, 0.698, 0.4),
            helix(0.2, -1.0, 0.3),
            helix(0.0, 1.0, 0.0),
            helix(0.0, 0.0, 1.0),
        ] {
            let [fast, path] = [HelixSearch::Fast, HelixSearch::Path].map(|search| {
                rod.critical_distance(&direction, search, 20.0, None, &|| true)
                    .unwrap()
                    .unwrap()
            });
            assert!(
                (path / fast - 1.0).abs() < 2e-5,
                "{direction:?}: {fast}, {path}"
            );
        }
    }

    #[test]
    fn a_pulled_straight_rod_stays_stable() {
        let found = discrete_critical_distance(&helix(0.0, 1.0, 2.0), 40).unwrap();
        assert_eq!(found, None);
    }
}
