# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A planar arm with two links that points at the object: a template for your own node.

    python3 two_link_arm.py --ros-args -p upper_arm_m:=0.16 -p forearm_m:=0.14

Both angles are counter-clockwise: the shoulder's from the base frame's x, the elbow's from the
upper arm. Of the two solutions it takes the one with a positive elbow angle.
"""

import argparse
from itertools import takewhile
import math
import sys
from typing import Optional, Tuple

from geometry_msgs.msg import PointStamped
from rcl_interfaces.msg import ParameterDescriptor
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


def joint_angles(
    x: float, y: float, upper_arm: float, forearm: float
) -> Optional[Tuple[float, float]]:
    """
    Compute the angles of shoulder and elbow that bring the arm's tip to a point, in rad.

    :param x: In the base frame, whose origin is the shoulder; in m, as all lengths.
    :param y: In the base frame.
    :returns: None for a point out of reach (always, if the arm has no length), or with NaN.
    """
    # Law of cosines in the triangle of shoulder, elbow and tip.
    along, most = x * x + y * y - upper_arm ** 2 - forearm ** 2, 2 * upper_arm * forearm
    if not abs(along) < most:
        return None
    elbow = math.acos(along / most)
    tip_x, tip_y = upper_arm + forearm * math.cos(elbow), forearm * math.sin(elbow)
    shoulder = math.atan2(y, x) - math.atan2(tip_y, tip_x)
    return math.remainder(shoulder, math.tau), elbow


class TwoLinkArm(Node):
    """Publishes joint angles for each point that the camera sees within the arm's reach."""

    def __init__(self) -> None:
        super().__init__('two_link_arm')
        self._upper_arm = self._length('upper_arm_m', 0.16)
        self._forearm = self._length('forearm_m', 0.14)
        self._publisher = self.create_publisher(JointState, 'joint_states', 10)
        self.create_subscription(
            PointStamped, 'pos_in_robot_base_frame/point', self._on_point, 10)

    def _length(self, name: str, default: float) -> float:
        # rclpy refuses an integer for a parameter that is declared as a double: traceback for 1.
        descriptor = ParameterDescriptor(dynamic_typing=True, read_only=True)
        value = self.declare_parameter(name, default, descriptor).value
        if type(value) not in (int, float) or not 0 < value < math.inf:
            raise ValueError(
                f'{name} must be a length above 0 m, such as {default}, got {value!r}')
        return float(value)

    def _on_point(self, message: PointStamped) -> None:
        x, y = message.point.x, message.point.y
        angles = joint_angles(x, y, self._upper_arm, self._forearm)
        if angles is None:
            self.get_logger().warning(
                f'({x:.3f}, {y:.3f}) m is out of reach: the arm stays where it is',
                throttle_duration_sec=5.0)
            return
        state = JointState(name=['shoulder', 'elbow'], position=angles)
        state.header.stamp = message.header.stamp
        self._publisher.publish(state)


def _start() -> TwoLinkArm:
    try:
        rclpy.init()
        return TwoLinkArm()
    except (RuntimeError, ValueError) as error:  # invalid arguments
        sys.exit(f'two_link_arm: cannot start: {error}')


def main() -> None:
    """Answer --help, or run the node until a signal arrives."""
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args(
            list(takewhile(lambda argument: argument != '--ros-args', sys.argv[1:])))
    try:
        rclpy.spin(_start())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except RuntimeError:  # ended between two waits
        if rclpy.ok():
            raise
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
