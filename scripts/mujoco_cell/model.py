"""The cell as an MJCF model: arms with position servos, a cable of capsules, a table, a camera."""

import math
from dataclasses import dataclass

import mujoco

# MuJoCo's contacts and welds are springs: they give way by about 0.1 mm here.
STIFF = 'solref="0.004 1" solimp="0.95 0.99 0.001"'
# Contact groups: the table touches everything, the cable itself and by its nodes the table. Arms do not touch the cable.
TABLE, CABLE, ARM, NODE = 1, 2, 4, 8
# Resistance of a cable to rolling, N m s/rad: without it a straight one rolls away by itself, a millimetre a second.
ROLLING = 1e-5
# A person holds the free end by so much above where it lies, m, on a hand that slides.
LIFT = 2e-4
# Inertia that is added to the turning of each edge, kg m²: shakes too fast for the time step are slower with it.
SPIN = 2e-8
ORANGE = (0.95, 0.45, 0.1, 1.0)
# Servos: kp is the largest effort over this error, kv is kp times this time. The inertia of a motor is in proportion to its effort.
FULL_EFFORT_ERROR = 0.02  # rad
SERVO_TIME = 0.02  # s
MOTOR_INERTIA = 1 / 80  # kg m² for each N m


@dataclass
class Cable:
    """A cable: a round rod that bends and twists, and does not stretch."""

    length: float  # m
    radius: float  # m
    density: float  # kg/m³
    youngs_modulus: float  # Pa
    nodes: int
    relaxation: float  # s: bending moments are those of a spring with a dashpot beside it

    @property
    def edge(self):
        """Distance of neighbouring nodes, m."""
        return self.length / (self.nodes - 1)

    def gravito_bending_length(self, gravity=9.81):
        """L_gb = (E r² / (8 ρ g))^(1/3), m: the length over which weight bends it."""
        return (self.youngs_modulus * self.radius**2 / (8 * self.density * gravity)) ** (1 / 3)


@dataclass
class Place:
    """An arm by its side, and the pose of its base: x, y, z, m, and a turn about z, rad."""

    side: str
    base: tuple
    home: tuple  # joint positions at the start, rad


@dataclass
class Cell:
    """Everything that the model is made of."""

    chain: list
    arms: list
    cable: Cable
    friction: float
    table: tuple  # x, y, z of the centre of its top, m
    table_size: tuple  # along x and y, m
    camera: tuple  # x, y, z, m; it looks straight down
    picture: tuple  # width, height, pixels
    focal_length: float  # pixels
    grip: float  # from the last frame of the chain along its z axis to where the gripper grips, m
    time_step: float = 2e-3  # s


def numbers(values):
    """Numbers as MJCF writes them."""
    return " ".join(f"{value:.12g}" for value in values)


def arm(chain, place, grip):
    """Bodies of an arm, one in the other, and a site where it grips."""
    x, y, z, turn = place.base
    text = f'<body name="{place.side}_base" pos="{numbers((x, y, z))}" euler="0 0 {turn:.12g}">'
    for index, joint in enumerate(chain):
        name = f"{place.side}_{joint.name}"
        text += f'<body name="{name}_link" pos="{numbers(joint.origin)}" euler="{numbers(joint.rpy)}" gravcomp="1">'
        if joint.limits:
            text += (
                f'<joint name="{name}" axis="{numbers(joint.axis)}" range="{numbers(joint.limits)}" '
                f'armature="{joint.effort * MOTOR_INERTIA:.6g}"/>'
            )
        # A capsule to the next joint, and a thinner one to the fingers.
        is_last = index + 1 == len(chain)
        onwards, radius = ((0, 0, grip - 0.03), 0.02) if is_last else (chain[index + 1].origin, 0.045)
        if math.hypot(*onwards) > 0.03:
            text += (
                f'<geom type="capsule" fromto="0 0 0 {numbers(onwards)}" size="{radius}" density="800" '
                f'rgba="0.35 0.36 0.4 1" contype="{ARM}" conaffinity="{TABLE}"/>'
            )
        elif joint.limits:
            text += '<inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>'
    # The cable leaves the gripper against the x axis of the hand.
    text += f'<site name="{place.side}_grip" pos="0 0 {grip}" euler="0 {math.pi} 0"/>'
    return text + "</body>" * (len(chain) + 1)


def servos(chain, side):
    """A position servo for each joint that moves."""
    text = ""
    for joint in (joint for joint in chain if joint.limits):
        kp = joint.effort / FULL_EFFORT_ERROR
        text += (
            f'<position name="{side}_{joint.name}" joint="{side}_{joint.name}" kp="{kp:.6g}" kv="{kp * SERVO_TIME:.6g}" '
            f'forcerange="{-joint.effort} {joint.effort}"/>'
        )
    return text


