"""A free body that turns over about its intermediate axis, in MuJoCo with the Runge–Kutta method.

The time step is 40 ms at 4 edges, and is halved when the number of edges doubles.
"""

import mujoco
import numpy as np
import peer


def turns(edges):
    model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{0.04 * 4 / edges}" integrator="RK4" gravity="0 0 0"/>
  <worldbody>
    <body name="body">
      <freejoint/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 2 3"/>
    </body>
  </worldbody>
</mujoco>""")
    data = mujoco.MjData(model)
    data.qvel[3:] = [0, 1, 0.01]
    momentum = np.array([0, 2, 0.03])
    times, parts = [], []
    for _ in range(round(60 / model.opt.timestep)):
        mujoco.mj_kinematics(model, data)
        times.append(data.time)
        parts.append(data.body("body").xmat.reshape(3, 3)[:, 1] @ momentum)
        mujoco.mj_step(model, data)
    signs = np.sign(parts)
    crossings = []
    for k in np.flatnonzero(signs[1:] != signs[:-1])[:2]:
        # Four points around the change of sign, as time over the component.
        near = slice(k - 1, k + 3)
        cubic = np.polyfit(np.array(parts[near]), np.array(times[near]) - times[k], 3)
        crossings.append(times[k] + cubic[-1])
    return crossings


peer.run("MuJoCo", "mujoco", ["first turn, s", "second turn, s"], turns)
