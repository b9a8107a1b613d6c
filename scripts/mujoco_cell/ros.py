"""The cell as a node of ROS 1: joints, actions of arms and grippers, the clock, pictures."""

import threading

import actionlib
import rospy
from control_msgs.msg import (
    FollowJointTrajectoryAction,
    FollowJointTrajectoryFeedback,
    FollowJointTrajectoryResult,
    GripperCommandAction,
    GripperCommandResult,
)
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, JointState

from .camera import Camera

# Time between two reports of the joints, s.
REPORT = 0.01
# Time between two polls of a goal, s of wall time.
LOOK = 0.01
# Fingers that are to come nearer than this, m, close; they take so long, s.
CLOSED = 0.02
FINGERS = 0.5


class Node:
    """Publishes the state of the simulation, and passes goals of actions to it."""

    def __init__(self, simulation, pictures):
        self.simulation, self.pictures = simulation, pictures
        # Nodes that read this parameter use the clock of the simulation.
        rospy.set_param("/use_sim_time", True)
        self.clock = rospy.Publisher("/clock", Clock, queue_size=1)
        self.joints = rospy.Publisher("/robot/joint_states", JointState, queue_size=10)
        self.images = rospy.Publisher("/camera/image_raw", Image, queue_size=1)
        self.reported = -REPORT
        self.actions = [action for arm in simulation.arms for action in (FollowAction(simulation, arm), GripAction(simulation, arm))]
        threading.Thread(target=self.look, daemon=True).start()

    def report(self, time):
        """Publishes the time and the joints when they are due; returns whether to continue."""
        if time - self.reported >= REPORT - 1e-9:
            self.reported = time
            stamp = rospy.Time.from_sec(time)
            arms = self.simulation.arms
            message = JointState(
                name=[name for arm in arms for name in arm.names],
                position=[position for arm in arms for position in arm.positions()],
            )
            message.header.stamp = stamp
            self.joints.publish(message)
            self.clock.publish(Clock(stamp))
        return not rospy.is_shutdown()

    def look(self):
        """Publishes pictures while the topic has subscribers."""
        camera = Camera(self.simulation)
        pause = threading.Event()
        while not pause.wait(1.0 / self.pictures):
            if self.images.get_num_connections() == 0:
                continue
            time, pixels = camera.picture()
            height, width, _ = pixels.shape
            message = Image(height=height, width=width, encoding="rgb8", step=3 * width, data=pixels.tobytes())
            message.header.stamp, message.header.frame_id = rospy.Time.from_sec(time), "camera"
            self.images.publish(message)


class FollowAction:
    """`control_msgs/FollowJointTrajectory` of an arm."""

    def __init__(self, simulation, arm):
        self.simulation, self.arm = simulation, arm
        name = f"/robot/limb/{arm.side}/follow_joint_trajectory"
        self.server = actionlib.SimpleActionServer(name, FollowJointTrajectoryAction, self.follow, auto_start=False)
        self.server.start()

    def follow(self, goal):
        names = list(goal.trajectory.joint_names)
        points = [(p.time_from_start.to_sec(), list(p.positions), list(p.velocities)) for p in goal.trajectory.points]
        with self.simulation.lock:
            refusal = self.arm.refusal(names, points)
            motion = None if refusal else self.arm.follow(names, points)
        if refusal:
            code, words = refusal
            self.server.set_aborted(FollowJointTrajectoryResult(error_code=code, error_string=words), words)
            return
        print(f"{self.arm.side}: follows {len(points)} points over {points[-1][0]:.2f} s", flush=True)
        while not motion.ended.wait(LOOK):
            if self.server.is_preempt_requested() or rospy.is_shutdown():
                with self.simulation.lock:
                    self.arm.stop()
                print(f"{self.arm.side}: stopped", flush=True)
                self.server.set_preempted()
                return
            self.server.publish_feedback(FollowJointTrajectoryFeedback(joint_names=names))
        result = FollowJointTrajectoryResult(error_code=motion.code, error_string=motion.words)
        if motion.code == FollowJointTrajectoryResult.SUCCESSFUL:
            print(f"{self.arm.side}: is there", flush=True)
            self.server.set_succeeded(result)
        else:
            print(f"{self.arm.side}: {motion.words}", flush=True)
            self.server.set_aborted(result, motion.words)


class GripAction:
    """`control_msgs/GripperCommand` of an arm."""

    def __init__(self, simulation, arm):
        self.simulation, self.arm = simulation, arm
        name = f"/robot/limb/{arm.side}/gripper"
        self.server = actionlib.SimpleActionServer(name, GripperCommandAction, self.grip, auto_start=False)
        self.server.start()

    def grip(self, goal):
        opening = goal.command.position
        self.simulation.wait(FINGERS)
        if opening < CLOSED:
            refusal = self.simulation.take(self.arm)
            if refusal:
                print(f"{self.arm.side}: {refusal}", flush=True)
                self.server.set_aborted(GripperCommandResult(position=opening), refusal)
                return
            print(f"{self.arm.side}: holds the cable", flush=True)
        else:
            self.simulation.release(self.arm)
            print(f"{self.arm.side}: lets go", flush=True)
        closes = opening < CLOSED
        self.server.set_succeeded(GripperCommandResult(position=opening, stalled=closes, reached_goal=not closes))
