# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The pair that is being measured: its object is seen, then touched where the tool is."""

from collections import deque
import re
import time
from typing import Any, Deque, Dict, List, Optional, Sequence, Tuple

from camera_to_base.calibration import FRAMES, Place
from camera_to_base.dashboard.sessions.pairs import (
    FollowedObject, MeasuredWith, PixelOf, Point, point_data)
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


class OpenPair:
    """
    Follows the object until its place is known.

    `place` is None until then; `marker` is its number in place of an object.

    :param number: The pair's.
    :param point: Where the object is looked for, in cm, in the camera frame.
    :param measured_with: What that point depends on.
    """

    def __init__(self, number: int, point: Point, measured_with: MeasuredWith) -> None:
        self.number, self.measured_with = number, measured_with
        self._object = FollowedObject(point)
        self.place: Optional[Place] = None
        self.marker: Optional[int] = None

    @classmethod
    def of_marker(
        cls, number: int, marker: int, place: Place, measured_with: MeasuredWith
    ) -> 'OpenPair':
        """Make the pair of a marker, whose place is known already."""
        pair = cls(number, (place.x, place.y), measured_with)
        pair.place, pair.marker = place, marker
        return pair

    def see(self, points: Sequence[Point]) -> bool:
        """
        Take the objects of the next frame.

        :returns: Whether they were needed.
        :raises CalibrationError: If it was the last frame, and the object has no place.
        """
        if self.place is not None:
            return False
        self._object.see(points)
        if self._object.is_complete:
            self.place = self._object.place()
        return True

    def tell_background(self, mark: Any) -> None:
        """Say with which background it is measured, which was not known."""
        self.measured_with = self.measured_with._replace(background=mark)

    def nearest(self, points: List[Point]) -> Optional[Point]:
        """Return the object among all; None if it is not there."""
        return self._object.nearest(points)

    def data(self, pixel_of: PixelOf) -> Dict[str, Any]:
        """Describe it as JSON; `pixel_of` gives the pixel of a point."""
        count, place = self._object.frame_count, self.place
        data = {'number': self.number, 'frames': count, 'of': FRAMES}
        if place is None:
            return {**data, 'camera': None, 'pixel': pixel_of(self._object.point),
                    'sentence': f'{count} of {FRAMES} frames'}
        if self.marker is not None:
            return {**data, 'frames': FRAMES, 'camera': point_data((place.x, place.y)),
                    'pixel': pixel_of((place.x, place.y)),
                    'sentence': f'marker {self.marker} lies at ({place.x:.2f}, {place.y:.2f}) cm '
                                'in the camera frame: touch the cross in its middle'}
        return {**data, 'camera': point_data((place.x, place.y)),
                'pixel': pixel_of((place.x, place.y)),
                'sentence': f'seen at ({place.x:.2f}, {place.y:.2f}) cm in the camera frame, in '
                            f'{place.frame_count} frames, spread {10 * place.spread_cm:.2f} mm'}
