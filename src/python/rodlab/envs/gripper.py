"""Poses of a clamp that moves and turns with limited speeds."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rotation(vector: Array) -> Array:
    """Return the rotation matrix, 3 × 3, of a rotation vector in rad."""
    angle = float(np.sqrt(vector @ vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross))


def rotation_vector(matrix: Array) -> Array:
    """Return the rotation vector, in rad, of a rotation matrix, 3 × 3, of less than half a turn."""
    axis = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    sine = 0.5 * float(np.sqrt(axis @ axis))
    cosine = 0.5 * (float(np.trace(matrix)) - 1.0)
    angle = float(np.arctan2(sine, cosine))
    return 0.5 * axis if sine < 1e-12 else axis * (0.5 * angle / sine)


class Gripper:
    """A clamp that holds a node and follows velocities.

    Parameters
    ----------
    clamp : int
        Number of the clamp.
    pose : array, 4 × 4
        Its present pose: directors d₁ and d₂, tangent, and position in m.
    low, high : array, 3
        Corners of the box in which its position stays, m.
    """

    def __init__(self, clamp: int, pose: Array, low: Array, high: Array) -> None:
        self.clamp = clamp
        self.pose = np.array(pose, dtype=np.float64)
        self.low = np.asarray(low, dtype=np.float64)
        self.high = np.asarray(high, dtype=np.float64)

    def move(self, velocity: Array, rate: Array, duration: float) -> Array:
        """Move at constant velocities.

        Parameters
        ----------
        velocity : array, 3
            Velocity, m/s.
        rate : array, 3
            Angular velocity in the frame of the scene, rad/s.
        duration : float
            Duration of the motion, s. The rotation in it is less than half a turn.

        Returns
        -------
        array, 4 × 4
            The pose at its end.
        """
        place = self.pose[:3, 3]
        # A gripper that starts outside its box is not pulled into it.
        low, high = np.minimum(self.low, place), np.maximum(self.high, place)
        pose = np.eye(4)
        pose[:3, :3] = _orthonormal(rotation(rate * duration) @ self.pose[:3, :3])
        pose[:3, 3] = np.clip(place + velocity * duration, low, high)
        self.pose = pose
        return pose.copy()


def _orthonormal(frame: Array) -> Array:
    """Remove the rounding errors of many rotations from a frame, 3 × 3, and keep its tangent."""
    tangent = frame[:, 2] / np.sqrt(frame[:, 2] @ frame[:, 2])
    first = frame[:, 0] - tangent * (tangent @ frame[:, 0])
    first /= np.sqrt(first @ first)
    return np.column_stack([first, np.cross(tangent, first), tangent])
