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

"""The noise of a picture, told from the picture alone."""

import cv2
import numpy as np

_MASK = np.outer([1.0, -2.0, 1.0], [1.0, -2.0, 1.0])


def white_noise(grey: np.ndarray, step: int = 1) -> float:
    """
    Estimate the standard deviation of a pixel's noise, in levels.

    J. Immerkaer, Fast noise variance estimation, 1996, with the median for the mean: edges count
    for little.

    :param grey: Shape (h, w), float32.
    :param step: Of so many columns and rows only one is asked.
    """
    if min(grey.shape) < len(_MASK):
        return 0.0
    second = cv2.filter2D(grey, cv2.CV_32F, _MASK)[::step, ::step]
    return float(np.median(np.abs(second))) / 0.6745 / 6


def smoothed_noise(grey: np.ndarray, sigma: float, step: int = 1) -> float:
    """Estimate what a Gaussian filter leaves of it; see :func:`white_noise`."""
    return white_noise(grey, step) / (2 * np.sqrt(np.pi) * sigma)
