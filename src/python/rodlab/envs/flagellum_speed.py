"""Swim by turning the head of a helical flagellum, or by bending it."""

from typing import Any, Literal

import numpy as np

from .. import _rodlab
from .base import RodEnv, spread
from .gripper import Array, Gripper
from .parameters import Range
from .raster import GRIPPER, ROD, TARGET, Canvas

EDGES = 36
SEEN = 13
SPIN = 20.0
ACCELERATION = 100.0
STEERING = 1.0
BENDS = 4
CURVATURE = 20.0
BENDING_RATE = 100.0


class FlagellumSpeed(RodEnv):
    """Turn the head of a helical flagellum in a viscous fluid so that it swims in a given direction.

    The frame of the head is driven, as by a magnet; its position is free, so that no force acts on the swimmer. The helix
    extends from the head along -z at the start; the axis is the direction from the tail to the head. A control step is 50 ms;
    an episode has 100 of them.

    Observation (93, and 101 with `control="curvature"`)
        Positions of 13 nodes relative to the head, over the length of the helix (39); their velocities over
        U₀ = 0.1 R Ω with the radius R of the helix and Ω = 20 rad/s (39); axis and director d₁ of the head (6); rate of
        rotation over Ω (1); moment on the head over M₀ = 4π η Ω R² ℓ, with the viscosity η and the length ℓ of the rod
        (3); direction to swim in (3); cosine between this direction and the axis (1); speed in this direction over U₀ (1).
        With `control="curvature"` also the natural curvatures that are added, over 20 1/m (8).

    Action (3, and 11 with `control="curvature"`), from -1 to 1
        Target rate of rotation about the axis, times Ω; the rate follows with at most 100 rad/s² (1). Rates at which the axis
        turns about x and y, times 1 rad/s (2). With `control="curvature"` also the natural curvatures κ₁ and κ₂ about the
        material directors that are wanted in addition to those of the helix, times 20 1/m, at 4 places evenly spread from
        head to tail (8); between the places they are linear, and they follow with at most 100 1/m each second.

    Reward
        U/U₀ - 0.1 |P|/(M₀ Ω) - 0.01 |action|², with the mean speed U of the nodes in the wanted direction and the power P
        of the head's moment; -10 for a step that fails.

    Termination
        Failure only: the engine raises. Success is never reported; the episode is truncated at its horizon.

    Randomised parameters
        ================  ===================  ===============================================
        name              range                meaning
        ================  ===================  ===============================================
        helix_radius      6 to 9 mm            radius R of the helix
        pitch             30 to 50 mm          pitch
        turns             2 to 3               number of turns
        youngs_modulus    1 to 5 MPa           Young's modulus; the rod's radius is 1 mm
        viscosity         0.5 to 2 Pa s        viscosity η of the fluid
        target_polar      0 to 1 rad           angle of the wanted direction from z
        target_azimuth    -π to π rad          its angle about z
        ================  ===================  ===============================================

    Parameters
    ----------
    render_mode : {None, "rgb_array"}
    horizon : int, optional
        Control steps in an episode, by default 100.
    fluid : {"rss", "resistive"}
        Regularised Stokeslet segments, or resistive force theory, which takes a tenth of the time.
    control : {"head", "curvature"}
        What the action drives: the head, or the head and the curvature of an active filament.

    Notes
    -----
    The moment on the head is measured, so this environment is not stepped by `rodlab.Batch`.
    """

    ranges = {
        "helix_radius": Range(0.006, 0.009, "m"),
        "pitch": Range(0.03, 0.05, "m"),
        "turns": Range(2.0, 3.0),
        "youngs_modulus": Range(1e6, 5e6, "Pa", logarithmic=True),
        "viscosity": Range(0.5, 2.0, "Pa s", logarithmic=True),
        "target_polar": Range(0.0, 1.0, "rad"),
        "target_azimuth": Range(-np.pi, np.pi, "rad"),
    }
    period = 0.05
    substep = 0.005
    default_horizon = 100
    batched = False

    def __init__(
        self,
        render_mode: str | None = None,
        horizon: int | None = None,
        fluid: Literal["rss", "resistive"] = "rss",
        control: Literal["head", "curvature"] = "head",
    ) -> None:
        if fluid not in ("rss", "resistive"):
            raise ValueError(f'fluid is {fluid!r}; it can be "rss" or "resistive"')
        if control not in ("head", "curvature"):
            raise ValueError(f'control is {control!r}; it can be "head" or "curvature"')
        super().__init__(render_mode, horizon)
        self.bends = control == "curvature"
        added = 2 * BENDS if self.bends else 0
        self._set_spaces(3 + added, 6 * SEEN + 15 + added)
        self.fluid = fluid
        self.control = control
        self.curvatures = np.zeros((BENDS if self.bends else 0, 2))
        self._seen = spread(EDGES + 1, SEEN)
        self.target = np.array([0.0, 0.0, 1.0])
        self.moment = np.zeros(3)
        self.spin = 0.0
        self.speed = 0.0

    def _scenario(self) -> dict[str, Any]:
        values = self.parameters
        polar, azimuth = values["target_polar"], values["target_azimuth"]
        self.target = np.array(
            [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
        )
        radius = values["helix_radius"]
        helix = {
            "kind": "helix",
            "start": [radius, 0.0, 0.0],
            "axis": [0.0, 0.0, -1.0],
            "radius": radius,
            "pitch": values["pitch"],
            "turns": values["turns"],
        }
        return {
            "experiment": "scene",
            "material": {"youngs_modulus": values["youngs_modulus"], "poissons_ratio": 0.5, "density": 1000.0},
            "rods": [{"name": "flagellum", "radius": 1e-3, "edges": EDGES, "shape": helix}],
            "clamps": [{"rod": "flagellum", "at": "start", "hold": "frame"}],
            "fluid": {"model": self.fluid, "viscosity": values["viscosity"]},
            "time": {
                "scheme": "backward-differences",
                "step": self.substep,
                "end": self.horizon * self.period,
            },
        }

    def _begin(self, simulation: _rodlab.Simulation) -> None:
        pose = np.array(simulation.clamp_pose(0))
        far = np.full(3, np.inf)
        self.gripper = Gripper(0, pose, -far, far)
        self._axis = pose[:3, :3].T @ np.array([0.0, 0.0, 1.0])
        self.spin = 0.0
        self.speed = 0.0
        self.curvatures = np.zeros_like(self.curvatures)
        self._centre = np.array(simulation.positions).mean(axis=0)
        values = self.parameters
        turn = np.hypot(2.0 * np.pi * values["helix_radius"], values["pitch"])
        self._length = values["turns"] * values["pitch"]
        self._speed = 0.1 * values["helix_radius"] * SPIN
        arc = values["turns"] * turn
        self._moment = 4.0 * np.pi * values["viscosity"] * SPIN * values["helix_radius"] ** 2 * arc

    def _head(self) -> Array:
        """Return the axis of the head."""
        return np.asarray(self.gripper.pose[:3, :3] @ self._axis)

    def _act(self, action: Array) -> dict[int, Array]:
        most = ACCELERATION * self.period
        self.spin += float(np.clip(SPIN * action[0] - self.spin, -most, most))
        axis = self._head()
        steering = STEERING * np.array([action[1], action[2], 0.0])
        steering -= axis * (axis @ steering)
        rate = self.spin * axis + steering
        change = CURVATURE * action[3:].reshape(self.curvatures.shape) - self.curvatures
        largest = BENDING_RATE * self.period
        self.curvatures = self.curvatures + np.clip(change, -largest, largest)
        return {0: self.gripper.move(np.zeros(3), rate, self.period)}

    def _actuate(self, simulation: _rodlab.Simulation) -> None:
        if not self.bends:
            return
        places = np.linspace(0.0, EDGES, BENDS)
        nodes = np.arange(EDGES + 1)
        bent = [np.interp(nodes, places, column) for column in self.curvatures.T]
        simulation.natural_curvature[:] = np.stack(bent, axis=1)

    def _measure(self, simulation: _rodlab.Simulation) -> None:
        self.moment = np.array(simulation.reaction(0)[3:])

    def _observe(self) -> Array:
        axis = self._head()
        return np.concatenate(
            [
                (self.positions[self._seen] - self.positions[0]).ravel() / self._length,
                self.velocities[self._seen].ravel() / self._speed,
                axis,
                self.gripper.pose[:3, 0],
                [self.spin / SPIN],
                self.moment / self._moment,
                self.target,
                [axis @ self.target, self.speed / self._speed],
                self.curvatures.ravel() / CURVATURE,
            ]
        )

    def _judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        centre = self.positions.mean(axis=0)
        self.speed = float((centre - self._centre) @ self.target) / self.period
        self._centre = centre
        power = float(self.moment @ self._head()) * self.spin
        reward = self.speed / self._speed - 0.1 * abs(power) / (self._moment * SPIN) - 0.01 * float(action @ action)
        return reward, False, {"speed": self.speed, "power": power}

    def _draw(self) -> Canvas:
        middle = self.positions.mean(axis=0)
        canvas = Canvas([1.0, 0.0, 0.0], [0.0, 0.35, 0.937], middle, 2.0 * self._length)
        canvas.line([middle, middle + 0.7 * self._length * self.target], 0.0, TARGET)
        canvas.line(self.positions, 1e-3, ROD)
        canvas.dots(self.positions[0], 0.003, GRIPPER)
        return canvas
