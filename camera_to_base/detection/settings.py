# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The detector's parameters: the method, which objects count, and where on the surface."""

from dataclasses import dataclass, replace
from typing import Any, Iterable, List, Mapping, NamedTuple, Optional, Protocol, Sequence, Tuple

from camera_to_base.detection.detection import Detection, NoObject
from camera_to_base.detection.left_out import SPECK_CM2
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.light_alone import LIGHT_OR_THING
from camera_to_base.detection.precise.reference import STRONG_DEVIATIONS
from camera_to_base.detection.tutorial import AbsoluteDifferenceDetector
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import default_values, grouped, ParameterSpec
from camera_to_base.surface import Hull
import cv2
import numpy as np

_LIMIT_CM = 1e5

METHODS = ('tutorial', 'precise')
_LARGEST_AREA_CM2 = 1e6

# px: more than there is.
_NO_BUDGET = 100_000_000

BACKGROUND_SPECS = [
    ParameterSpec(
        'background_frames', 1,
        'The background is the median of this many frames; 1 takes the first one, as the '
        'tutorial does (of a camera, the first one that the next one confirms). No more are '
        'gathered than fit into 200 MB: 32 of 1920 x 1080 px.', (1, 1000)),
    ParameterSpec(
        'background_retake', 'never',
        'Whether a new background is taken when markers show that the camera stands elsewhere. '
        'never: the node waits for ~/capture_background. auto: it is taken when all markers are '
        'seen and nothing moves; what lies on the surface then is not found. Cameras only.',
        choices=('never', 'auto')),
]
DETECTOR_SPECS = [
    ParameterSpec('detector.method', 'precise',
                  "tutorial: the tutorial's result, to the pixel; precise: right to a tenth of a "
                  'pixel, also in changing light.', choices=METHODS),
    ParameterSpec('detector.threshold', 95,
                  "tutorial: a pixel whose grey level differs from the background's by more than "
                  'this belongs to an object.', (0, 255), unit='grey levels'),
    ParameterSpec('detector.closing_size', 20,
                  'tutorial: edge of the square kernel that closes gaps.', (1, 500), unit='px'),
    ParameterSpec('detector.median_size', 5,
                  "tutorial: edge of the median filter's window, odd.", (1, 99), step=2,
                  unit='px'),
    ParameterSpec('detector.faintest', 13.0,
                  'precise: least difference of an object from the surface, in one of the '
                  'colours. It must also be at least ten times the noise.',
                  (0, 255), unit='grey levels', old_names=('detector.precise_threshold',)),
    ParameterSpec('detector.min_area_cm2', SPECK_CM2,
                  'Smaller objects are not published; their area on the surface. With the '
                  'default, these are specks: dust, if it is less than 12 px wide, too.',
                  (0, _LARGEST_AREA_CM2), unit='cm²'),
    ParameterSpec('detector.max_area_cm2', _LARGEST_AREA_CM2,
                  'Larger objects (a hand) are not published; their area on the surface.',
                  (0, _LARGEST_AREA_CM2), unit='cm²'),
    ParameterSpec('detector.split_touching', False,
                  'precise: whether convex objects that touch (coins, nuts) come as one each; '
                  'where false, nothing is taken apart.'),
    ParameterSpec('detector.light_or_thing', 'leave_out',
                  'precise: what is done with something that may be shade or light as well as a '
                  'thing of the colour of the surface; publish: with a wide ellipse. Where its '
                  'edge is sharp, it is published all the same, unless leave_out_all.',
                  choices=LIGHT_OR_THING),
    ParameterSpec('detector.budget_px', 60000,
                  'precise: how many pixels around changes are looked at closely on a frame of a '
                  'live source, about 0.6 ms for 1000 of them. What lies beyond is left out as '
                  'too_much until one of the next frames; objects of the last frame come first.',
                  (1000, _NO_BUDGET), unit='px'),
    ParameterSpec('detector.publish_cut_off', False,
                  "precise: whether an object that touches the picture's edge is published; the "
                  'tutorial publishes it.'),
]
AREA_SPECS = [
    ParameterSpec(
        'work_area', [],
        'Only objects whose centre lies in this polygon are published: x and y of one corner '
        'after the other; empty for everywhere.', unit='cm', constraints='x and y in turn'),
    ParameterSpec(
        'ignored_areas', '',
        'Objects whose centre lies in one of these polygons are not published (a rail, a cable, '
        "the robot's foot): in cm, corners with , between them, polygons with ; between them.",
        constraints="such as '0 0, 5 0, 5 3; 30 0, 36 0, 36 27'"),
]
HEIGHT_SPECS = [
    ParameterSpec('object_height_cm', 0.0,
                  "The objects' height above the surface; 0 for flat objects. Others need the "
                  "camera's place: surface.model pinhole, or surface.camera_height_cm.",
                  (0, 10000), unit='cm'),
    ParameterSpec('object_heights_cm', [],
                  'Several heights, in place of object_height_cm: each object takes the one that '
                  "its outline or its top's rim tells, and is left out where that is not clear. "
                  'The camera must be tilted.', (0.01, 10000), unit='cm'),
    ParameterSpec('flat_middle_cm', 0.05,
                  'How far the middle of a flat object is above the plane that was calibrated: '
                  "half of a coin's thickness, less that of the board; 0 for prints. A tilted "
                  'camera sees it that much too far out. Only with surface.model pinhole.',
                  (-2, 2), unit='cm'),
]
# By their names without 'detector.'.
DETECTOR_DEFAULTS: Mapping[str, Any] = grouped(default_values(DETECTOR_SPECS), 'detector.')

