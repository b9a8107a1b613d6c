"""Frequency of a hanging chain, as rigid links with hinges in MuJoCo."""

import mujoco
import numpy as np
import peer

END, ZERO = 27.0, 2.404825557695773


def bessel(x):
    """J₀ by its integral; the trapezoidal rule is exact to rounding."""
    angles = np.pi * (np.arange(64) + 0.5) / 64
    return np.cos(np.multiply.outer(x, np.sin(angles))).mean(axis=-1)


def frequency(edges):
    length, step = 1 / edges, 0.01 * 25 / edges
    link = f"""
<body pos="0 0 {{at}}">
  <joint type="hinge" axis="0 1 0"/>
  <inertial pos="0 0 {-length / 2}" mass="{length}"
            diaginertia="{length**3 / 12} {length**3 / 12} {length**3 / 1000}"/>"""
    links = "".join(link.format(at=-length if k else 0) for k in range(edges))
    model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{step}" integrator="RK4" gravity="0 0 -1"/>
  <worldbody>{links}{"</body>" * edges}</worldbody>
</mujoco>""")
    data = mujoco.MjData(model)
    # The chain turns as one about its upper end.
    data.qvel[0] = 1e-3
    mode = bessel(ZERO * np.sqrt(1 - np.arange(1, edges + 1) / edges))
    mode[-1] /= 2
    crossings, before = [], None
    for _ in range(round(END / step)):
        mujoco.mj_step(model, data)
        # Angles of the links give the places of the nodes.
        x = -length * np.cumsum(np.sin(np.cumsum(data.qpos)))
        amplitude = mode @ x
        if before is not None and amplitude * before < 0:
            crossings.append(data.time - step * amplitude / (amplitude - before))
        before = amplitude
    return [np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])]


peer.run("MuJoCo", "mujoco", ["frequency, √(g/L)"], frequency, lambda: None)
