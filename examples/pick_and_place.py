# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
An arm with a gripper that picks one object after the other: a template for your own node.

    python3 pick_and_place.py --ros-args -p opening_m:=0.05 -p tolerance_m:=0.003

It takes what lies at rest, is seen well enough for the gripper and fits between its fingers, looks
whether the object is really gone, and puts it down at one place. By default it moves a simulated
arm of two links, as in two_link_arm.py, with a lift, a wrist and a gripper: replace `Motions`.

Parameters, in m and s:
  opening_m, tolerance_m     how far the gripper opens; how far off its middle may be
  rest_s, rest_m, max_age_s  how long an object must have moved less than that; age of positions
  retries, search_m          how often it tries again, and how far off it looks for the object
  place_x_m, place_y_m       where objects are put down
  travel_height_m            of the fingertips above the surface, between the grasps
  upper_arm_m, forearm_m, motion_s    the simulated arm; how long each of its motions takes
"""

import argparse
from itertools import takewhile
import math
import signal
import sys
import threading
from typing import List, NamedTuple, Optional

from rcl_interfaces.msg import ParameterDescriptor
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from sensor_msgs.msg import JointState
from two_link_arm import joint_angles
from visualization_msgs.msg import MarkerArray

OBJECTS = 'objects_in_robot_base_frame'
# Markers of one frame, of the boxes and of the ellipses, that arrive within so many messages.
MOST_WAITING = 20
# After how many times rest_s it is said that nothing is picked because something is not at rest.
RESTLESS = 5


class Seen(NamedTuple):
    """
    An object in the base frame, in m and rad.

    :param yaw: The direction of its length.
    :param error: Half of the long axis of the ellipse that holds 95 % of errors.
    """

    x: float
    y: float
    yaw: float
    width: float
    height: float
    error: float

    def away(self, other: 'Seen') -> float:
        """Return the distance to another place, in m."""
        return math.dist(self[:2], other[:2])


class Look(NamedTuple):
    """
    What the camera saw on one frame.

    :param stamp: When the frame was taken, in s.
    :param objects: The largest first.
    """

    stamp: float
    objects: List[Seen]


class Motions:
    """
    Moves the simulated arm; for another arm, replace the bodies of these three methods.

    Each method returns when the arm has done it, as a call of its driver would.

    :param node: The node that publishes.
    """

    def __init__(self, node: 'PickAndPlace') -> None:
        self._node = node
        self._upper_arm = node.number('upper_arm_m', 0.16)
        self._forearm = node.number('forearm_m', 0.14)
        self._motion_s = node.number('motion_s', 0.5)
        self._joints = dict.fromkeys(('shoulder', 'elbow', 'lift', 'wrist', 'gripper'), 0.0)
        self._publisher = node.create_publisher(JointState, 'joint_states', 10)

    def reaches(self, x: float, y: float) -> bool:
        """Tell whether the gripper can be brought to a place, in m, in the base frame."""
        return joint_angles(x, y, self._upper_arm, self._forearm) is not None

    def move(self, x: float, y: float, z: float, closing: float) -> None:
        """
        Bring the gripper to a place.

        :param x: In m, in the base frame, as y.
        :param z: The height of the fingertips above the surface, in m.
        :param closing: The direction in which the fingers close, in rad, from x towards y.
        """
        shoulder, elbow = joint_angles(x, y, self._upper_arm, self._forearm)
        # Half a turn of the wrist makes no difference.
        wrist = math.remainder(closing - shoulder - elbow, math.pi)
        self._go(shoulder=shoulder, elbow=elbow, lift=z, wrist=wrist)

    def grip(self, opening: float) -> None:
        """Open or close the gripper until its fingers are so far apart, in m, or hold it."""
        self._go(gripper=opening)

    def _go(self, **goals: float) -> None:
        self._joints.update(goals)
        self._publisher.publish(JointState(
            header=self._node.header(), name=list(self._joints),
            position=list(self._joints.values())))
        self._node.pause(self._motion_s)


class PickAndPlace(Node):
    """Picks objects, and puts them down."""

    def __init__(self) -> None:
        super().__init__('pick_and_place')
        self._is_ended = threading.Event()
        self._opening = self.number('opening_m', 0.05)
        self._tolerance = self.number('tolerance_m', 0.003)
        self._max_age = self.number('max_age_s', 0.5)
        self._rest_s, self._rest_m = self.number('rest_s', 1.0), self.number('rest_m', 0.002)
        self._retries = self.number('retries', 2.0, least=0.0)
        self._search = self.number('search_m', 0.05)
        self._travel = self.number('travel_height_m', 0.12)
        self._place = [self.number('place_x_m', -0.22, least=-math.inf),
                       self.number('place_y_m', 0.10, least=-math.inf)]
        self.motions = Motions(self)
        if not self.motions.reaches(*self._place):
            raise ValueError('place_x_m and place_y_m are out of reach: '
                             f'({self._place[0]}, {self._place[1]}) m')
        self._news, self._look = threading.Condition(), Look(-math.inf, [])
        self._waiting = {'boxes': {}, 'ellipses': {}}
        # Since when each object has been where it is; places at which a pick failed or cannot be,
        # and when an object was last seen there.
        self._resting, self._given_up = [], []
        for kind in self._waiting:
            self.create_subscription(
                MarkerArray, f'{OBJECTS}/{kind}',
                lambda message, kind=kind: self._on_markers(kind, message), 10)

    def number(self, name: str, default: float, least: Optional[float] = None) -> float:
        """
        Declare a parameter, and return its value.

        :param least: None for what must be above 0.
        :raises ValueError: If it is no such number.
        """
        # rclpy refuses an integer for a parameter that is declared as a double: traceback for 1.
        descriptor = ParameterDescriptor(dynamic_typing=True, read_only=True)
        value = self.declare_parameter(name, default, descriptor).value
        if type(value) not in (int, float) or not math.isfinite(value) or not (
                value > 0 if least is None else value >= least):
            limit = ' above 0' if least is None else ' of at least 0' if least == 0 else ''
            raise ValueError(f'{name} must be a number{limit}, such as {default}, got {value!r}')
        return float(value)

    def header(self):
        """Return a header with the present time."""
        state = JointState()
        state.header.stamp = self.get_clock().now().to_msg()
        return state.header

    def pause(self, seconds: float) -> None:
        """Wait for so many seconds; :meth:`end` ends it."""
        if self._is_ended.wait(seconds):
            raise ExternalShutdownException

    def end(self) -> None:
        """Let no further motion begin."""
        self._is_ended.set()

    def run(self) -> None:
        """Pick what can be picked until the node ends."""
        while True:
            self._pick(self._next_object())

    def _pick(self, target: Seen) -> None:
        for _ in range(1 + int(self._retries)):
            before = self._look.objects
            self._grasp(target)
            left = self._still_there(target, before)
            self.motions.move(*self._place, target.height / 2, 0.0)
            self.motions.grip(self._opening)
            self.motions.move(*self._place, self._travel, 0.0)
            if left is None:
                self.get_logger().info(f'picked at ({target.x:.3f}, {target.y:.3f}) m')
                return
            self.get_logger().warning(
                f'not picked at ({target.x:.3f}, {target.y:.3f}) m: the object is at '
                f'({left.x:.3f}, {left.y:.3f}) m')
            target = self._at_rest_near(left)
            if target is None:
                return
        self._give_up(target, 'it could not be picked')

    def _grasp(self, target: Seen) -> None:
        """Approach, close, lift, and go aside, where the arm hides nothing from the camera."""
        across = target.yaw + math.pi / 2
        self.motions.grip(self._opening)
        self.motions.move(target.x, target.y, self._travel, across)
        self.motions.move(target.x, target.y, target.height / 2, across)
        self.motions.grip(max(target.width - 2 * self._tolerance, 0.0))
        self.motions.move(target.x, target.y, self._travel, across)
        self.motions.move(*self._place, self._travel, 0.0)

    def _next_object(self) -> Seen:
        """Wait until an object can be picked: the largest one that does not move."""
        restless_since = None
        while True:
            look = self._next_look(self._look.stamp)
            self._forget_given_up(look)
            for target in look.objects:
                if self._may_be_picked(target, look):
                    return target
            restless = [seen for seen in look.objects if self._rested(seen, look) < self._rest_s]
            restless_since = (restless_since or look.stamp) if restless else None
            if restless and look.stamp - restless_since > RESTLESS * self._rest_s:
                self.get_logger().warning(
                    f'the object at ({restless[0].x:.3f}, {restless[0].y:.3f}) m is not picked: '
                    f'it moves, or its position jumps, by {1000 * self._rest_m:.1f} mm or more '
                    f'within {self._rest_s} s', throttle_duration_sec=5.0)

    def _may_be_picked(self, target: Seen, look: Look) -> bool:
        if self._rested(target, look) < self._rest_s or any(
                target.away(other) < self._rest_m for other, _ in self._given_up):
            return False
        if target.width + 2 * self._tolerance > self._opening:
            self._give_up(target, f'it is {target.width:.3f} m wide, and the gripper opens '
                          f'{self._opening:.3f} m')
        elif not self.motions.reaches(target.x, target.y):
            self._give_up(target, 'it is out of reach')
        elif target.error > self._tolerance:
            self.get_logger().warning(
                f'the object at ({target.x:.3f}, {target.y:.3f}) m is known to '
                f'{1000 * target.error:.1f} mm, and the gripper needs '
                f'{1000 * self._tolerance:.1f} mm', throttle_duration_sec=5.0)
        else:
            return True
        return False

    def _forget_given_up(self, look: Look) -> None:
        # What is laid there later is another object; what is not seen on a few frames is the same.
        seen_at = [(place, look.stamp if any(
            place.away(seen) < self._rest_m for seen in look.objects) else stamp)
            for place, stamp in self._given_up]
        self._given_up = [
            (place, stamp) for place, stamp in seen_at if look.stamp - stamp <= self._rest_s]

    def _give_up(self, target: Seen, why: str) -> None:
        self._given_up = [
            one for one in self._given_up if one[0].away(target) > self._rest_m]
        self._given_up.append((target, self._look.stamp))
        self.get_logger().warning(
            f'the object at ({target.x:.3f}, {target.y:.3f}) m stays there: {why}')

    def _still_there(self, target: Seen, before: List[Seen]) -> Optional[Seen]:
        """
        Return where the object is now; None if its place, and what is around it, is empty.

        :param before: All objects before the grasp; the others stay what they are.
        """
        others = [other for other in before if other.away(target) > self._rest_m]
        now = self.get_clock().now().nanoseconds / 1e9
        for seen in sorted(self._next_look(now).objects, key=target.away):
            if seen.away(target) < self._search and all(
                    seen.away(other) > self._rest_m for other in others):
                return seen
        return None

    def _at_rest_near(self, place: Seen) -> Optional[Seen]:
        """Wait until an object near a place does not move; None if there is none any more."""
        while True:
            look = self._next_look(self._look.stamp)
            nearest = min(look.objects, key=place.away, default=place)
            if not look.objects or nearest.away(place) > self._search:
                return None
            if self._rested(nearest, look) >= self._rest_s:
                return nearest if self._may_be_picked(nearest, look) else None

    def _next_look(self, after: float) -> Look:
        """
        Wait for what the camera sees after a time, in s.

        While it sees nothing new, which is not the same as an empty surface, nothing moves.
        """
        while True:
            with self._news:
                self._news.wait(0.1)
                look = self._look
            self.pause(0.0)
            age = self.get_clock().now().nanoseconds / 1e9 - look.stamp
            if look.stamp > after and age <= self._max_age:
                return look
            if age > self._max_age:
                self.get_logger().warning(
                    f'no positions, or positions older than {self._max_age} s: the arm waits; '
                    'see /diagnostics', throttle_duration_sec=5.0)

    def _rested(self, target: Seen, look: Look) -> float:
        """Return for how long an object has been where it is, in s."""
        with self._news:
            return max((look.stamp - since for place, since in self._resting
                        if place.away(target) < self._rest_m), default=0.0)

    def _on_markers(self, kind: str, message: MarkerArray) -> None:
        # The first marker deletes the earlier ones; of an empty surface, it is the only one.
        stamp = message.markers[0].header.stamp
        stamp = stamp.sec + stamp.nanosec / 1e9
        self._waiting[kind][stamp] = [
            marker for marker in message.markers if marker.action == marker.ADD]
        if not all(stamp in waiting for waiting in self._waiting.values()):
            for waiting in self._waiting.values():
                while len(waiting) > MOST_WAITING:
                    del waiting[min(waiting)]
            return
        boxes, ellipses = (waiting.pop(stamp) for waiting in self._waiting.values())
        if stamp > self._look.stamp and len(boxes) == len(ellipses):
            self._take(Look(stamp, [seen_of(*pair) for pair in zip(boxes, ellipses)]))

    def _take(self, look: Look) -> None:
        # What was touched, hidden or moved, or not seen for too long, starts to rest anew.
        with self._news:
            known = self._resting if look.stamp - self._look.stamp <= self._max_age else []
            self._resting = [next(
                ((place, since) for place, since in known if place.away(seen) < self._rest_m),
                (seen, look.stamp)) for seen in look.objects]
            self._look = look
            self._news.notify_all()


def seen_of(box, ellipse) -> Seen:
    """Make an object of the markers of its box and of its ellipse."""
    at, lies = box.pose.position, box.pose.orientation
    return Seen(at.x, at.y, 2 * math.atan2(lies.z, lies.w), box.scale.y, box.scale.z,
                max(ellipse.scale.x, ellipse.scale.y) / 2)


def _start() -> PickAndPlace:
    try:
        # rclpy's own handlers would close the publishers in the middle of a motion.
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        return PickAndPlace()
    except (RuntimeError, ValueError) as error:  # invalid arguments
        sys.exit(f'pick_and_place: cannot start: {error}')


def main() -> None:
    """Answer --help, or pick until a signal arrives."""
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args(
            list(takewhile(lambda argument: argument != '--ros-args', sys.argv[1:])))
    node = _start()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: node.end())
    is_over = Future()
    receiving = threading.Thread(
        target=rclpy.spin_until_future_complete, args=(node, is_over), daemon=True)
    receiving.start()
    try:
        node.run()
    except ExternalShutdownException:
        pass
    finally:
        # Spinning fails if the context goes while the executor prepares to wait.
        is_over.set_result(None)
        receiving.join(2.0)
        rclpy.shutdown()


if __name__ == '__main__':
    main()
