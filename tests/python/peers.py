"""The same swinging cantilever by rodlab, MuJoCo and PyElastica, with a callback of Python at each step.

    pip install mujoco pyelastica
    python tests/python/peers.py

A rod of 0.3 m that is clamped horizontally falls under its weight for half a second. The error is the root mean square of
the distance of the tip from that of a fine reference, at 25 times. Each program runs a ladder of resolutions; the table has
processor time a simulated second, set-up excluded.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

LENGTH, RADIUS, DENSITY = 0.3, 5e-3, 1000.0
YOUNGS_MODULUS, POISSONS_RATIO = 1e7, 0.5
SHEAR_MODULUS = YOUNGS_MODULUS / (2 * (1 + POISSONS_RATIO))
END, SAMPLES = 0.5, 25

Tips = np.ndarray
Run = Callable[[int, float], tuple[Tips, float]]


def sampled(steps: int, step: Callable[[], None], tip: Callable[[], np.ndarray]) -> tuple[Tips, float]:
    """Take steps with a callback after each; return the tips at the samples, and processor time."""
    every, tips = steps // SAMPLES, []
    start = time.process_time()
    for k in range(1, steps + 1):
        step()
        if k % every == 0:
            tips.append(tip())
    return np.array(tips), time.process_time() - start


def rodlab(edges: int, step: float) -> tuple[Tips, float]:
    from rodlab import _rodlab

    scenario = _rodlab.Scenario.from_dict(
        {
            "experiment": "scene",
            "material": {"youngs_modulus": YOUNGS_MODULUS, "poissons_ratio": POISSONS_RATIO, "density": DENSITY},
            "time": {"end": END, "step": step},
            "rods": [
                {
                    "name": "beam",
                    "radius": RADIUS,
                    "edges": edges,
                    "shape": {"kind": "straight", "start": [0, 0, 0], "end": [LENGTH, 0, 0]},
                }
            ],
            "clamps": [{"rod": "beam", "at": "start"}],
            "loads": [{"kind": "gravity", "acceleration": [0, 0, -9.81]}],
        }
    )
    simulation = _rodlab.Simulation(scenario)
    return sampled(round(END / step), simulation.step, lambda: simulation.positions[-1])


def mujoco(edges: int, step: float) -> tuple[Tips, float]:
    import mujoco as mj

    model = mj.MjModel.from_xml_string(
        f"""
        <mujoco>
          <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
          <option timestep="{step}" gravity="0 0 -9.81" integrator="implicit"><flag contact="disable"/></option>
          <worldbody>
            <composite type="cable" curve="s 0 0" count="{edges + 1} 1 1" size="{LENGTH}" initial="none">
              <plugin plugin="mujoco.elasticity.cable">
                <config key="twist" value="{SHEAR_MODULUS}"/><config key="bend" value="{YOUNGS_MODULUS}"/>
              </plugin>
              <joint kind="main" damping="0" armature="0"/>
              <geom type="cylinder" size="{RADIUS}" density="{DENSITY}"/>
            </composite>
          </worldbody>
        </mujoco>"""
    )
    data = mj.MjData(model)
    last = model.nbody - 1
    segment = np.array([LENGTH / edges, 0, 0])
    return sampled(
        round(END / step),
        lambda: mj.mj_step(model, data),
        lambda: data.xpos[last] + data.xmat[last].reshape(3, 3) @ segment,
    )


def elastica(edges: int, step: float) -> tuple[Tips, float]:
    import elastica as ea

    class Scene(ea.BaseSystemCollection, ea.Constraints, ea.Forcing):
        pass

    stepper = ea.PositionVerlet()
    scene = Scene()
    rod = ea.CosseratRod.straight_rod(
        edges,
        np.zeros(3),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        RADIUS,
        DENSITY,
        youngs_modulus=YOUNGS_MODULUS,
        shear_modulus=SHEAR_MODULUS,
    )
    scene.append(rod)
    scene.constrain(rod).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    scene.add_forcing_to(rod).using(ea.GravityForces, acc_gravity=np.array([0.0, 0.0, -9.81]))
    scene.finalize()
    now = [np.float64(0.0)]

    def advance() -> None:
        now[0] = stepper.step(scene, now[0], np.float64(step))

    return sampled(round(END / step), advance, lambda: rod.position_collection[:, -1].copy())


LADDERS: dict[str, tuple[Run, list[tuple[int, float]]]] = {
    "rodlab": (rodlab, [(8, 4e-3), (12, 2e-3), (20, 1e-3), (40, 0.5e-3)]),
    "MuJoCo": (mujoco, [(10, 2e-4), (20, 1e-4), (40, 2.5e-5)]),
    "PyElastica": (elastica, [(10, 1e-4), (20, 5e-5), (40, 2e-5)]),
}


def main() -> None:
    """Print the ladder of each program."""
    reference, _ = rodlab(160, 0.1e-3)
    print(f"{'program':<12}{'edges':>6}{'step (ms)':>11}{'error (mm)':>12}{'processor time (s/s)':>22}")
    for name, (run, ladder) in LADDERS.items():
        for edges, step in ladder:
            try:
                # Compile before the measurement what is compiled at the first call.
                run(edges, END / SAMPLES if name == "rodlab" else step) if (edges, step) == ladder[0] else None
                tips, cost = run(edges, step)
            except ImportError as error:
                print(f"{name:<12} skipped: {error}")
                break
            count = min(len(tips), len(reference))
            error = 1e3 * np.sqrt(((tips[:count] - reference[:count]) ** 2).sum(axis=1).mean())
            print(f"{name:<12}{edges:>6}{1e3 * step:>11.3f}{error:>12.4f}{cost / END:>22.4f}")


if __name__ == "__main__":
    main()
