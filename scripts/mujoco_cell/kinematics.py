"""The chain of an arm, read from a table with a row for each joint."""

import csv
from dataclasses import dataclass

COLUMNS = "joint,type,parent,child,x,y,z,roll,pitch,yaw,ax,ay,az,lower,upper,velocity,effort".split(",")


@dataclass
class Joint:
    """A joint: its pose in the frame of the link before, and what a motor there can do."""

    name: str
    origin: tuple  # x, y, z, m
    rpy: tuple  # roll, pitch, yaw, rad, as in URDF
    axis: tuple
    limits: tuple = None  # lowest and highest position, rad; none where the joint is fixed
    velocity: float = 0.0  # largest, rad/s
    effort: float = 0.0  # largest torque, N m


def read_chain(path):
    """The joints of a table, from the base to the hand; `right_j0` is `j0` here, for the name of the arm comes before it."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows or not set(COLUMNS) <= set(rows[0]):
        raise ValueError(f"{path}: needed: the columns {', '.join(COLUMNS)}")
    chain = []
    for line, row in enumerate(rows, start=2):
        try:
            numbers = {column: float(row[column] or 0.0) for column in COLUMNS[4:]}
        except ValueError as error:
            raise ValueError(f"{path}, line {line}: {error}") from None
        if row["type"] not in ("revolute", "fixed"):
            raise ValueError(f"{path}, line {line}: type {row['type']!r}; allowed: revolute, fixed")
        take = lambda *columns: tuple(numbers[column] for column in columns)
        joint = Joint(row["joint"].partition("_")[2], take("x", "y", "z"), take("roll", "pitch", "yaw"), take("ax", "ay", "az"))
        if row["type"] == "revolute":
            joint.limits = take("lower", "upper")
            joint.velocity, joint.effort = take("velocity", "effort")
        chain.append(joint)
    return chain
