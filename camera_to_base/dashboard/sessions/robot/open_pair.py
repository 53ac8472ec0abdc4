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

"""The pair that is being measured: first the object is seen, then the robot touches it."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.calibration import FRAMES, Place
from camera_to_base.dashboard.sessions.robot.data import PixelOf, point_data
from camera_to_base.dashboard.sessions.robot.followed_object import FollowedObject, Point
from camera_to_base.dashboard.sessions.robot.pair_list import MeasuredWith


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
