"""An arm of two joints behind an action server of ROS 2 on Cyclone DDS: follows its trajectory, and reports its joints
at 100 Hz. A service is two topics whose messages begin with the identifier of the request, as in the middleware of
ROS 2 on Cyclone DDS. Runs on this machine only. Arguments: the domain, and the name of the arm.
`cyclone_dds_cell.py` adds a gripper and a camera."""

import os
import sys
import time
from dataclasses import dataclass

DOMAIN, NAME = int(sys.argv[1]), sys.argv[2]
os.environ["CYCLONEDDS_URI"] = """<CycloneDDS><Domain Id="any">
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import IdlStruct  # noqa: E402
from cyclonedds.idl.annotations import final  # noqa: E402
from cyclonedds.idl.types import array, float64, int8, int32, int64, sequence, uint8, uint16, uint32  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402

JOINTS = ["right_j0", "right_j1"]
REPORTED = JOINTS + ["right_k1"]
EXECUTED, CANCELLED = 4, 5
TAKEN, UNKNOWN = 0, 2
Identifier = array[uint8, 16]


def message(kind):
    return final(dataclass(kind))


@message
class Time(IdlStruct):
    sec: int32 = 0
    nanosec: uint32 = 0

    def seconds(self):
        return self.sec + 1e-9 * self.nanosec


@message
class Header(IdlStruct):
    stamp: Time
    frame_id: str


@message
class Point(IdlStruct):
    positions: sequence[float64]
    velocities: sequence[float64]
    accelerations: sequence[float64]
    effort: sequence[float64]
    time_from_start: Time


@message
class Trajectory(IdlStruct):
    header: Header
    joint_names: sequence[str]
    points: sequence[Point]


@message
class Transform(IdlStruct):
    translation: array[float64, 3]
    rotation: array[float64, 4]


@message
class Twist(IdlStruct):
    linear: array[float64, 3]
    angular: array[float64, 3]


@message
class MultiDofPoint(IdlStruct):
    transforms: sequence[Transform]
    velocities: sequence[Twist]
    accelerations: sequence[Twist]
    time_from_start: Time


@message
class MultiDofTrajectory(IdlStruct):
    header: Header
    joint_names: sequence[str]
    points: sequence[MultiDofPoint]


@message
class Tolerance(IdlStruct):
    name: str
    position: float64
    velocity: float64
    acceleration: float64


@message
class ComponentTolerance(IdlStruct):
    joint_name: str
    component: uint16
    position: float64
    velocity: float64
    acceleration: float64


@message
class Goal(IdlStruct):
    trajectory: Trajectory
    multi_dof_trajectory: MultiDofTrajectory
    path_tolerance: sequence[Tolerance]
    component_path_tolerance: sequence[ComponentTolerance]
    goal_tolerance: sequence[Tolerance]
    component_goal_tolerance: sequence[ComponentTolerance]
    goal_time_tolerance: Time


@message
class Name(IdlStruct):
    client: array[uint8, 8]
    number: int64


ACTIONS = "control_msgs.action.dds_.FollowJointTrajectory_"


@message
class SendGoalRequest(IdlStruct, typename=f"{ACTIONS}SendGoal_Request_"):
    request: Name
    goal_id: Identifier
    goal: Goal


@message
class SendGoalResponse(IdlStruct, typename=f"{ACTIONS}SendGoal_Response_"):
    request: Name
    accepted: bool
    stamp: Time


@message
class GetResultRequest(IdlStruct, typename=f"{ACTIONS}GetResult_Request_"):
    request: Name
    goal_id: Identifier


@message
class GetResultResponse(IdlStruct, typename=f"{ACTIONS}GetResult_Response_"):
    request: Name
    status: int8
    error_code: int32
    error_string: str


@message
class GoalInfo(IdlStruct):
    goal_id: Identifier
    stamp: Time


@message
class CancelRequest(IdlStruct, typename="action_msgs.srv.dds_.CancelGoal_Request_"):
    request: Name
    goal_info: GoalInfo


@message
class CancelResponse(IdlStruct, typename="action_msgs.srv.dds_.CancelGoal_Response_"):
    request: Name
    return_code: int8
    goals_canceling: sequence[GoalInfo]


@message
class Feedback(IdlStruct, typename=f"{ACTIONS}FeedbackMessage_"):
    goal_id: Identifier
    header: Header
    joint_names: sequence[str]
    desired: Point
    actual: Point
    error: Point


@message
class JointState(IdlStruct, typename="sensor_msgs.msg.dds_.JointState_"):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


participant = DomainParticipant(DOMAIN)
RELIABLE = Qos(Policy.Reliability.Reliable(100_000_000), Policy.Durability.Volatile, Policy.History.KeepLast(10))
BEST_EFFORT = Qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, Policy.History.KeepLast(10))
HEADER = Header(Time(), "")
NOWHERE = Point([], [], [], [], Time())


def publisher(topic, kind, quality):
    return DataWriter(participant, Topic(participant, topic, kind, qos=quality), qos=quality)


class Service:
    def __init__(self, action, what, request, response):
        name = f"{NAME}/{action}/_action/{what}"
        topic = Topic(participant, f"rq/{name}Request", request, qos=RELIABLE)
        self.reader = DataReader(participant, topic, qos=RELIABLE)
        self.writer = publisher(f"rr/{name}Reply", response, RELIABLE)

    def requests(self):
        return [sample for sample in self.reader.take(10) if sample.sample_info.valid_data]


# A fault of the server, by the environment: false-end (it reports success at once, while the arm stands still), false-cancel (it confirms
# a cancellation, while the arm keeps moving), flood (the arm stands still after 2 s, with 5,000 reports a second).
FAULT = os.environ.get("ARM_FAULT")


class Arm:
    """Reported joints with their positions; goals move the joints in `joints`."""

    def __init__(self, joints, reported):
        action = "follow_joint_trajectory"
        self.send_goal = Service(action, "send_goal", SendGoalRequest, SendGoalResponse)
        self.get_result = Service(action, "get_result", GetResultRequest, GetResultResponse)
        self.cancel_goal = Service(action, "cancel_goal", CancelRequest, CancelResponse)
        self.feedback = publisher(f"rt/{NAME}/follow_joint_trajectory/_action/feedback", Feedback, RELIABLE)
        self.states = publisher(f"rt/{NAME}/joint_states", JointState, BEST_EFFORT)
        self.joints = joints
        self.position = dict(reported)
        self.goal_id = None
        self.ended = None
        self.asked = []
        # With false-cancel: the motion that does not end with its goal.
        self.moves_on = False

    def answer(self):
        for one in self.send_goal.requests():
            trajectory = one.goal.trajectory
            takes = sorted(trajectory.joint_names) == sorted(self.joints)
            self.send_goal.writer.write(SendGoalResponse(one.request, takes, Time()))
            if takes:
                if self.goal_id is not None:
                    self.end(CANCELLED)
                    self.tell()
                self.goal_id, self.trajectory = list(one.goal_id), trajectory
                self.begin, self.reached, self.feedbacks = time.monotonic(), 0, 0
                self.first = dict(self.position)
                if FAULT == "false-end":
                    self.end(EXECUTED)
        self.asked += self.get_result.requests()
        for one in self.cancel_goal.requests():
            ours = self.goal_id is not None and list(one.goal_info.goal_id) == self.goal_id
            self.cancel_goal.writer.write(CancelResponse(one.request, TAKEN if ours else UNKNOWN, []))
            if ours:
                print("cancelled", flush=True)
                self.end(CANCELLED)
                self.moves_on = FAULT == "false-cancel"

    def move(self):
        points = self.trajectory.points
        elapsed = time.monotonic() - self.begin
        while self.reached < len(points):
            due = points[self.reached].time_from_start
            if due.seconds() > elapsed:
                break
            self.position.update(zip(self.trajectory.joint_names, points[self.reached].positions))
            self.reached += 1
        if self.reached == 0:
            # If the first point is later than zero, the joints move to it first.
            part = elapsed / due.seconds()
            for joint, place in zip(self.trajectory.joint_names, points[0].positions):
                self.position[joint] = self.first[joint] + part * (place - self.first[joint])

    def follow(self):
        points = self.trajectory.points
        is_stuck = FAULT == "flood" and time.monotonic() - self.begin > 2.0
        if is_stuck:
            for _ in range(50):
                self.report()
        else:
            self.move()
        self.feedback.write(Feedback(self.goal_id, HEADER, self.trajectory.joint_names, NOWHERE, NOWHERE, NOWHERE))
        self.feedbacks += 1
        if self.reached == len(points):
            where = [self.position[joint] for joint in self.joints]
            print("followed", len(points), self.feedbacks, *where, flush=True)
            self.end(EXECUTED)

    def end(self, status):
        ended, self.goal_id = self.goal_id, None
        self.ended = (ended, status)

    def tell(self):
        """Send results to the clients that have requested them, before or after the end."""
        for one in list(self.asked):
            if self.ended is not None and list(one.goal_id) == self.ended[0]:
                self.asked.remove(one)
                self.get_result.writer.write(GetResultResponse(one.request, self.ended[1], 0, ""))

    def live(self):
        self.answer()
        if self.goal_id is not None:
            self.follow()
        elif self.moves_on:
            self.move()
        self.tell()
        self.report()

    def report(self):
        self.states.write(JointState(HEADER, list(self.position), list(self.position.values()), [], []))


def run(*parts):
    """Update all parts at 100 Hz."""
    print("ready", flush=True)
    while True:
        begin = time.monotonic()
        for part in parts:
            part.live()
        time.sleep(max(0.0, 0.01 - (time.monotonic() - begin)))


if __name__ == "__main__":
    run(Arm(JOINTS, dict.fromkeys(REPORTED, 0.0)))
