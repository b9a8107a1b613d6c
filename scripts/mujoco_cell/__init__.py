"""A robot cell in MuJoCo behind ROS 1: arms, a cable, a table and a camera. `scripts/mujoco-cell` starts it."""