def cable(rod, friction):
    """The cable, stored far below until a gripper takes it."""
    shear = rod.youngs_modulus / 3
    bending = rod.youngs_modulus * math.pi * rod.radius**4 / 4
    # That of a cylinder: the round ends of the capsules overlap.
    mass = rod.density * math.pi * rod.radius**2 * rod.edge
    return f"""
    <composite prefix="cable_" type="cable" curve="s" count="{rod.nodes} 1 1" size="{rod.length}" offset="0 0 -5" initial="free">
      <plugin plugin="mujoco.elasticity.cable">
        <config key="bend" value="{rod.youngs_modulus}"/>
        <config key="twist" value="{shear}"/>
        <config key="vmax" value="0"/>
      </plugin>
      <joint kind="main" armature="{SPIN}" damping="{rod.relaxation * bending / rod.edge:.6g}"/>
      <geom type="capsule" size="{rod.radius}" mass="{mass:.9g}" rgba="{numbers(ORANGE)}" condim="3"
        friction="{friction} 0.005 0.0001" contype="{CABLE}" conaffinity="{CABLE}" {STIFF}/>
    </composite>"""


def mjcf(cell):
    """The model as text."""
    x, y, z = cell.table
    along, across = cell.table_size
    width, height = cell.picture
    holds = "".join(
        f'<weld name="{place.side}_holds" site1="{place.side}_grip" site2="cable_S_first" active="false" {STIFF}/>'
        for place in cell.arms
    )
    return f"""
<mujoco model="cell">
  <compiler angle="radian" eulerseq="XYZ" autolimits="true"/>
  <option timestep="{cell.time_step}" integrator="implicitfast" cone="elliptic" solver="PGS" iterations="15">
    <flag autoreset="disable"/>
  </option>
  <size memory="64M"/>
  <visual>
    <global offwidth="{width}" offheight="{height}"/>
    <map znear="0.05"/>
    <quality shadowsize="2048"/>
    <headlight ambient="0.35 0.35 0.35" diffuse="0.3 0.3 0.3" specular="0 0 0"/>
  </visual>
  <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
  <worldbody>
    <light pos="{x + 0.4} {y + 0.6} {z + 2.5}" dir="-0.15 -0.2 -1" diffuse="0.5 0.5 0.5" specular="0.1 0.1 0.1"/>
    <geom name="table" type="box" pos="{x} {y} {z - 0.02}" size="{along / 2} {across / 2} 0.02" rgba="0.16 0.18 0.2 1"
      condim="3" friction="{cell.friction} 0.005 0.0001" contype="{TABLE}" conaffinity="{TABLE}" {STIFF}/>
    <camera name="above" pos="{numbers(cell.camera)}" resolution="{width} {height}" sensorsize="{width * 1e-5} {height * 1e-5}"
      focalpixel="{cell.focal_length} {cell.focal_length}"/>
    <body name="hand" pos="0 0 {z + cell.cable.radius + LIFT}">
      <joint name="hand_x" type="slide" axis="1 0 0" damping="0.01"/>
      <joint name="hand_y" type="slide" axis="0 1 0" damping="0.01"/>
      <inertial pos="0 0 0" mass="0.001" diaginertia="1e-7 1e-7 1e-7"/>
      <site name="finger"/>
    </body>
    {"".join(arm(cell.chain, place, cell.grip) for place in cell.arms)}
    {cable(cell.cable, cell.friction)}
  </worldbody>
  <equality>
    {holds}
    <connect name="person_holds" site1="finger" site2="cable_S_last" active="false" {STIFF}/>
  </equality>
  <actuator>{"".join(servos(cell.chain, place.side) for place in cell.arms)}</actuator>
</mujoco>"""


def compile_model(cell):
    """The model, ready to be simulated: with a sphere at each node, by which the cable touches the table, once for each edge."""
    spec = mujoco.MjSpec.from_string(mjcf(cell))
    touching = dict(
        type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[cell.cable.radius, 0, 0], mass=0.0, contype=NODE, conaffinity=TABLE, condim=3,
        friction=[cell.friction, 0.005, 0.0001], solref=[0.004, 1.0], solimp=[0.95, 0.99, 0.001, 0.5, 2.0], rgba=ORANGE,
    )
    edges = [body for body in spec.bodies if body.name.startswith("cable_B_")]
    for body in edges:
        body.add_geom(**touching)
    edges[-1].add_geom(pos=[cell.cable.edge, 0, 0], **touching)
    model = spec.compile()
    root = model.jnt_dofadr[model.body("cable_B_first").jntadr[0]]
    model.dof_damping[root + 3 : root + 6] = ROLLING
    return model
