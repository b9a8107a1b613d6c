"""Learning environments with the interface of gymnasium: tasks with elastic rods.

Importing this package registers six environments with gymnasium. Each is simulated by the engine of rodlab, draws its
parameters at random for each episode, and gives the same bytes for the same seed and actions.

===============================  ==================================================================
name                             task
===============================  ==================================================================
rodlab/CantileverReach-v0        reach a point with the tip of a heavy cantilever
rodlab/CableShape-v0             lay a cable on a table along a curve
rodlab/PegPlacement-v0           lay a cable between pegs
rodlab/KnotState-v0              pull an overhand knot to a given size
rodlab/Folding-v0                fold a strip of a sheet without sliding it
rodlab/FlagellumSpeed-v0         swim by turning a helical flagellum
===============================  ==================================================================

`gymnasium.make("rodlab.envs:rodlab/CableShape-v0")` imports the package itself.

Examples
--------
>>> import gymnasium, rodlab.envs
>>> env = gymnasium.make("rodlab/CableShape-v0", render_mode="rgb_array")
>>> observation, info = env.reset(seed=1, options={"parameters": {"friction": 0.5}})
>>> envs = rodlab.envs.make_vec("CableShape", 16)
"""

try:
    import gymnasium
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        'rodlab.envs needs gymnasium: pip install "rodlab[envs]"', name=error.name
    ) from error

from .base import RodEnv
from .cable_shape import CableShape
from .cantilever_reach import CantileverReach
from .flagellum_speed import FlagellumSpeed
from .folding import Folding
from .knot_state import KnotState
from .parameters import Range
from .peg_placement import PegPlacement
from .vector import RodVectorEnv, make_vec

__all__ = [
    "CableShape",
    "CantileverReach",
    "FlagellumSpeed",
    "Folding",
    "KnotState",
    "PegPlacement",
    "Range",
    "RodEnv",
    "RodVectorEnv",
    "make_vec",
    "register",
]


def register() -> None:
    """Register the environments with gymnasium, those that are not registered."""
    for single in (CantileverReach, CableShape, PegPlacement, KnotState, Folding, FlagellumSpeed):
        name = f"rodlab/{single.__name__}-v0"
        if name in gymnasium.registry:
            continue
        gymnasium.register(
            id=name,
            entry_point=f"{single.__module__}:{single.__name__}",
            vector_entry_point=f"{__name__}.vector:{single.__name__}VectorEnv" if single.batched else None,
        )


register()
