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

"""Where on the work surface objects count: polygons in the camera frame."""

from typing import NamedTuple, Optional, Sequence, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import paper_corners
import cv2
import numpy as np

_LIMIT_CM = 1e5


class Area:
    """
    A polygon on the work surface.

    :param corners: Shape (n, 2), x and y of one corner after the other, in cm.
    :raises InvalidValueError: If they enclose no area, or if the outline crosses itself.
    """

    def __init__(self, corners: np.ndarray) -> None:
        self.corners = np.asarray(corners, float).reshape(-1, 2)
        if not np.isfinite(self.corners).all() or np.abs(self.corners).max(
                initial=0) > _LIMIT_CM:
            raise InvalidValueError(
                f'expected corners within {_LIMIT_CM:g} cm, got {self.corners.tolist()}')
        self._outline = self.corners.astype(np.float32)
        if len(self.corners) < 3 or not cv2.contourArea(self._outline) > 0:
            raise InvalidValueError(
                'expected at least three corners that are not on one line, got '
                f'{self.corners.tolist()}')
        if _crosses_itself(self.corners):
            raise InvalidValueError('expected corners in the order of the outline, but it crosses '
                                    f'itself: {self.corners.tolist()}')

    def depth(self, point: Sequence[float]) -> float:
        """Return how far inside a point lies, in cm; negative outside."""
        return cv2.pointPolygonTest(self._outline, (float(point[0]), float(point[1])), True)

    def contains(self, point: Sequence[float]) -> bool:
        """Return whether a point lies inside, or on the edge."""
        return self.depth(point) >= 0


class Areas(NamedTuple):
    """
    Where objects count.

    :param work: Only objects whose centre lies inside count; None for everywhere.
    :param ignored: Objects whose centre lies in one of these do not.
    """

    work: Optional[Area] = None
    ignored: Tuple[Area, ...] = ()

    def without_markers(self, markers: Sequence[np.ndarray]) -> 'Areas':
        """
        Ignore the areas of markers, too.

        :param markers: Each of shape (4, 2), the corners of its black square, in cm.
        """
        return self._replace(ignored=(*self.ignored, *map(Area, map(paper_corners, markers))))


def read_areas(work_area: Sequence[float], ignored_areas: str) -> Areas:
    """
    Read the areas from their parameters.

    :param work_area: x and y of one corner after the other, in cm; empty for everywhere.
    :param ignored_areas: Polygons with ; between them, corners with , between them.
    :raises InvalidValueError: If one is no polygon; the text names the parameter.
    """
    if len(work_area) % 2:
        raise InvalidValueError(
            f'work_area must be x and y in turn, got {len(work_area)} numbers')
    work = _named('work_area', np.array(work_area)) if len(work_area) else None
    texts = [text for text in ignored_areas.split(';') if text.strip()]
    return Areas(work, tuple(_named('ignored_areas', _corners(text)) for text in texts))


def _named(name: str, corners: np.ndarray) -> Area:
    try:
        return Area(corners)
    except InvalidValueError as error:
        raise InvalidValueError(f'{name}: {error}') from error


def _corners(text: str) -> np.ndarray:
    try:
        corners = [[float(number) for number in corner.split()] for corner in text.split(',')]
    except ValueError:
        corners = []
    if not corners or any(len(corner) != 2 for corner in corners):
        raise InvalidValueError(
            f"ignored_areas must be polygons as '0 0, 5 0, 5 3; 30 0, 36 0, 36 27', got '{text}'")
    return np.array(corners)


def _crosses_itself(corners: np.ndarray) -> bool:
    count = len(corners)
    sides = [(corners[index], corners[(index + 1) % count]) for index in range(count)]
    return any(_cross(*sides[one], *sides[other]) for one in range(count)
               for other in range(one + 2, count) if (other + 1) % count != one)


def _cross(start: np.ndarray, end: np.ndarray, other: np.ndarray, last: np.ndarray) -> bool:
    return (_side(start, end, other) * _side(start, end, last) < 0
            and _side(other, last, start) * _side(other, last, end) < 0)


def _side(start: np.ndarray, end: np.ndarray, point: np.ndarray) -> float:
    (along, across), (u, v) = end - start, point - start
    return along * v - across * u
