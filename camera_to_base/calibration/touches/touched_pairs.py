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

"""Pairs of points: objects that the camera has seen and the robot has touched."""

import csv
import io
import math
from typing import Any, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration.base_calibration import calibrate_base
from camera_to_base.calibration.result import Calibration
from camera_to_base.calibration.tables import PAIR_COLUMNS, read_pairs
from camera_to_base.calibration.touches.touch_plan import Suggestion
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface import PointPairs
import numpy as np

# Of the distance that the camera sees between two places; a robot that was touched right is off
# by a small part of it.
_LEAST_SHARE = 0.25
# The last column says with which surface the camera points were measured.
_COLUMNS = (*PAIR_COLUMNS, 'surface')


class TouchedPair(NamedTuple):
    """
    A place of the object in both frames.

    :param suggestion: Where it was to be put.
    :param camera_point: x and y, in cm, in the camera frame.
    :param base_point: x and y, in cm, in the base frame.
    """

    suggestion: Suggestion
    camera_point: Tuple[float, float]
    base_point: Tuple[float, float]


def point_pairs(pairs: Sequence[TouchedPair], rows: Sequence[int] = ()) -> PointPairs:
    """
    Return the points of pairs, which lie on the surface and on the table of the base frame.

    :param rows: What messages call the pairs; 1 to n by default.
    """
    camera = [(*pair.camera_point, 0.0) for pair in pairs]
    base = [(*pair.base_point, 0.0) for pair in pairs]
    return PointPairs(np.array(camera).reshape(-1, 3), np.array(base).reshape(-1, 3), tuple(rows))


def same_touch(
    pairs: Sequence[TouchedPair], camera_point: Tuple[float, float],
    base_point: Tuple[float, float],
) -> Optional[str]:
    """
    Tell why a base point cannot be that of a new place, a sentence; None if it can.

    :param pairs: Those of the other places.
    :param camera_point: Where the camera sees the object, x and y, in cm.
    :param base_point: Where the robot is said to touch it, x and y, in cm.
    """
    for pair in pairs:
        seen_cm = math.dist(pair.camera_point, camera_point)
        typed_cm = math.dist(pair.base_point, base_point)
        if typed_cm < _LEAST_SHARE * seen_cm:
            how = 'this' if typed_cm == 0 else f'within {10 * typed_cm:.1f} mm of this'
            return ('another place has {} position, ({:.2f}, {:.2f}) cm, but the camera sees the '
                    'two places {:.1f} cm apart: touch this one, and give its position'.format(
                        how, *pair.base_point, seen_cm))
    return None


def pairs_text(pairs: Sequence[TouchedPair], surface: str) -> str:
    """
    Write pairs as a table that `calibrate base` reads, too.

    :param surface: The record of the surface that the camera points were measured with.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(_COLUMNS)
    writer.writerows([*map(repr, (*pair.camera_point, *pair.base_point)), surface]
                     for pair in pairs)
    return text.getvalue()


def read_kept_pairs(
    path: str, surface: str, suggestions: Iterator[Suggestion]
) -> List[TouchedPair]:
    """
    Read the pairs that :func:`pairs_text` has written.

    :param surface: The record of the surface that is used now.
    :param suggestions: Those that the objects were laid by, from the first on.
    :returns: The pairs; [] if they were measured with another surface.
    :raises InvalidValueError: If the file is none of these.
    """
    try:
        with open(path, encoding='utf-8', newline='') as file:
            header, *rows = csv.reader(file)
    except (OSError, ValueError, csv.Error):
        header, rows = [], []
    if tuple(header) != _COLUMNS:
        raise InvalidValueError(
            f"'{path}' is there, which is no table of pairs of an interrupted calibration, and "
            'would be overwritten: give it another name')
    if any(row[-1] != surface for row in rows) or not rows:
        return []
    points = read_pairs(path)
    return [TouchedPair(suggestion, tuple(camera), tuple(base))
            for suggestion, camera, base in zip(
                suggestions, points.camera_points[:, :2].tolist(),
                points.base_points[:, :2].tolist())]


def calibrate_touches(
    pairs: PointPairs, surface_values: Mapping[str, Any], base_z: str
) -> Calibration:
    """
    Fit the base frame to pairs, see :func:`calibrate_base`.

    :param surface_values: The parameters of the surface that the camera points were measured with.
    :param base_z: Direction of the base frame's z at the table: 'up' or 'down'.
    """
    return calibrate_base(
        pairs, source='objects that the robot touched', base_z=base_z,
        surface_values=surface_values, points_are='place')