# The settings that each method uses, in addition to the limits of the objects' size and place.
_METHOD_SETTINGS = {
    'tutorial': ('threshold', 'closing_size', 'median_size'),
    'precise': ('faintest', 'split_touching', 'light_or_thing', 'budget_px',
                'publish_cut_off'),
}


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

    def without(self, polygons: Iterable[np.ndarray]) -> 'Areas':
        """
        Ignore further areas, too.

        :param polygons: Each of shape (n, 2), its corners, in cm.
        """
        return self._replace(ignored=(*self.ignored, *map(Area, polygons)))


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
    return Areas(work, read_polygons('ignored_areas', ignored_areas))


def read_polygons(name: str, polygons: str) -> Tuple[Area, ...]:
    """
    Read a parameter that holds polygons.

    :param name: Its name in errors.
    :param polygons: Corners with , between them, polygons with ; between them.
    :raises InvalidValueError: If one is no polygon.
    """
    texts = [text for text in polygons.split(';') if text.strip()]
    return tuple(_named(name, _corners(name, text)) for text in texts)


def _named(name: str, corners: np.ndarray) -> Area:
    try:
        return Area(corners)
    except InvalidValueError as error:
        raise InvalidValueError(f'{name}: {error}') from error


def _corners(name: str, text: str) -> np.ndarray:
    try:
        corners = [[float(number) for number in corner.split()] for corner in text.split(',')]
    except ValueError:
        corners = []
    if not corners or any(len(corner) != 2 for corner in corners):
        raise InvalidValueError(
            f"{name} must be polygons as '0 0, 5 0, 5 3; 30 0, 36 0, 36 27', got '{text}'")
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


class Detector(Protocol):
    """Finds objects by their difference to a background picture."""

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """
        Find the objects on a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :returns: The largest first; none is [].
        :raises FrameSizeError: If the frame's size is not the background's.
        """

    @property
    def taken_away(self) -> List[Detection]:
        """Places where objects of the background are missing on the last frame."""

    @property
    def dropped(self) -> List[NoObject]:
        """What else differs from the background on the last frame."""

    @property
    def noise(self) -> Optional[float]:
        """The noise of a frame, in grey levels; None where it is not known."""


