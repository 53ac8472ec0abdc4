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

"""Where the robot's tool is, from the poses that its driver publishes."""

from collections import deque
import re
import time
from typing import Any, Deque, Dict, Tuple

from camera_to_base.errors import CalibrationError, InvalidValueError

# The robot stands still while it touches; its driver publishes several poses a second.
_POSES = 5
_LARGEST_SPREAD_CM = 0.05
_OLD_S = 5.0
# A stamp that is older is of another clock.
_LONGEST_WAY_S = 30.0
_NAME = re.compile(r'/?[A-Za-z_~{][\w/{}~]*')


class ToolPlace:
    """
    Keeps the newest poses.

    `topic` is the topic that is listened to, '' for none.
    """

    def __init__(self) -> None:
        self.topic = ''
        self._frame_id = ''
        self._forgotten_at = 0.0
        self._poses: Deque[Tuple[float, float, float]] = deque(maxlen=_POSES)

    @property
    def data(self) -> Dict[str, Any]:
        """The state as JSON."""
        position = None
        if self._poses:
            x, y, _ = self._poses[-1]
            position = {'x': round(x, 2), 'y': round(y, 2)}
        return {'topic': self.topic, 'position': position}

    def listen(self, topic: Any) -> bool:
        """
        Listen to a topic.

        :param topic: Its name; None for the one of before.
        :returns: Whether it is another one.
        :raises InvalidValueError: If it is no topic's name.
        """
        if topic is None and not self.topic:
            raise InvalidValueError(
                "name the topic of the robot's tool, of type geometry_msgs/PoseStamped")
        if topic is None or topic == self.topic:
            return False
        if not isinstance(topic, str) or not _NAME.fullmatch(topic):
            raise InvalidValueError(f"'{topic!s:.80}' is no name of a topic")
        self.topic, self._frame_id = topic, ''
        self._poses.clear()
        return True

    def forget(self) -> None:
        """Forget the poses so far, and those that are still on their way."""
        self._forgotten_at = time.time()
        self._poses.clear()

    def see(self, x: float, y: float, frame_id: str = '', stamp_s: float = 0.0) -> None:
        """
        Take a pose.

        :param x: In cm, in the frame of the message; y, too.
        :param stamp_s: When it was measured; 0 if it is not known.
        """
        if 0 < self._forgotten_at - stamp_s < _LONGEST_WAY_S:
            return
        if frame_id != self._frame_id:
            self._frame_id = frame_id
            self._poses.clear()
        self._poses.append((x, y, time.monotonic()))

    def place(self) -> Tuple[float, float]:
        """
        Return where the tool is.

        :returns: x and y, in cm.
        :raises CalibrationError: If no poses come, or it moves.
        """
        fresh = [pose for pose in self._poses if time.monotonic() - pose[2] < _OLD_S]
        if len(fresh) < _POSES:
            raise CalibrationError(
                f'{len(fresh)} poses came on {self.topic} within {_OLD_S:g} s, {_POSES} are '
                'needed: does the robot publish geometry_msgs/PoseStamped there? Try again')
        spread = max(max(axis) - min(axis) for axis in list(zip(*fresh))[:2])
        if spread > _LARGEST_SPREAD_CM:
            raise CalibrationError(
                f'the robot moves by {10 * spread:.1f} mm while its position is read: wait until '
                'it stands still')
        return fresh[-1][:2]
