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

"""Pairs for the base frame, and what they were measured with."""

from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

from camera_to_base.calibration import (
    calibrate_touches, Calibration, pair_figures, point_pairs, TouchedPair)
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import Values
from camera_to_base.surface import PointPairs

_FEWEST = 3


class MeasuredWith(NamedTuple):
    """
    What a point in the camera frame depends on.

    :param surface: The parameters of the surface that differ from their defaults.
    :param source: The camera.
    :param background: Changes with each background.
    """

    surface: Mapping[str, Any]
    source: str
    background: Any

    def difference(self, now: 'MeasuredWith') -> Optional[str]:
        """Say why a point that was measured with this is not valid now; None if it is."""
        for name, before, after in (('camera', self.source, now.source),
                                    ('surface', self.surface, now.surface),
                                    ('background', self.background, now.background)):
            if before != after:
                return (f'it was measured with another {name}: measure it again, or remove it')
        return None


class Pair(NamedTuple):
    """
    A touched pair with its number.

    :param number: 1 and up; it stays when others are removed.
    """

    number: int
    touched: TouchedPair
    measured_with: MeasuredWith

    def with_background(self, mark: Any) -> 'Pair':
        """Return the pair as one that was measured with a background."""
        return self._replace(measured_with=self.measured_with._replace(background=mark))


class PairFit(NamedTuple):
    """
    The fit to the valid pairs.

    :param residuals_mm: By number of the pair.
    :param left_out_mm: Likewise; empty where the others do not suffice.
    :param unfit: Number of the pair that does not fit; None if there is none.
    :param calibration: None if the pairs cannot be used.
    :param error: Why they cannot.
    """

    residuals_mm: Dict[int, float]
    left_out_mm: Dict[int, float]
    unfit: Optional[int]
    calibration: Optional[Calibration]
    error: Optional[str]


def fit_pairs(
    pairs: Sequence[Pair], surface_values: Values, base_z: str
) -> Optional[PairFit]:
    """
    Fit the base frame to pairs.

    :param surface_values: The surface that they were measured with.
    :returns: None if there are fewer than three.
    """
    if len(pairs) < _FEWEST:
        return None
    try:
        points = point_pairs([pair.touched for pair in pairs], [pair.number for pair in pairs])
        figures = pair_figures(points)
    except CameraToBaseError as error:
        return PairFit({}, {}, None, None, str(error))
    left_out = [] if figures.left_out_cm is None else 10 * figures.left_out_cm
    unfit = None if figures.unfit is None else points.rows[figures.unfit]
    return PairFit(_by_number(points, 10 * figures.residuals_cm), _by_number(points, left_out),
                   unfit, *_calibration(points, surface_values, base_z))


def _calibration(points: PointPairs, surface_values: Values, base_z: str) -> List[Any]:
    try:
        return [calibrate_touches(points, surface_values, base_z), None]
    except CameraToBaseError as error:
        return [None, str(error)]


def _by_number(points: PointPairs, values: Sequence[float]) -> Dict[int, float]:
    return {row: round(float(value), 2) for row, value in zip(points.rows, values)}