@dataclass(frozen=True)
class DetectorSettings:
    """
    The method, its parameters, and which objects count; `specs` has the limits of each value.

    :param method: 'tutorial' or 'precise'.
    :param threshold: tutorial: grey levels that make a pixel part of an object, 0..255.
    :param closing_size: tutorial: edge of the kernel that closes gaps, in px.
    :param median_size: tutorial: edge of the median filter's window, in px, odd.
    :param faintest: precise: least difference of an object from the surface, grey levels, 0..255.
    :param split_touching: precise: whether convex objects that touch are separated.
    :param light_or_thing: precise: what is done with what may be light, see `LIGHT_OR_THING`.
    :param budget_px: precise: how much is looked at closely on a frame, in px. Without the
        parameter, there is no limit.
    :param min_area_cm2: Smaller objects do not count, in cm² on the surface.
    :param max_area_cm2: Larger objects do not count, in cm² on the surface.
    :param area: Objects outside this area do not count; None for no limit.
    :param publish_cut_off: precise: whether an object that touches the picture's edge counts;
        with the tutorial's method it always does.
    :param areas: The areas on the surface in which objects count.
    :param heights_cm: The heights that objects may have, ascending, see `object_heights`; () for
        flat ones.
    :param flat_middle_cm: How high a flat object's middle is; only a pinhole camera sees that.
    :raises InvalidValueError: If the smallest area is above the largest.
    """

    method: str = DETECTOR_DEFAULTS['method']
    threshold: int = DETECTOR_DEFAULTS['threshold']
    closing_size: int = DETECTOR_DEFAULTS['closing_size']
    median_size: int = DETECTOR_DEFAULTS['median_size']
    faintest: float = DETECTOR_DEFAULTS['faintest']
    split_touching: bool = DETECTOR_DEFAULTS['split_touching']
    light_or_thing: str = DETECTOR_DEFAULTS['light_or_thing']
    budget_px: int = _NO_BUDGET
    min_area_cm2: float = DETECTOR_DEFAULTS['min_area_cm2']
    max_area_cm2: float = DETECTOR_DEFAULTS['max_area_cm2']
    publish_cut_off: bool = DETECTOR_DEFAULTS['publish_cut_off']
    area: Optional[Hull] = None
    areas: Areas = Areas()
    heights_cm: Tuple[float, ...] = ()
    flat_middle_cm: float = 0.0

    def __post_init__(self) -> None:
        """Check the relation of the areas, which the limits of each setting do not cover."""
        if self.min_area_cm2 > self.max_area_cm2:
            raise InvalidValueError(
                f'detector.max_area_cm2 must not be below detector.min_area_cm2, '
                f'{self.min_area_cm2:g} cm², got {self.max_area_cm2:g}')

    @property
    def without_budget(self) -> 'DetectorSettings':
        """The same, with time for all of a frame: nobody waits for a recording's positions."""
        return replace(self, budget_px=_NO_BUDGET)

    @property
    def without_effect(self) -> List[str]:
        """Names of settings that were changed but belong to another method."""
        return [name for method, names in _METHOD_SETTINGS.items() if method != self.method
                for name in names if getattr(self, name) not in (
                    DETECTOR_DEFAULTS[name], getattr(type(self), name))]

    def faintness(self, noise: float) -> str:
        """Say how faint an object may be with some noise, see :attr:`Detector.noise`."""
        allowed = STRONG_DEVIATIONS * noise
        needed = max(allowed, self.faintest)
        return (f'an object must differ from the surface by {needed:.0f} grey levels: the noise '
                f'of {noise:.1f} levels allows {allowed:.0f}, detector.faintest is '
                f'{self.faintest:g}')

    def detector(self, background: np.ndarray) -> Detector:
        """Make the detector."""
        if self.method == 'precise':
            return PreciseDifferenceDetector(background, faintest=self.faintest,
                                             split_touching=self.split_touching,
                                             light_or_thing=self.light_or_thing,
                                             budget_px=self.budget_px)
        return AbsoluteDifferenceDetector(
            background, threshold=self.threshold, closing_size=self.closing_size,
            median_size=self.median_size)
