"""An arm that follows trajectories: position servos with limits, and tolerances of path and goal."""

import bisect
import threading
from dataclasses import dataclass, field

from .model import SERVO_TIME

# Farthest that a joint may be from where it should be, rad, and from the last point, for so long after it, s.
PATH_TOLERANCE = 0.3
GOAL_TOLERANCE = 0.01
GOAL_PATIENCE = 2.0

# Codes of control_msgs/FollowJointTrajectoryResult.
SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS, PATH_TOLERANCE_VIOLATED, GOAL_TOLERANCE_VIOLATED = 0, -1, -2, -4, -5


@dataclass
class Motion:
    """A trajectory under way: positions and velocities at times, and how it ends."""

    times: list  # s, from the start
    positions: list
    velocities: list
    begin: float  # s
    ended: threading.Event = field(default_factory=threading.Event)
    code: int = SUCCESSFUL
    words: str = ""

    def at(self, time):
        """Positions and velocities at a time: cubic between the points."""
        time -= self.begin
        after = bisect.bisect_right(self.times, time)
        if after == 0 or after == len(self.times):
            return self.positions[max(after - 1, 0)], [0.0] * len(self.positions[0])
        span = self.times[after] - self.times[after - 1]
        u = (time - self.times[after - 1]) / span
        rows = zip(self.positions[after - 1], self.velocities[after - 1], self.positions[after], self.velocities[after])
        found = [cubic(u, span, *row) for row in rows]
        return [x for x, _ in found], [v for _, v in found]

    def end(self, code, words=""):
        self.code, self.words = code, words
        self.ended.set()


def cubic(u, span, x0, v0, x1, v1):
    """Position and velocity at u from 0 to 1 of the cubic between two points that lie a time span apart."""
    way, a, b = x1 - x0, v0 * span, v1 * span
    x = x0 + a * u + (3 * way - 2 * a - b) * u**2 + (a + b - 2 * way) * u**3
    v = a + 2 * (3 * way - 2 * a - b) * u + 3 * (a + b - 2 * way) * u**2
    return x, v / span


class Arm:
    """Joints of one arm in the simulation."""

    def __init__(self, model, data, chain, place):
        self.data, self.side = data, place.side
        self.joints = [joint for joint in chain if joint.limits]
        self.names = [f"{place.side}_{joint.name}" for joint in self.joints]
        self.places = [model.joint(name).qposadr[0] for name in self.names]
        self.servos = [model.actuator(name).id for name in self.names]
        self.grip = model.site(f"{place.side}_grip").id
        self.hold = model.equality(f"{place.side}_holds").id
        self.motion = None
        for address, servo, position in zip(self.places, self.servos, place.home):
            data.qpos[address] = data.ctrl[servo] = position

    def positions(self):
        """Positions of the joints, rad."""
        return [float(self.data.qpos[place]) for place in self.places]

    def refusal(self, names, points):
        """Reason why a trajectory is refused, as a code and text; None if it is accepted. A point is time, positions and velocities."""
        if sorted(names) != sorted(self.names):
            return INVALID_JOINTS, f"the joints of this arm are {', '.join(self.names)}"
        if not points or any(b[0] <= a[0] for a, b in zip(points, points[1:])):
            return INVALID_GOAL, "needed: points at growing times"
        by_name = dict(zip(self.names, self.joints))
        for time, positions, velocities in points:
            if len(positions) != len(names) or len(velocities) not in (0, len(names)):
                return INVALID_GOAL, f"{time:.3f} s: needed: a position and a velocity of each joint"
            for name, position in zip(names, positions):
                low, high = by_name[name].limits
                if not low <= position <= high:
                    return INVALID_GOAL, f"{time:.3f} s: {name} at {position:.4f} rad; allowed: {low} to {high}"
            for name, velocity in zip(names, velocities):
                if abs(velocity) > by_name[name].velocity:
                    return INVALID_GOAL, f"{time:.3f} s: {name} with {velocity:.4f} rad/s; allowed: {by_name[name].velocity}"
        return None

    def follow(self, names, points):
        """Begins a motion, now."""
        order = [names.index(name) for name in self.names]
        still = [0.0] * len(order)
        times = [time for time, _, _ in points]
        positions = [[row[k] for k in order] for _, row, _ in points]
        velocities = [[row[k] for k in order] if row else still for _, _, row in points]
        if times[0] > 0.0:
            times, positions, velocities = [0.0] + times, [self.positions()] + positions, [still] + velocities
        self.motion = Motion(times, positions, velocities, self.data.time)
        return self.motion

    def stop(self):
        """Holds its current position."""
        if self.motion:
            self.motion = None
            self.command(self.positions(), [0.0] * len(self.names))

    def command(self, positions, velocities):
        # The damping of a servo acts on the whole velocity: what is wanted of it is added.
        for servo, position, velocity in zip(self.servos, positions, velocities):
            self.data.ctrl[servo] = position + SERVO_TIME * velocity

    def advance(self):
        """Between two steps."""
        motion = self.motion
        if not motion:
            return
        wanted, velocities = motion.at(self.data.time)
        self.command(wanted, velocities)
        errors = [abs(a - b) for a, b in zip(wanted, self.positions())]
        worst = max(range(len(errors)), key=errors.__getitem__)
        late = self.data.time - motion.begin - motion.times[-1]
        if errors[worst] > PATH_TOLERANCE:
            self.stop()
            motion.end(PATH_TOLERANCE_VIOLATED, f"{self.names[worst]} is {errors[worst]:.3f} rad from its path")
        elif late >= 0.0 and errors[worst] < GOAL_TOLERANCE:
            self.motion = None
            motion.end(SUCCESSFUL)
        elif late > GOAL_PATIENCE:
            self.stop()
            motion.end(GOAL_TOLERANCE_VIOLATED, f"{self.names[worst]} is {errors[worst]:.3f} rad from the last point")

    def holds(self, cable):
        """Holds the cable, or lets it go."""
        self.data.eq_active[self.hold] = 1 if cable else 0
