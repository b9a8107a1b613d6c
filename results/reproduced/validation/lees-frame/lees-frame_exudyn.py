"""The limit load of Lee's frame, with ANCF cables of Exudyn and a loaded point that falls in steps."""

import exudyn_rod as rods
import numpy as np
import peer


def load(edges):
    mbs = rods.system()
    column, of_column = rods.straight(mbs, [0, 0], [0, 1], edges, 43200.0)
    beam, of_beam = rods.straight(mbs, [0, 1], [1, 0], edges, 43200.0)
    rods.hold(mbs, column[0], range(2))
    rods.hold(mbs, beam[-1], range(2))
    rods.join(mbs, of_column[-1], 1 / edges, of_beam[0], np.pi / 2)
    loaded = rods.hold(mbs, beam[edges // 5], [1])[0]
    mbs.Assemble()
    return rods.limit_loads(mbs, loaded, 0.05)


peer.run("Exudyn", "exudyn", ["limit load P L²/EI"], load)
