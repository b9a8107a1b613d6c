//! A test double in place of the mechanics.

use super::*;

/// A driven pendulum that chooses its own steps. The loss of a single bit of its state grows.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Pendulum {
    time: f64,
    angle: f64,
    velocity: f64,
    /// Time from which on steps find no solution.
    pub(super) fails_at: Option<f64>,
    /// Duration of every step.
    pub(super) pause: Duration,
}

impl Pendulum {
    pub(super) fn new() -> Self {
        Self {
            time: 0.0,
            angle: 2.0,
            velocity: 0.0,
            fails_at: None,
            pause: Duration::ZERO,
        }
    }
}

impl Advance for Pendulum {
    type State = Self;

    fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError> {
        if self.fails_at.is_some_and(|time| self.time >= time) {
            return Err(SimulationError::NoConvergence {
                time: self.time,
                step: 1e-9,
                residual: 1.0,
                term: "bending",
                rod: "pendulum".into(),
                node: 1,
            });
        }
        let chosen = 0.02 + 0.01 * self.angle.sin();
        let step = if self.time + chosen < until {
            chosen
        } else {
            until - self.time
        };
        self.time = if self.time + chosen < until {
            self.time + chosen
        } else {
            until
        };
        self.velocity += step * (1.5 * (2.0 / 3.0 * self.time).cos() - 9.81 * self.angle.sin());
        self.angle += step * self.velocity;
        Ok(StepReport {
            time: self.time,
            step,
            newton_iterations: 2 + (self.angle > 0.0) as usize,
            contacts: (self.angle < 0.0) as usize,
            retries: 0,
            fluid_iterations: 1,
            ..StepReport::default()
        })
    }

    fn advance_while(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        std::thread::sleep(self.pause);
        let report = self.advance(until)?;
        // A step that is stopped midway changes the state.
        Ok(goes_on().then_some(report))
    }

    fn path(&self, _: PathPlan) -> Result<Tracer, SimulationError> {
        unreachable!("a pendulum is not asked for paths")
    }

    fn next_point(&mut self, _: &mut Tracer) -> Result<Option<PathPoint>, SimulationError> {
        unreachable!("a pendulum has no path")
    }

    fn find_equilibrium(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        self.angle = 0.0;
        Ok(goes_on().then(|| StepReport {
            newton_iterations: 7,
            ..StepReport::default()
        }))
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn energies(&self) -> Energies {
        let (kinetic, gravitational) = (self.velocity.powi(2) / 2.0, -9.81 * self.angle.cos());
        Energies {
            kinetic,
            gravitational,
            ..Energies::default()
        }
    }

    fn nearest(&self) -> Option<Proximity> {
        (self.angle <= 1.0).then_some(Proximity {
            pair: ContactPair::Edges([0, 1]),
            distance: 2.0 + self.angle,
            threshold: 1.0,
        })
    }

    fn mean_gap(&self) -> Option<f64> {
        None
    }

    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    fn frame(&self, with_forces: bool) -> Frame {
        let bob = Vector3::new(self.angle.sin(), 0.0, -self.angle.cos());
        let velocities = if with_forces {
            vec![Vector3::zeros(), self.velocity * bob]
        } else {
            vec![]
        };
        Frame {
            time: self.time,
            positions: vec![Vector3::zeros(), bob],
            edge_angles: vec![self.angle, 0.0],
            velocities,
            ..Frame::default()
        }
    }

    fn simulation(&self) -> Option<&Simulation> {
        None
    }

    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        None
    }

    fn as_start(&self) -> Option<Start> {
        None
    }

    fn state(&self) -> Self {
        self.clone()
    }

    fn restore(&mut self, state: Self) -> Result<(), SimulationError> {
        *self = Self {
            fails_at: self.fails_at,
            ..state
        };
        Ok(())
    }
}
