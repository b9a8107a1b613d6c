"""Parameters of an environment that are drawn at random for each episode."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Range:
    """The range of a randomised parameter.

    Parameters
    ----------
    low, high : float
        Bounds, in `unit`.
    unit : str
        Unit of the bounds; empty for a pure number.
    logarithmic : bool
        Draw evenly in the logarithm instead of in the value.
    """

    low: float
    high: float
    unit: str = ""
    logarithmic: bool = False

    def draw(self, random: np.random.Generator) -> float:
        """Return a value of the range."""
        part = float(random.random())
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** part)
        return self.low + part * (self.high - self.low)


def draw_parameters(
    ranges: Mapping[str, Range], random: np.random.Generator, fixed: Mapping[str, float]
) -> dict[str, float]:
    """Draw all parameters, and replace those that are fixed.

    Every parameter takes one random number, whether it is fixed or not, so that fixing one does not change the others.

    Parameters
    ----------
    ranges : mapping of str to Range
        The parameters in the order in which they are drawn.
    random : numpy.random.Generator
        Source of the random numbers.
    fixed : mapping of str to float
        Values to use instead of drawn ones. They may be outside the ranges.

    Returns
    -------
    dict of str to float

    Raises
    ------
    ValueError
        If a fixed parameter does not exist or is not a finite number.
    """
    unknown = sorted(set(fixed) - set(ranges))
    if unknown:
        raise ValueError(f"no such parameter: {', '.join(unknown)}; there are {', '.join(ranges)}")
    values = {}
    for name, limits in ranges.items():
        values[name] = limits.draw(random)
        if name in fixed:
            values[name] = float(fixed[name])
            if not np.isfinite(values[name]):
                raise ValueError(f"parameter {name} is not a finite number")
    return values
