"""The camera above the table."""

import mujoco


class Camera:
    """Pictures of the cell; all of them are made in one thread, to which the graphics belong."""

    def __init__(self, simulation):
        self.simulation = simulation
        self.seen = mujoco.MjData(simulation.model)
        self.options = mujoco.MjvOption()
        # Marks of the model are not part of the cell.
        self.options.sitegroup[:] = 0
        width, height = simulation.cell.picture
        self.renderer = mujoco.Renderer(simulation.model, height, width)

    def picture(self):
        """Time, s, and the rows of pixels, red, green and blue."""
        model, seen = self.simulation.model, self.seen
        with self.simulation.lock:
            seen.qpos[:] = self.simulation.data.qpos
            time = self.simulation.data.time
        mujoco.mj_kinematics(model, seen)
        mujoco.mj_comPos(model, seen)
        mujoco.mj_camlight(model, seen)
        self.renderer.update_scene(seen, camera="above", scene_option=self.options)
        return time, self.renderer.render()
