# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The measured pairs of a session, the fit to those that are valid, and where to measure next."""

from itertools import islice
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration import (
    calibrate_touches, Calibration, FRAMES, measured_place, pair_figures, Place, point_pairs,
    report_lines, suggested_places, Suggestion, TouchedPair)
from camera_to_base.dashboard.sessions.values import CellValues
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.parameters import Values
from camera_to_base.surface import PointPairs
import numpy as np

# How far from the click the object may be, and from where it was seen last.
_REACH_CM = 3.0

Point = Tuple[float, float]

_FEWEST = 3

PixelOf = Callable[[Point], Optional[List[float]]]
_BAD_SENTENCE = 'it does not belong to the others: measure it again, or remove it'

_OF_POSITIONS = ('surface.', 'object_height_cm', 'uncertainty.', 'detector.method')


class FollowedObject:
    """
    Collects the positions of the object nearest to a point.

    :param point: x and y, in cm, in the camera frame.
    """

    def __init__(self, point: Point) -> None:
        self._point = point
        self._frames: List[List[Point]] = []

    @property
    def frame_count(self) -> int:
        """Number of frames so far."""
        return len(self._frames)

    @property
    def is_complete(self) -> bool:
        """Whether there are enough frames."""
        return len(self._frames) >= FRAMES

    @property
    def point(self) -> Point:
        """Where it was seen last, or is looked for, in cm."""
        return self._point

    def see(self, points: Sequence[Point]) -> None:
        """Take the objects of the next frame, in cm."""
        nearest = self.nearest(points)
        self._frames.append([] if nearest is None else [nearest])
        if nearest is not None:
            self._point = nearest

    def nearest(self, points: Sequence[Point]) -> Optional[Point]:
        """Return the object's position among those of all; None if it is not there."""
        if not points:
            return None
        away = np.linalg.norm(np.array(points) - self._point, axis=1)
        index = int(np.argmin(away))
        return tuple(points[index]) if away[index] <= _REACH_CM else None

    def place(self) -> Place:
        """
        Return where it rests.

        :raises CalibrationError: If it was not there in all frames, or has moved.
        """
        return measured_place(self._frames)


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
            # The background is not known at once after a start.
            if before != after and not (name == 'background' and None in (before, after)):
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


def pair_data(
    pair: Pair, fit: Optional[PairFit], invalid_because: Optional[str], pixel_of: PixelOf
) -> Dict[str, Any]:
    """Describe a pair; `pixel_of` gives the pixel of a point."""
    is_unfit = fit is not None and fit.unfit == pair.number
    return {
        'number': pair.number, 'name': pair.touched.suggestion.name,
        'camera': point_data(pair.touched.camera_point),
        'base': point_data(pair.touched.base_point), 'pixel': pixel_of(pair.touched.camera_point),
        'residual_mm': fit and fit.residuals_mm.get(pair.number),
        'left_out_mm': fit and fit.left_out_mm.get(pair.number),
        'fits': not is_unfit, 'sentence': _BAD_SENTENCE if is_unfit else None,
        'valid': invalid_because is None, 'invalid_because': invalid_because}


def fit_data(fit: PairFit) -> Dict[str, Any]:
    """Describe the fit to all valid pairs."""
    report = fit.calibration.report if fit.calibration else None
    if report is None:
        return {'sentence': 'The pairs do not fit.', 'rms_mm': None, 'left_out_rms_mm': None,
                'lines': [], 'warnings': [], 'can_accept': False, 'error': fit.error}
    return {
        'sentence': f'The pairs fit to {report["rms_mm"]:.2f} mm rms, the worst to '
                    f'{report["max_mm"]:.2f} mm.',
        'rms_mm': report['rms_mm'], 'left_out_rms_mm': report['leave_one_out_rms_mm'],
        'lines': [line for line in report_lines(report) if not line.startswith('warning: ')],
        'warnings': report['warnings'], 'can_accept': True, 'error': None}


def point_data(point: Point) -> Dict[str, float]:
    """Describe a point, in cm."""
    return {'x': round(point[0], 3), 'y': round(point[1], 3)}


def surface_values(values: CellValues) -> Dict[str, Any]:
    """Return the parameters that the error of a position depends on, without the base frame."""
    return {name: value for name, value in values.given.items() if name.startswith(_OF_POSITIONS)}


def marker_place(values: CellValues, number: Any) -> Place:
    """
    Return where the middle of a marker lies.

    :raises InvalidValueError: If the camera node does not know it.
    """
    if number not in list(values.markers):
        raise InvalidValueError(f'there is no marker {number!r:.40}: learn the markers first')
    x, y = values.markers[number].mean(axis=0).tolist()
    return Place(x, y, 0.0, 1)


