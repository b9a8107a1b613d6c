"""A heavy top, as a rigid body of MuJoCo with a ball joint and the Runge–Kutta method.

The time step is 0.4 ms at 4 edges, and is halved when the number of edges doubles.
"""

import mujoco
import numpy as np
import peer


def axis(edges):
    model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{0.0004 * 4 / edges}" integrator="RK4" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="top">
      <joint type="ball"/>
      <inertial pos="0 1 0" mass="15" diaginertia="0.234375 0.46875 0.234375"/>
    </body>
  </worldbody>
</mujoco>""")
    data = mujoco.MjData(model)
    data.qvel[:] = [0, 150, -4.61538]
    for _ in range(round(2 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    return data.body("top").xmat.reshape(3, 3) @ np.array([0, 1, 0])


quantities = ["axis after 2 s, x", "axis after 2 s, y", "axis after 2 s, z"]
peer.run("MuJoCo", "mujoco", quantities, axis)
