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

"""The variance of measurements, from few of them."""


def pooled_variance(
    squares: float, freedom: float, expected: float, expected_freedom: float
) -> float:
    """
    Return the variance of measurements, of which few residuals are known.

    It is pooled with the variance that such measurements usually have: a handful of residuals may
    happen to be small.

    :param squares: The sum of squared residuals, each divided by its own expected square.
    :param freedom: Degrees of freedom of the sum; 0 or less leaves the usual value only.
    :param expected: The usual standard deviation, in the unit of the residuals.
    :param expected_freedom: How many residuals it is worth.
    """
    if freedom <= 0:
        return expected ** 2
    return (squares + expected_freedom * expected ** 2) / (freedom + expected_freedom)
