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

"""The result of a calibration, and the parts that all reports share."""

from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any, Mapping, Optional, Sequence

from camera_to_base.calibration.figures import ErrorFigures
from camera_to_base.calibration.report_drawing import Panel
from camera_to_base.calibration.report_text import Report
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import MatchedPoints, sees_y_clockwise, Surface
import numpy as np

# The fit is repeated without each point: a thousand points take a minute, ten thousand hours.
_MOST_POINTS = 1000


@dataclass(frozen=True)
class Calibration:
    """
    The result of a calibration.

    :param report: The report that `calibrate --json` prints.
    :param values: The nodes' parameters, by full name.
    :param picture: The report picture, shape (h, w, 3), uint8; None if there is none.
    :param panels: Its parts.
    """

    report: Report
    values: Mapping[str, Any]
    picture: Optional[np.ndarray] = None
    panels: Sequence[Panel] = ()


def refuse_too_many(count: int) -> None:
    """
    Refuse more points than can be left out one after the other.

    :raises CalibrationError: If there are more than a thousand.
    """
    if count > _MOST_POINTS:
        raise CalibrationError(
            f'{count} points are too many to leave out each of them once: give {_MOST_POINTS} at '
            'most, spread over the working area')


def origin_fields(model: str, source: str) -> Report:
    """Return a report's fields that say what was fitted to what, and when."""
    return {'model': model, 'source': source,
            'date': datetime.now().astimezone().isoformat(timespec='seconds')}


def figure_fields(figures: ErrorFigures, points_are: str) -> Report:
    """Return a report's fields of the errors."""
    return {**asdict(figures), 'points_are': points_are}


def axis_fields(surface: Surface, matched: MatchedPoints) -> Report:
    """Return a report's fields that say where the picture shows the camera frame, if it does."""
    length = float(np.ptp(matched.points, axis=0).max())
    pixels = surface.pixels([[0, 0], [length, 0], [0, length]])
    if not np.isfinite(pixels).all():
        return {}
    origin, x_end, y_end = pixels.round(1).tolist()
    clockwise = sees_y_clockwise(matched)
    return {'origin_px': origin, 'x_towards_px': x_end, 'y_towards_px': y_end,
            'z_points': 'into the surface' if clockwise else 'towards the camera'}
