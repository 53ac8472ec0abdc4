# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Listens to a robot that publishes the pose of its tool."""

from typing import List, Optional, Tuple

from camera_to_base.errors import CalibrationError
from camera_to_base.ros.messages import point_from_message
from camera_to_base.ros.object_listener import Listener
from geometry_msgs.msg import PointStamped, PoseStamped

# A robot publishes its pose several times a second.
_LONGEST_WAIT_S = 5.0
_MESSAGES = 5
# The robot stands still while it touches.
_LARGEST_SPREAD_CM = 0.05


class ToolListener(Listener):
    """
    Receives the tool's pose.

    :param topic: Its topic, geometry_msgs/PoseStamped, in m, in the base frame.
    """

    def __init__(self, topic: str) -> None:
        super().__init__('calibrate_robot')
        self._topic = topic
        self._poses: List[PoseStamped] = []
        self._frame_id: Optional[str] = None
        self.node.create_subscription(PoseStamped, topic, self._poses.append, 10)

    def position(self) -> Tuple[float, float]:
        """
        Wait for the next poses, and return where the tool is.

        :returns: x and y, in cm, in the frame of the messages.
        :raises CalibrationError: If no poses come, the tool moves, or their frame changes.
        """
        if not self.receive_anew(self._poses, _MESSAGES, _LONGEST_WAIT_S):
            raise CalibrationError(
                f'{len(self._poses)} poses came on the topic {self._topic} within '
                f'{_LONGEST_WAIT_S:g} s: does the robot publish geometry_msgs/PoseStamped there?')
        self._check_frame()
        points = [point_from_message(PointStamped(point=pose.pose.position))
                  for pose in self._poses[:_MESSAGES]]
        spread = max(max(axis) - min(axis) for axis in zip(*points))
        if spread > _LARGEST_SPREAD_CM:
            raise CalibrationError(
                f'the robot moves by {10 * spread:.1f} mm while its position is read: wait until '
                'it stands still')
        x, y, _ = points[-1]
        return x, y

    def _check_frame(self) -> None:
        named = {pose.header.frame_id for pose in self._poses}
        if self._frame_id is not None:
            named.add(self._frame_id)
        if len(named) > 1:
            raise CalibrationError(
                f'the poses on {self._topic} are in the frames {", ".join(sorted(named))}: all '
                "must be in the robot's base frame")
        self._frame_id = named.pop()
