# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The background as it looks at a frame's light, and what differs from it."""

from typing import Optional

from camera_to_base.detection.precise.light import (
    Gain, GainMeter, LevelLimits, measure_noise, NO_GAIN)
import cv2
import numpy as np

# The noise is measured in frames 1, 2, 4, 8 and so on, and in each of this number.
_NOISE_PERIOD = 64


class Reference:
    """
    A background that follows the frames' light and noise; its picture never changes.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param faintest: Grey levels that an object must at least differ by somewhere.
    """

    def __init__(self, picture: np.ndarray, faintest: float) -> None:
        self.picture = picture
        self.limits = LevelLimits(picture, faintest)
        self.noise: Optional[np.ndarray] = None
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
        self._frame_count += 1
        count = self._frame_count
        is_noise_due = count & (count - 1) == 0 or count % _NOISE_PERIOD == 0
        if gain == self._gain and not is_noise_due:
            return False
        if gain != self._gain:
            self._use_gain(gain)
        if is_noise_due:
            self.noise = measure_noise(frame, self.lit)
            self.mean_noise = float(self.noise[self._usual_level].mean())
        self.limits.set_light(gain, self.noise)
        return True

    def _use_gain(self, gain: Gain) -> None:
        self._gain = gain
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
        return self._gain.lit(picture)

    def light(self, part: tuple) -> np.ndarray:
        """Give the light of a part of the background at the frame's light, float32."""
        return cv2.LUT(self.picture[part], self._linear_levels)
