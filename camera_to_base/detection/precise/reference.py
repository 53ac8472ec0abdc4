# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The background at a frame's light, with its noise and the limits that follow from both."""

from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from camera_to_base.detection.precise.light import Gain, GainMeter, NO_GAIN
from camera_to_base.detection.precise.noise import measure_noise, Noise
import cv2
import numpy as np

# A camera that trembles shows at a place what lies beside it on the background.
_TREMBLE = np.ones((3, 3), np.uint8)
# An edge that has moved, or is sharpened otherwise, leaves that range by this part of its step.
_MOVED = 0.2
# Grey levels beyond the background's own range, and deviations of the noise: where an object's
# rim still counts, and what an object must have somewhere.
WEAK_LEVELS, _WEAK_DEVIATIONS, STRONG_DEVIATIONS = 5.0, 4.5, 10.0
# Which of the two limits; all of a picture, as indices.
_STRONG, _WEAK = range(2)
_ALL = slice(None), slice(None)

# The noise is measured in frames 1, 2, 4, 8 and so on, and in each of this number.
_NOISE_PERIOD = 64


class Range(NamedTuple):
    """Darkest and lightest levels that are the background's, each of shape (h, w, 3), uint8."""

    darkest: np.ndarray
    lightest: np.ndarray

    def outside(self, frame: np.ndarray) -> np.ndarray:
        """Find the pixels beyond it in any channel: shape (h, w), uint8, 255 or 0."""
        return cv2.bitwise_not(cv2.inRange(frame, self.darkest, self.lightest))


class LevelLimits:
    """
    The background's own range of levels, at some light and with some noise.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param faintest: Grey levels that an object must at least differ by somewhere.
    """

    def __init__(self, background: np.ndarray, faintest: float) -> None:
        self._picture, self._faintest = background, faintest
        self._usual = Range(cv2.erode(background, _TREMBLE), cv2.dilate(background, _TREMBLE))
        self._moved = cv2.convertScaleAbs(
            cv2.subtract(*reversed(self._usual)), alpha=_MOVED)
        self._gain = NO_GAIN
        self._noise: Optional[np.ndarray] = None
        # For the strong and the weak limit: margins by level, and those of the whole picture; its
        # ranges at this light, and at the last one; the marks of one frame.
        self._margins: List[np.ndarray] = []
        self._wide_margins = _nothing_yet()
        self._ranges, self._old, self._masks = (_nothing_yet() for _ in range(3))
        self._marked: Optional[np.ndarray] = None
        self._print: Optional[np.ndarray] = None
        self.least = faintest

    def set_light(self, gain: Gain, noise: np.ndarray) -> None:
        """
        Follow the light and the noise, see :class:`Noise`.

        A level that is beyond the strong range differs by more than `least` from the background.
        """
        self._gain, self._ranges = gain, _nothing_yet()
        if noise is self._noise:
            return
        self._noise = noise
        noise = np.take_along_axis(noise, np.rint(gain.coded_levels).astype(int), axis=0)
        weak = np.maximum(min(WEAK_LEVELS, self._faintest), _WEAK_DEVIATIONS * noise)
        strong = np.maximum(self._faintest, STRONG_DEVIATIONS * noise)
        self.least = max(float(strong.min()) - 0.01, 0.0)
        self._margins = [np.uint8(np.minimum(np.rint(levels), 255))[:, None]
                         for levels in (strong, weak)]
        self._wide_margins = _nothing_yet()

    def mark(self, frame: Optional[np.ndarray]) -> None:
        """Compare all of a frame at once: faster where much of it has changed; None for parts."""
        if frame is None or frame is not self._marked:
            self._marked, self._masks = frame, _nothing_yet()

    def strong(self, frame: np.ndarray, part: tuple) -> np.ndarray:
        """Mark what an object must have somewhere, in a part: shape (h, w), uint8, 255 there."""
        return self._outside(frame, part, _STRONG)

    def weak(self, frame: np.ndarray, part: tuple) -> np.ndarray:
        """Mark what each pixel of an object shows, in a part: shape (h, w), uint8, 255 there."""
        return self._outside(frame, part, _WEAK)

    def has_print(self, part: tuple, levels: float) -> np.ndarray:
        """Mark where the background changes by some levels within 2 px: shape (h, w), uint8."""
        if self._print is None:
            change = cv2.subtract(*reversed(self._usual))
            blue, green, red = (cv2.extractChannel(change, channel) for channel in range(3))
            self._print = cv2.max(cv2.max(blue, green), red)
        return cv2.dilate(cv2.compare(self._print[part], levels, cv2.CMP_GT), _TREMBLE)

    def strong_range(self, part: tuple) -> Range:
        """Give the range that an object must leave somewhere, for a part of the picture."""
        return self._range_of(part, _STRONG)

    def _outside(self, frame: np.ndarray, part: tuple, which: int) -> np.ndarray:
        if self._marked is not frame:
            return self._range_of(part, which).outside(frame[part])
        if self._masks[which] is None:
            self._masks[which] = self._whole_range(which).outside(frame)
        return self._masks[which][part].copy()

    def _range_of(self, part: tuple, which: int) -> Range:
        known = self._ranges[which]
        if known is not None:
            return Range(*(bound[part] for bound in known))
        return self._range(part, self._margin(part, which))

    def _whole_range(self, which: int) -> Range:
        if self._ranges[which] is None:
            if self._wide_margins[which] is None:
                self._wide_margins[which] = self._margin(_ALL, which)
            # Where the last one was: the system gives new memory slowly.
            self._ranges[which] = self._old[which] = self._range(
                _ALL, self._wide_margins[which], self._old[which] or (None, None))
        return self._ranges[which]

    def _range(
        self, part: tuple, margin: np.ndarray,
        into: Sequence[Optional[np.ndarray]] = (None, None)
    ) -> Range:
        darkest, lightest = (bound[part] for bound in self._usual)
        return Range(cv2.subtract(self._gain.lit(darkest, darkest=True), margin, dst=into[0]),
                     cv2.add(self._gain.lit(lightest), margin, dst=into[1]))

    def _margin(self, part: tuple, which: int) -> np.ndarray:
        known = self._wide_margins[which]
        if known is not None:
            return known[part]
        levels = cv2.LUT(self._picture[part], self._margins[which])
        # A thing's rim is still seen on an edge; no edge makes a thing.
        return cv2.add(levels, self._moved[part]) if which == _STRONG else levels


