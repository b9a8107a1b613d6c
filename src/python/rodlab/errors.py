"""Exceptions of rodlab, with the messages of the command line."""

from __future__ import annotations

__all__ = ["RodlabError", "ScenarioError", "ConvergenceError", "PhysicsError"]


class RodlabError(Exception):
    """Base class of all errors of rodlab.

    Attributes
    ----------
    exit_code : int
        The exit code that the command line has for this failure.
    """

    exit_code: int = 1


class ScenarioError(RodlabError, ValueError):
    """A fault of a scenario, of an argument, or of a file."""

    exit_code = 2


class ConvergenceError(RodlabError, RuntimeError):
    """No step converges, or no equilibrium is found.

    The simulation has the state of the last accepted step.
    """

    exit_code = 3


class PhysicsError(RodlabError, RuntimeError):
    """A physics check failed: rods passed through each other, or a strain is beyond any rod."""

    exit_code = 4
