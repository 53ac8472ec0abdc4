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

"""Finds the one measurement that does not belong to the others."""

from typing import Optional

import numpy as np

# Of a hundred tables without a bad row, one is suspected of having one.
FALSE_ALARMS = 0.01


def find_outlier(
    squares: float, squares_without: np.ndarray, *, dimensions: int, parameters: int, floor: float
) -> Optional[int]:
    """
    Find the measurement without which all others fit much better.

    An F test of by how much the sum of squared residuals falls when a measurement is left out,
    against what the others leave; the level is divided by the number of measurements, as the worst
    of them is tested. It takes into account that a measurement at the rim pulls the fit to itself.

    Source: S. Weisberg, Applied Linear Regression, section 9.1.2, for measurements of several
    coordinates.

    :param squares: The sum of squared residuals of the fit to all.
    :param squares_without: Shape (n,), of each fit without one, over the measurements it has.
    :param dimensions: Coordinates of a measurement.
    :param parameters: Of the fit.
    :param floor: The deviation of a coordinate that is not worth a word, in the residuals' unit.
    :returns: The index of the measurement; None if there is no such one, or too few to tell.
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
