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
"""Whether touches and markers fit each other; if not, what is wrong."""

from itertools import combinations
from typing import List, NamedTuple, Optional

from camera_to_base.calibration.figures import MM_PER_CM
from camera_to_base.calibration.markers.touched_problem import (
    fit_touched, TouchedFit, TouchedMarkers)
from camera_to_base.errors import CalibrationError
from camera_to_base.image_size import ImageSize
from camera_to_base.surface import MatchedPoints, on_one_line, sees_y_clockwise
import numpy as np

# Of touches with errors of 1 mm, the largest is off by 2 mm.
_DOUBTFUL_TOUCH_CM, _LARGEST_TOUCH_CM = 0.4, 1.0
# In pictures of this width.
_LARGEST_CORNER_PX, _USUAL_WIDTH = 1.0, 1280
# The size by the touches alone has a standard deviation of 1 %.
_DOUBTFUL_SIZE, _LARGEST_SIZE = 0.025, 0.04
_SAME_PLACE_CM = 1.0


class CheckedFit(NamedTuple):
    """
    A fit that may be used.

    :param left_out_cm: Shape (n,): each touch's distance from the fit to all others.
    :param doubts: Sentences about what is doubtful.
    """

    fit: TouchedFit
    left_out_cm: np.ndarray
    doubts: List[str]


def checked_fit(markers: TouchedMarkers, image_size: ImageSize, base_z: str) -> CheckedFit:
    """
    Fit touched markers, and check that touches and squares agree.

    :param base_z: 'up' or 'down', see `calibrate_base`.
    :raises CalibrationError: If they do not; it names the marker, the size or the swap.
    """
    _refuse_places(markers)
    fit = _good_fit(markers, image_size)
    doubts = _size_doubts(markers, image_size)
    if fit is None:
        raise CalibrationError(_explanation(markers, image_size, base_z))
    _refuse_mirrored(markers, base_z)
    left_out = np.array([_off_cm(markers, fit_touched(markers, image_size, without_touch=index),
                                 index) for index in range(len(markers.numbers))])
    worst = int(np.argmax(left_out))
    if left_out[worst] <= _DOUBTFUL_TOUCH_CM:
        return CheckedFit(fit, left_out, doubts)
    text = _off_text(markers, worst, left_out[worst])
    if left_out[worst] > _LARGEST_TOUCH_CM:
        raise CalibrationError(text)
    return CheckedFit(fit, left_out, [*doubts, text])


def _refuse_places(markers: TouchedMarkers) -> None:
    for one, other in combinations(range(len(markers.numbers)), 2):
        if np.linalg.norm(markers.touches[one] - markers.touches[other]) < _SAME_PLACE_CM:
            raise CalibrationError(
                f'markers {markers.numbers[one]} and {markers.numbers[other]} were touched at '
                'the same place: are the numbers in m instead of cm?')
    for points, what in ((markers.pixels.mean(axis=1), 'lie'), (markers.touches, 'were touched')):
        if on_one_line(points):
            raise CalibrationError(f'the markers {what} on one line: they must lie near the '
                                   'corners of the working area')
        for index, number in enumerate(markers.numbers):
            if on_one_line(np.delete(points, index, axis=0)):
                raise CalibrationError(
                    f'all markers but {number} {what} on one line: no three of them may')


def _good_fit(
    markers: TouchedMarkers, image_size: ImageSize, without_touch: Optional[int] = None,
    is_size_known: bool = True,
) -> Optional[TouchedFit]:
    """Return the fit; None if touches and squares do not agree."""
    try:
        fit = fit_touched(markers, image_size, without_touch=without_touch,
                          is_size_known=is_size_known)
    except CalibrationError:
        return None
    off_cm = np.linalg.norm(fit.places[:, :2] - markers.touches, axis=1)
    counting = np.arange(len(off_cm)) != without_touch
    limit_px = _LARGEST_CORNER_PX * max(image_size[0] / _USUAL_WIDTH, 0.5)
    agrees = (off_cm[counting].max() <= _LARGEST_TOUCH_CM
              and np.sqrt(np.mean(fit.residuals_px ** 2)) <= limit_px)
    return fit if agrees else None


def _size_doubts(markers: TouchedMarkers, image_size: ImageSize) -> List[str]:
    """Compare the size that was given with the one that the touches tell."""
    fit = _good_fit(markers, image_size, is_size_known=False)
    if fit is None or abs(fit.size - 1) <= _DOUBTFUL_SIZE:
        return []
    given_mm = MM_PER_CM * markers.edge_cm
    text = (f"by the touches the markers' edges are {given_mm * fit.size:.3g} mm long, not "
            f'{given_mm:.3g} mm: measure the black squares for --marker-mm, and check the unit of '
            'the touched positions')
    if abs(fit.size - 1) > _LARGEST_SIZE:
        raise CalibrationError(text)
    return [text]


def _explanation(markers: TouchedMarkers, image_size: ImageSize, base_z: str) -> str:
    """Say which touch is wrong, or which two are swapped."""
    count = len(markers.numbers)
    for one, other in combinations(range(count), 2):
        order = np.arange(count)
        order[[one, other]] = other, one
        swapped = markers._replace(touches=markers.touches[order])
        if _good_fit(swapped, image_size) and not _is_mirrored(swapped, base_z):
            return (f'the touches of markers {markers.numbers[one]} and {markers.numbers[other]} '
                    'are swapped: touch both again')
    alone = [(index, _good_fit(markers, image_size, without_touch=index))
             for index in range(count)]
    found = [(index, fit) for index, fit in alone if fit is not None]
    if found:
        index, fit = min(found, key=lambda one: one[1].touch_cm)
        return _off_text(markers, index, _off_cm(markers, fit, index))
    return ('the touches do not fit to the markers in the picture: touch the middle of each '
            'marker again, and look at its number')


def _off_cm(markers: TouchedMarkers, fit: TouchedFit, index: int) -> float:
    return float(np.linalg.norm(fit.places[index, :2] - markers.touches[index]))


def _off_text(markers: TouchedMarkers, index: int, off_cm: float) -> str:
    return (f'marker {markers.numbers[index]} was touched {MM_PER_CM * off_cm:.0f} mm from where '
            'the other touches and the squares have it: touch it again')


def _is_mirrored(markers: TouchedMarkers, base_z: str) -> bool:
    # The camera is above the table. There, y is seen anticlockwise from x if z points up.
    is_down = sees_y_clockwise(MatchedPoints(markers.touches, markers.pixels.mean(axis=1)))
    return is_down != (base_z == 'down')


def _refuse_mirrored(markers: TouchedMarkers, base_z: str) -> None:
    if _is_mirrored(markers, base_z):
        away = 'into the table' if base_z == 'up' else 'away from the table'
        raise CalibrationError(
            f"the touches put the base frame's z {away}, so it is mirrored: has one of the base "
            'axes the wrong sign, or are touches swapped? For a robot that hangs above the table '
            'and counts z downwards say --base-z down')