def _nothing_yet() -> List[Any]:
    return [None, None]


class Reference:
    """
    A background that follows the frames' light and noise; its picture never changes.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param faintest: Grey levels that an object must at least differ by somewhere.
    """

    def __init__(self, picture: np.ndarray, faintest: float) -> None:
        self.picture = picture
        self.limits = LevelLimits(picture, faintest)
        # By how much the frame is reduced, along each axis.
        self.noise: Dict[int, Noise] = {}
        self.mean_noise: Optional[float] = None
        self._faintest = faintest
        self._meter = GainMeter(picture)
        self._frame_count = 0
        self._edges: Optional[np.ndarray] = None
        self._usual_level = int(np.median(picture[::8, ::8]))
        self._use_gain(NO_GAIN)

    def follow(self, frame: np.ndarray) -> bool:
        """
        Take a frame's light, and now and then its noise, for this and the next frames.

        :returns: Whether `lit` or `limits` have changed.
        """
        gain = self._meter.follow(frame)
        self.limits.mark(None)
        self._frame_count += 1
        count = self._frame_count
        is_noise_due = count & (count - 1) == 0 or count % _NOISE_PERIOD == 0
        if gain == self.gain and not is_noise_due:
            return False
        if gain != self.gain:
            self._use_gain(gain)
        if is_noise_due:
            self.noise = measure_noise(frame, self.lit, self._usual_level)
            self.mean_noise = self.noise[1].at(self._usual_level)
        self.limits.set_light(gain, self.noise[1].levels)
        return True

    def _use_gain(self, gain: Gain) -> None:
        self.gain = gain
        self._linear_levels = gain.linear_levels
        self.lit = gain.lit(self.picture)

    def has_edges(self, part: tuple) -> bool:
        """Tell whether a part of the background changes by as much as an object within 5 px."""
        if self._edges is None:
            size = np.ones((5, 5), np.uint8)
            gradient = cv2.morphologyEx(cv2.blur(self.picture, (3, 3)), cv2.MORPH_GRADIENT, size)
            self._edges = cv2.bitwise_not(cv2.inRange(gradient, 0, (self._faintest,) * 3))
        return cv2.countNonZero(self._edges[part]) > 0

    def at_this_light(self, picture: np.ndarray) -> np.ndarray:
        """Give a picture of the background's shape as it looks at the frame's light."""
        return self.gain.lit(picture)

    def light(self, part: tuple) -> np.ndarray:
        """Give the light of a part of the background at the frame's light, float32."""
        return cv2.LUT(self.picture[part], self._linear_levels)
