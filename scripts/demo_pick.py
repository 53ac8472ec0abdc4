# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The demo's gripper: it takes a simulated object away if it closes at its true place."""

import math
import os
import sys

# What examples/pick_and_place.py starts with: the arm, and how far off the gripper may be.
UPPER_ARM_M, FOREARM_M, TOLERANCE_M = 0.16, 0.14, 0.003
EXAMPLE = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'examples',
                       'pick_and_place.py')
CAMERA = 'camera_publisher'
OBJECT_COUNT = 5


class TrueBox:
    """
    The true box of an object, in the base frame, in m and rad.

    :param x: Its middle.
    :param yaw: The direction of its length.
    """

    def __init__(self, x, y, yaw, length, width, height):
        self.x, self.y, self.yaw = x, y, yaw
        self.length, self.width, self.height = length, width, height

    def extent(self, direction):
        """Return how wide it is along a direction, in rad."""
        turn = direction - self.yaw
        return abs(self.length * math.cos(turn)) + abs(self.width * math.sin(turn))


class SimulatedGripper:
    """
    Follows an arm's joints, and holds what its fingers really close on.

    :param tolerance: How far its middle may be from that of an object, in m.
    """

    def __init__(self, tolerance=TOLERANCE_M):
        self._tolerance = tolerance
        self._opening = 0.0
        self.held = None

    def follow(self, joints, objects):
        """
        Move to other joints.

        :param joints: By name, in rad and m, as pick_and_place.py publishes them.
        :param objects: The true boxes by number, of what lies on the table.
        :returns: What has happened: 'caught', 'missed', 'put down' or None; and for the first two
            how far the nearest object was from the gripper, in m.
        """
        before, self._opening = self._opening, joints['gripper']
        if self._opening > before and self.held is not None:
            self.held = None
            return 'put down', None
        if self._opening >= before or self.held is not None or not objects:
            return None, None
        x, y = tip(joints['shoulder'], joints['elbow'])
        number = min(objects, key=lambda one: math.dist((x, y), (objects[one].x, objects[one].y)))
        box = objects[number]
        away = math.dist((x, y), (box.x, box.y))
        across = box.extent(joints['shoulder'] + joints['elbow'] + joints['wrist'])
        if away <= self._tolerance and joints['lift'] < box.height and (
                self._opening < across <= before):
            self.held = number
            return 'caught', away
        return 'missed', away


class Picks:
    """
    Lays solid objects on the simulated table, and counts what the arm picks of them.

    :param node: The demo's node.
    :param terminal: Where it is printed.
    """

    def __init__(self, node, terminal):
        from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
        from rcl_interfaces.srv import SetParameters
        from sensor_msgs.msg import JointState
        from visualization_msgs.msg import MarkerArray
        # Of the simulated camera's true positions, whatever the calibration is.
        self._true_conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
        self._gripper, self._objects = SimulatedGripper(), {}
        self._taken, self._layout = [], 0
        self.tries = self.successes = 0
        self._say = terminal.say
        self._client = node.create_client(SetParameters, f'{CAMERA}/set_parameters')
        node.create_subscription(
            MarkerArray, 'true_objects_in_cam_frame/boxes', self._on_boxes, 10)
        node.create_subscription(JointState, 'joint_states', self._on_joints, 100)

    @staticmethod
    def arm_command():
        """Return the command that runs the arm's node."""
        return [sys.executable, EXAMPLE]

    def close(self):
        """Print the count."""
        self._say(f'==> {self.successes} of {self.tries} picks succeeded')

    def _on_boxes(self, message):
        boxes = [self._true_box(marker) for marker in message.markers
                 if marker.action == marker.ADD]
        numbers = [number for number in range(1, OBJECT_COUNT + 1) if number not in self._taken]
        # Frames that were on the way when the table was changed show another number of objects.
        if len(boxes) == len(numbers):
            self._objects = dict(zip(numbers, boxes))

    def _true_box(self, marker):
        at, lies, size = marker.pose.position, marker.pose.orientation, marker.scale
        x, y, _ = self._true_conversion.convert_point(100 * at.x, 100 * at.y)
        # The base frame is turned by half a turn about x.
        return TrueBox(x / 100, y / 100, -2 * math.atan2(lies.z, lies.w), size.x, size.y, size.z)

    def _on_joints(self, message):
        what, away = self._gripper.follow(
            dict(zip(message.name, message.position)), self._objects)
        if what == 'put down':
            if len(self._taken) == OBJECT_COUNT:
                self._lay_out_anew()
            return
        if what is None:
            return
        self.tries += 1
        self.successes += what == 'caught'
        self._say(f'==> {"pick" if what == "caught" else "miss"} {self.tries}: the gripper closed '
                  f'{1000 * away:.2f} mm from the true place; {self.successes} of {self.tries} '
                  'picks succeeded')
        if what == 'caught':
            del self._objects[self._gripper.held]
            self._taken.append(self._gripper.held)
            self._change(taken=self._taken)

    def _lay_out_anew(self):
        self._layout, self._taken, self._objects = self._layout + 1, [], {}
        self._change(layout=self._layout, taken=[0])

    def _change(self, **values):
        from rcl_interfaces.srv import SetParameters
        from rclpy.parameter import Parameter
        self._client.call_async(SetParameters.Request(parameters=[
            Parameter(f'simulated.{name}', value=value).to_parameter_msg()
            for name, value in values.items()]))


def tip(shoulder, elbow):
    """Return where the arm's tip is, x and y, in m."""
    return (UPPER_ARM_M * math.cos(shoulder) + FOREARM_M * math.cos(shoulder + elbow),
            UPPER_ARM_M * math.sin(shoulder) + FOREARM_M * math.sin(shoulder + elbow))
