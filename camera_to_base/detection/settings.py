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

"""The detector's settings: the method, and which objects count."""

from dataclasses import dataclass
from typing import List, Optional, Protocol

from camera_to_base.detection.areas import Areas
from camera_to_base.detection.detection import Detection
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.limits import STRONG_DEVIATIONS
from camera_to_base.detection.specs import DETECTOR_DEFAULTS as _DEFAULTS
from camera_to_base.detection.tutorial import AbsoluteDifferenceDetector
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface import Hull
import numpy as np

# The settings that each method uses, in addition to the limits of the objects' size and place.
_METHOD_SETTINGS = {
    'tutorial': ('threshold', 'closing_size', 'median_size'),
    'precise': ('faintest', 'split_touching', 'publish_cut_off'),
}


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
    :param min_area_cm2: Smaller objects do not count, in cm² on the surface.
    :param max_area_cm2: Larger objects do not count, in cm² on the surface.
    :param area: Objects outside this area do not count; None for no limit.
    :param publish_cut_off: precise: whether an object that touches the picture's edge counts;
        with the tutorial's method it always does.
    :param areas: The areas on the surface in which objects count.
    :raises InvalidValueError: If the smallest area is above the largest.
    """

    method: str = _DEFAULTS['method']
    threshold: int = _DEFAULTS['threshold']
    closing_size: int = _DEFAULTS['closing_size']
    median_size: int = _DEFAULTS['median_size']
    faintest: float = _DEFAULTS['faintest']
    split_touching: bool = _DEFAULTS['split_touching']
    min_area_cm2: float = _DEFAULTS['min_area_cm2']
    max_area_cm2: float = _DEFAULTS['max_area_cm2']
    publish_cut_off: bool = _DEFAULTS['publish_cut_off']
    area: Optional[Hull] = None
    areas: Areas = Areas()

    def __post_init__(self) -> None:
        """Check the relation of the areas, which the limits of each setting do not cover."""
        if self.min_area_cm2 > self.max_area_cm2:
            raise InvalidValueError(
                f'detector.max_area_cm2 must not be below detector.min_area_cm2, '
                f'{self.min_area_cm2:g} cm², got {self.max_area_cm2:g}')

    @property
    def without_effect(self) -> List[str]:
        """Names of settings that were changed but belong to another method."""
        return [name for method, names in _METHOD_SETTINGS.items() if method != self.method
                for name in names if getattr(self, name) != getattr(type(self), name)]

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
                                             split_touching=self.split_touching)
        return AbsoluteDifferenceDetector(
            background, threshold=self.threshold, closing_size=self.closing_size,
            median_size=self.median_size)