def measured_with(values: CellValues, background: Any) -> MeasuredWith:
    """Return what a point in the camera frame depends on now."""
    surface = {name: value for name, value in values.given.items()
               if name.startswith('surface.') or name == 'object_height_cm'}
    return MeasuredWith(surface, values.given.get('source', ''), background)


def suggested(values: CellValues, number: int) -> Suggestion:
    """Suggest where to put the object of a pair, counted from 1."""
    camera = values.settings
    places = suggested_places(camera.surface, camera.hull, camera.image_size)
    return next(islice(places, number - 1, None))


def suggestion_data(place: Suggestion) -> Dict[str, Any]:
    """Describe a suggestion as JSON."""
    return {'name': place.name, 'pixel': list(place.pixel), 'camera': point_data(place.point),
            'sentence': f'Put one object near the {place.name} of the calibrated area, take your '
                        'hand and the robot out of the picture, and click the object.'}


def _pair(number: int, touched: Sequence[Any], measured: Sequence[Any]) -> Pair:
    (name, pixel, point), camera_point, base_point = touched
    surface, source, background = measured
    numbers = [tuple(map(float, one)) for one in (pixel, point, camera_point, base_point)]
    return Pair(int(number), TouchedPair(Suggestion(str(name), *numbers[:2]), *numbers[2:]),
                MeasuredWith(dict(surface), str(source), background and tuple(background)))


class PairBook:
    """
    Keeps pairs by their numbers.

    `fit` is the fit to the valid ones; None if they are too few.
    """

    def __init__(self) -> None:
        self._pairs: List[Pair] = []
        self._fitted: Any = None
        self.fit: Optional[PairFit] = None

    def __len__(self) -> int:
        return len(self._pairs)

    @property
    def all(self) -> List[Pair]:  # noqa: A003
        """All pairs, by their numbers."""
        return list(self._pairs)

    @property
    def kept(self) -> List[Any]:
        """The pairs as JSON, see :meth:`restore`."""
        return [[pair.number, pair.touched, pair.measured_with] for pair in self._pairs]

    def restore(self, kept: Sequence[Any]) -> None:
        """
        Take the pairs that were kept as JSON.

        :raises InvalidValueError: If they are none.
        """
        try:
            self.put_back([_pair(*one) for one in kept])
        except (TypeError, ValueError) as error:
            raise InvalidValueError('the pairs from before cannot be read') from error

    def put_back(self, pairs: Sequence[Pair]) -> None:
        """Take pairs in place of the present ones."""
        self._pairs, self._fitted, self.fit = list(pairs), None, None

    @property
    def next_number(self) -> int:
        """The number of the next pair."""
        return 1 + max((pair.number for pair in self._pairs), default=0)

    def numbered(self, number: Any) -> Pair:
        """
        Return a pair.

        :raises InvalidValueError: If there is none with the number.
        """
        for pair in self._pairs:
            if pair.number == number:
                return pair
        raise InvalidValueError(f'there is no pair {number!r:.20}')

    def put(self, pair: Pair) -> None:
        """Add a pair; it replaces the one with its number."""
        kept = [one for one in self._pairs if one.number != pair.number]
        self._pairs = sorted([*kept, pair], key=lambda one: one.number)

    def remove(self, pair: Pair) -> None:
        """Remove a pair."""
        self._pairs.remove(pair)

    def clear(self) -> None:
        """Remove all pairs."""
        self._pairs, self._fitted, self.fit = [], None, None

    def tell_background(self, mark: Any) -> None:
        """Say with which background the pairs were measured for which it was not known."""
        self._pairs = [pair if pair.measured_with.background else pair.with_background(mark)
                       for pair in self._pairs]

    def fit_again(self, now: MeasuredWith, surface_values: Values, base_z: str) -> bool:
        """
        Fit the valid pairs, unless nothing has changed.

        :param now: What makes a pair valid.
        :returns: Whether something has changed.
        """
        valid = [pair for pair in self._pairs if pair.measured_with.difference(now) is None]
        wanted = valid, surface_values, base_z
        if wanted == self._fitted:
            return False
        self._fitted, self.fit = wanted, fit_pairs(*wanted)
        return True

    def data(self, now: MeasuredWith, pixel_of: PixelOf) -> List[Dict[str, Any]]:
        """Describe the pairs as JSON."""
        return [pair_data(pair, self.fit, pair.measured_with.difference(now), pixel_of)
                for pair in self._pairs]
