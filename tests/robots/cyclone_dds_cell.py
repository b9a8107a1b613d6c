"""A gantry with a gripper and a camera behind ROS 2 on Cyclone DDS, on this machine only: the arm of `cyclone_dds_arm.py`, an action
server of control_msgs/GripperCommand whose fingers stall on a rod, and a camera that sends the same PNG file repeatedly.
Arguments: the domain, the common name of all parts, the PNG file, and the radius of the rod, m."""

import sys
import time

import cyclone_dds_arm as dds
from cyclone_dds_arm import (
    BEST_EFFORT, HEADER, NAME, CancelRequest, CancelResponse, Header, Identifier, Name, Service, Time, float64,
    int8, message, publisher, sequence, uint8,
)
from cyclonedds.idl import IdlStruct

PICTURE, RADIUS = sys.argv[3], float(sys.argv[4])
JOINTS = {"x": 0.0, "y": 0.0, "z": 0.5, "yaw": 0.0, "roll": 0.0, "pitch": 0.0}
FINGERS = "gantry_fingers"
ABORTED, SUCCEEDED, CANCELLED = 6, 4, 5
SPEED = 0.1  # of the fingers, m/s
GRIPPERS = "control_msgs.action.dds_.GripperCommand_"


@message
class Command(IdlStruct):
    position: float64
    max_effort: float64


@message
class GripperGoal(IdlStruct, typename=f"{GRIPPERS}SendGoal_Request_"):
    request: Name
    goal_id: Identifier
    command: Command


@message
class GripperTaken(IdlStruct, typename=f"{GRIPPERS}SendGoal_Response_"):
    request: Name
    accepted: bool
    stamp: Time


@message
class GripperAsked(IdlStruct, typename=f"{GRIPPERS}GetResult_Request_"):
    request: Name
    goal_id: Identifier


@message
class GripperResult(IdlStruct, typename=f"{GRIPPERS}GetResult_Response_"):
    request: Name
    status: int8
    position: float64
    effort: float64
    stalled: bool
    reached_goal: bool


@message
class CompressedImage(IdlStruct, typename="sensor_msgs.msg.dds_.CompressedImage_"):
    header: Header
    format: str
    data: sequence[uint8]


class Gripper:
    """A gripper whose fingers stall at the diameter of the rod. It then aborts the goal, as ros2_control does by default."""

    def __init__(self, arm):
        self.arm = arm
        self.send_goal = Service("gripper", "send_goal", GripperGoal, GripperTaken)
        self.get_result = Service("gripper", "get_result", GripperAsked, GripperResult)
        self.cancel_goal = Service("gripper", "cancel_goal", CancelRequest, CancelResponse)
        self.goal, self.ended, self.asked = None, {}, []

    def live(self):
        for one in self.send_goal.requests():
            takes = self.goal is None
            self.send_goal.writer.write(GripperTaken(one.request, takes, Time()))
            if takes:
                self.goal = (bytes(one.goal_id), one.command)
        for one in self.cancel_goal.requests():
            ours = self.goal is not None and bytes(one.goal_info.goal_id) == self.goal[0]
            self.cancel_goal.writer.write(CancelResponse(one.request, 0 if ours else 2, []))
            if ours:
                self.end(CANCELLED, False)
        self.asked += self.get_result.requests()
        if self.goal is not None:
            self.move(self.goal[1])
        for one in list(self.asked):
            if bytes(one.goal_id) in self.ended:
                self.asked.remove(one)
                status, stalled = self.ended[bytes(one.goal_id)]
                opening = self.arm.position[FINGERS]
                result = GripperResult(one.request, status, opening, 0.0, stalled, not stalled)
                self.get_result.writer.write(result)

    def move(self, command):
        opening = self.arm.position[FINGERS]
        # Fingers without force do not move.
        step = 0.01 * SPEED if command.max_effort > 0 else 0.0
        wanted = max(command.position, 2 * RADIUS)
        if abs(wanted - opening) > step:
            self.arm.position[FINGERS] += step if wanted > opening else -step
            return
        self.arm.position[FINGERS] = wanted
        stalled = wanted > command.position
        print("gripper", "stalled" if stalled else "moved", command.position, command.max_effort, flush=True)
        self.end(ABORTED if stalled else SUCCEEDED, stalled)

    def end(self, status, stalled):
        self.ended[self.goal[0]] = (status, stalled)
        self.goal = None


class Camera:
    def __init__(self):
        self.pictures = publisher(f"rt/{NAME}/camera/image_raw/compressed", CompressedImage, BEST_EFFORT)
        self.last = 0.0
        with open(PICTURE, "rb") as file:
            self.image = CompressedImage(HEADER, "png", list(file.read()))

    def live(self):
        if time.monotonic() - self.last > 0.2:
            self.last = time.monotonic()
            self.pictures.write(self.image)


arm = dds.Arm(list(JOINTS), {**JOINTS, FINGERS: 0.04})
dds.run(arm, Gripper(arm), Camera())
