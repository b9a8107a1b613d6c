"""Williams' toggle, with ANCF cables of Exudyn and an apex that falls in steps."""

import exudyn_rod as rods
import numpy as np
import peer

RISE = 0.386 / 12.943


def loads(edges):
    mbs = rods.system()
    length = np.hypot(1, RISE)
    stretching = 12 * (12.943 / 0.243) ** 2
    up, down = np.array([1, RISE]) / length, np.array([1, -RISE]) / length
    left, of_left = rods.straight(mbs, [-1, 0], up, edges, stretching, length=length)
    right, of_right = rods.straight(mbs, [0, RISE], down, edges, stretching, length=length)
    rods.hold(mbs, left[0], range(4))
    rods.hold(mbs, right[-1], range(4))
    rods.join(mbs, of_left[-1], length / edges, of_right[0], 2 * np.arctan(RISE))
    apex = rods.hold(mbs, left[-1], [1])[0]
    mbs.Assemble()
    return rods.limit_loads(mbs, apex, RISE / 16, 2)


peer.run("Exudyn", "exudyn", ["maximum of P L²/EI", "minimum of P L²/EI"], loads)
