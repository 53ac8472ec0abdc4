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

"""Finds a single outlier among measurements."""

from typing import Optional

import numpy as np

# Of a hundred tables without an outlier, one is wrongly reported to have one.
FALSE_ALARMS = 0.01


def find_outlier(
    squares: float, squares_without: np.ndarray, *, dimensions: int, parameters: int, floor: float
) -> Optional[int]:
    """
    Find the measurement without which the others fit much better.

    An F test compares the decrease of the sum of squared residuals when a measurement is left out
    with the residuals of the others. The level is divided by the number of measurements, because
    the worst of them is tested. The test accounts for the leverage of measurements at the rim.

    Source: S. Weisberg, Applied Linear Regression, section 9.1.2, for measurements of several
    coordinates.

    :param squares: The sum of squared residuals of the fit to all.
    :param squares_without: Shape (n,), the same of each fit without one measurement.
    :param dimensions: Number of coordinates of a measurement.
    :param parameters: Number of parameters of the fit.
    :param floor: Deviation of a coordinate that is never reported, in the residuals' unit.
    :returns: Index of the outlier; None if there is none, or if there are too few measurements.
    """
    from scipy.special import fdtrc

    count = len(squares_without)
    freedom = dimensions * (count - 1) - parameters
    if freedom < 2:
        return None
    variance = np.maximum(squares_without / freedom, floor ** 2)
    fall = (squares - squares_without) / dimensions / variance
    chances = count * fdtrc(dimensions, freedom, np.clip(fall, 0, None))
    index = int(np.argmin(chances))
    return index if chances[index] < FALSE_ALARMS else None
