"""A small rasteriser: lines and disks in orthographic projection, without further packages."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Colour = tuple[int, int, int]

ROD: Colour = (0, 90, 160)
TARGET: Colour = (230, 150, 30)
GRIPPER: Colour = (60, 60, 60)
FIXTURE: Colour = (150, 150, 150)
GROUND: Colour = (205, 205, 205)


class Canvas:
    """A picture of a part of a scene, seen along one direction.

    Parameters
    ----------
    right, up : array, 3
        Unit vectors of the scene that point right and up in the picture.
    centre : array, 3
        Point of the scene in the middle of the picture, m.
    extent : float
        Width of the part of the scene that is shown, m.
    size : tuple of int
        Width and height of the picture, pixels.
    """

    def __init__(
        self, right: ArrayLike, up: ArrayLike, centre: ArrayLike, extent: float, size: tuple[int, int] = (256, 256)
    ) -> None:
        self._axes = np.array([right, np.negative(up)], dtype=np.float64)
        self._centre = np.asarray(centre, dtype=np.float64)
        self._scale = size[0] / extent
        self._middle = np.array([0.5 * size[0], 0.5 * size[1]])
        self._pixels = np.full((size[1], size[0], 3), 255.0)

    def project(self, points: ArrayLike) -> Array:
        """Return the places of points of the scene, n × 3, in the picture, n × 2, pixels."""
        relative = np.atleast_2d(np.asarray(points, dtype=np.float64)) - self._centre
        return np.asarray(self._middle + self._scale * (relative @ self._axes.T))

    def line(self, points: ArrayLike, radius: float, colour: Colour) -> None:
        """Draw a polyline through points of the scene, n × 3, of the given radius in m, at least 0.8 pixels."""
        places = self.project(points)
        half = max(radius * self._scale, 0.8)
        cover = np.zeros(self._pixels.shape[:2])
        for start, end in zip(places[:-1], places[1:], strict=True):
            self._capsule(start, end, half, cover)
        self._blend(cover, colour)

    def dots(self, points: ArrayLike, radius: float, colour: Colour) -> None:
        """Draw disks about points of the scene, n × 3, of the given radius in m, at least 2 pixels."""
        half = max(radius * self._scale, 2.0)
        cover = np.zeros(self._pixels.shape[:2])
        for place in self.project(points):
            self._capsule(place, place, half, cover)
        self._blend(cover, colour)

    def image(self) -> NDArray[np.uint8]:
        """Return the picture, height × width × 3."""
        picture: NDArray[np.uint8] = np.rint(self._pixels).astype(np.uint8)
        return picture

    def _blend(self, cover: Array, colour: Colour) -> None:
        rows, columns = np.flatnonzero(cover.any(axis=1)), np.flatnonzero(cover.any(axis=0))
        if len(rows) == 0:
            return
        part = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        region = self._pixels[part]
        region += cover[part][..., np.newaxis] * (np.array(colour, dtype=np.float64) - region)

    @staticmethod
    def _capsule(start: Array, end: Array, half: float, cover: Array) -> None:
        """Cover the pixels nearer than `half` to a segment, with edges one pixel wide."""
        height, width = cover.shape
        if not np.all(np.isfinite([start, end])):
            return
        low = np.floor(np.minimum(start, end) - half - 1.0)
        high = np.ceil(np.maximum(start, end) + half + 1.0)
        left, top = (int(max(value, 0.0)) for value in low)
        right, bottom = int(min(high[0], width)), int(min(high[1], height))
        if left >= right or top >= bottom:
            return
        x = np.arange(left, right)[np.newaxis, :] + 0.5 - start[0]
        y = np.arange(top, bottom)[:, np.newaxis] + 0.5 - start[1]
        along = end - start
        square = float(along @ along)
        part = np.clip((x * along[0] + y * along[1]) / square, 0.0, 1.0) if square > 0.0 else 0.0
        distance = np.hypot(x - part * along[0], y - part * along[1])
        region = cover[top:bottom, left:right]
        np.maximum(region, np.clip(half + 0.5 - distance, 0.0, 1.0), out=region)
