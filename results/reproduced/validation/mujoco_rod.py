"""Rods in MuJoCo: 1-D flexes with elasticity, brought to rest by the `discrete` integrator.

It needs MuJoCo 4, whose flexes are discrete elastic rods; earlier versions have a plugin for cables.
Edges keep their lengths. Pinning the first two points clamps the first edge; its middle is the clamp.
"""

import mujoco
import numpy as np

RADIUS = 1e-3


def arclengths(edges):
    """Arclengths of the nodes of a rod of length 1 that is clamped in the middle of its first edge."""
    return (np.arange(edges + 1) - 0.5) / (edges - 0.5)


class Rod:
    """A clamped rod of mass 1 with a circular section, through points in space."""

    def __init__(self, points, length, bending, damping=0.5):
        """`damping` is the time of Rayleigh's damping in units of the time √(m L³/EI)."""
        edges = len(points) - 1
        unit = np.sqrt(length**3 / bending)
        # The error of the lengths of edges grows with the time step.
        self.step = 0.06 / edges * unit
        young = bending * 4 / (np.pi * RADIUS**4)
        text = " ".join(f"{x!r}" for x in np.asarray(points, float).ravel().tolist())
        self.model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{self.step}" integrator="discrete" solver="Newton" tolerance="1e-12" gravity="0 0 0">
    <flag contact="disable"/>
  </option>
  <worldbody>
    <flexcomp name="rod" type="direct" dim="1" mass="1" radius="{RADIUS}" point="{text}"
              element="{' '.join(f'{k} {k + 1}' for k in range(edges))}">
      <contact selfcollide="none"/>
      <edge equality="true" solref="{self.step} 1" solimp=".9999 .9999 .001"/>
      <pin id="0 1"/>
      <elasticity young="{young}" shear="{young / 2}" damping="{damping * unit}"/>
    </flexcomp>
  </worldbody>
</mujoco>""")
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.bodies = [self.model.body(f"rod_{node}").id for node in range(2, edges + 1)]
        # Three sliding joints of each node come first among the velocities of its body.
        first = self.model.body_dofadr[self.bodies]
        self.velocities = first[:, None] + np.arange(3)
        self.drag = 4 / unit * self.model.body_mass[self.bodies][:, None]
        self.unit, self.slow = unit, 1e-6 * length / unit

    @property
    def nodes(self):
        """Positions of the free nodes."""
        return self.data.xpos[self.bodies]

    def relax(self, forces, ramp=1.0):
        """Steps with drag until all rests; `forces(nodes)` returns the forces at the free nodes."""
        time = 0.0
        while time < ramp + 1 or np.abs(self.data.qvel).max() > self.slow:
            time += self.step / self.unit
            scale = min(1.0, time / ramp) if ramp > 0 else 1.0
            drag = self.drag * self.data.qvel[self.velocities]
            self.data.xfrc_applied[self.bodies, :3] = scale * forces(self.nodes) - drag
            mujoco.mj_step(self.model, self.data)
            if time > 1000:
                raise RuntimeError("the rod does not come to rest")
        return self.nodes[-1]
