"""An arm of two joints behind actionlib's own action server: follows its trajectory, and reports its joints at 100 Hz. A camera
above it sees a dark rod, 200 pixels long, as pixels and as PNG files. It prints the diagnostics of others. Its safety signals are a latched
emergency stop, a wrench, a heartbeat and a speed in per cent. With ARM_FAULT=false-end in the environment it reports success at once and stands still; with
ARM_FAULT=false-cancel it confirms a cancellation, but keeps moving; with "pressed", "emergency-stop", "force", "effort" or "silent" its
signals violate their limits, the first one from the beginning and the others one second after the start of a motion; with "slow" the
speed falls to 40 % at that time."""

import bisect
import os
import struct
import threading
import zlib

import actionlib
import rospy
from control_msgs.msg import FollowJointTrajectoryAction, FollowJointTrajectoryFeedback, FollowJointTrajectoryResult
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import CompressedImage, Image, JointState
from std_msgs.msg import Bool, Empty, Float64

JOINTS = ["right_j0", "right_j1"]
FAULT = os.environ.get("ARM_FAULT")
REPORTED = JOINTS + ["right_k1"]
position = dict.fromkeys(REPORTED, 0.0)
# Time of the violation of a signal.
violated = None


def is_due(fault):
    """Whether a signal violates its limits."""
    global violated
    motion = arm.motion
    due = FAULT == fault and motion is not None and (rospy.Time.now() - motion[2]).to_sec() > 1.0
    if due and violated is None:
        violated = rospy.Time.now()
    return due


def signal():
    stops = rospy.Publisher("/emergency_stop", Bool, queue_size=10, latch=True)
    wrenches = rospy.Publisher("/wrist/wrench", WrenchStamped, queue_size=10)
    beats = rospy.Publisher("/heartbeat", Empty, queue_size=10)
    speeds = rospy.Publisher("/speed_scaling", Float64, queue_size=10)
    stops.publish(FAULT == "pressed")
    began = None
    rate = rospy.Rate(100)
    has_stopped = False
    while not rospy.is_shutdown():
        if is_due("emergency-stop") and not has_stopped:
            # A short press.
            has_stopped = True
            stops.publish(True)
            stops.publish(False)
        wrench = WrenchStamped()
        wrench.header.stamp = rospy.Time.now()
        wrench.wrench.force.z = -30.0 if is_due("force") else 2.0
        wrenches.publish(wrench)
        if arm.motion is not None and began is None:
            began = rospy.Time.now()
        is_slow = FAULT == "slow" and began is not None and (rospy.Time.now() - began).to_sec() > 1.0
        speeds.publish(40.0 if is_slow else 100.0)
        if not is_due("silent"):
            beats.publish()
        rate.sleep()


def report():
    publisher = rospy.Publisher("/robot/joint_states", JointState, queue_size=10)
    rate = rospy.Rate(100)
    while not rospy.is_shutdown():
        efforts = [50.0 if is_due("effort") else 1.0] * len(position)
        message = JointState(name=list(position), position=list(position.values()), effort=efforts)
        message.header.stamp = rospy.Time.now()
        publisher.publish(message)
        rate.sleep()


def read_diagnostics(message):
    for status in message.status:
        values = "; ".join(f"{pair.key}: {pair.value}" for pair in status.values)
        print(f"{status.name}, level {status.level}: {status.message} ({values})", flush=True)


def look():
    width, height = 320, 240
    white, rod = bytes([240] * 3 * width), bytes([240] * 3 * 60 + [20, 25, 30] * 200 + [240] * 3 * 60)
    rows = [rod if 117 <= v < 123 else white for v in range(height)]

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + row for row in rows))
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    raw = Image(height=height, width=width, encoding="bgr8", step=3 * width, data=b"".join(rows))
    compressed = CompressedImage(format="png", data=png)
    raws = rospy.Publisher("/camera/image_raw", Image, queue_size=1)
    files = rospy.Publisher("/camera/image_raw/compressed", CompressedImage, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        raw.header.stamp = compressed.header.stamp = rospy.Time.now()
        raws.publish(raw)
        files.publish(compressed)
        rate.sleep()


class Arm:
    def __init__(self):
        # Times and points of the current trajectory, initial joint positions, and its start.
        self.motion = None
        self.server = actionlib.SimpleActionServer(
            "/robot/limb/right/follow_joint_trajectory", FollowJointTrajectoryAction, self.follow, auto_start=False
        )
        self.server.start()
        threading.Thread(target=self.move, daemon=True).start()

    def move(self):
        rate = rospy.Rate(100)
        while not rospy.is_shutdown():
            motion = self.motion
            if motion is not None:
                times, points, begin = motion
                position.update(zip(JOINTS, at((rospy.Time.now() - begin).to_sec(), times, points)))
            rate.sleep()

    def follow(self, goal):
        trajectory = goal.trajectory
        if sorted(trajectory.joint_names) != JOINTS:
            result = FollowJointTrajectoryResult(error_code=FollowJointTrajectoryResult.INVALID_JOINTS)
            self.server.set_aborted(result, "unknown joints")
            return
        if FAULT == "false-end":
            self.server.set_succeeded(FollowJointTrajectoryResult())
            return
        begin = rospy.Time.now()
        times = [point.time_from_start.to_sec() for point in trajectory.points]
        order = [trajectory.joint_names.index(joint) for joint in JOINTS]
        points = [[point.positions[joint] for joint in order] for point in trajectory.points]
        if times[0] > 0.0:
            times, points = [0.0] + times, [[position[joint] for joint in JOINTS]] + points
        self.motion = times, points, begin
        rate = rospy.Rate(100)
        feedbacks = 0
        while not rospy.is_shutdown():
            if self.server.is_preempt_requested():
                # The next goal, if there is one, starts from the joint positions at that time.
                if FAULT != "false-cancel" and not self.server.is_new_goal_available():
                    self.motion = None
                print("preempted", flush=True)
                if violated is not None:
                    print(f"{(rospy.Time.now() - violated).to_sec() * 1e3:.1f} ms after the violation", flush=True)
                self.server.set_preempted()
                return
            if (rospy.Time.now() - begin).to_sec() > times[-1] and list(position.values())[:2] == points[-1]:
                break
            self.server.publish_feedback(FollowJointTrajectoryFeedback(joint_names=trajectory.joint_names))
            feedbacks += 1
            rate.sleep()
        print("followed", len(trajectory.points), feedbacks, position["right_j0"], position["right_j1"], flush=True)
        self.server.set_succeeded(FollowJointTrajectoryResult())


def at(time, times, points):
    """Joint positions at a time, linearly interpolated."""
    after = bisect.bisect_right(times, time)
    if after in (0, len(times)):
        return points[min(after, len(times) - 1)]
    part = (time - times[after - 1]) / (times[after] - times[after - 1])
    return [p + part * (q - p) for p, q in zip(points[after - 1], points[after])]


rospy.init_node("arm", disable_signals=True)
arm = Arm()
diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, read_diagnostics)
for task in (report, look, signal):
    threading.Thread(target=task, daemon=True).start()
print("ready", flush=True)
threading.Event().wait()
