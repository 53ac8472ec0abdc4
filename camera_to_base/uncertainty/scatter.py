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

# With fewer degrees of freedom, no one factor suits the quantiles.
_LEAST_FREEDOM = 4.0


def predictive_variance(
    squares: float, freedom: float, expected: float, expected_freedom: float
) -> float:
    """
    Return the variance of a further error, whose own variance was estimated.

    The estimate is pooled with the value that is expected of such measurements. With few
    measurements, errors have Student's t distribution, with more large errors than a normal one.
    A factor of f / (f - 1) on the variance of f degrees of freedom suits the ellipses of 50 to
    95 % best.

    :param squares: The sum of squared residuals, each divided by its own expected square.
    :param freedom: Degrees of freedom of the sum; 0 or less leaves the expected value only.
    :param expected: The usual standard deviation, in the unit of the residuals.
    :param expected_freedom: How many residuals it is worth.
    """
    freedom = max(freedom, 0.0)
    pooled = freedom + expected_freedom
    variance = (squares * (freedom > 0) + expected_freedom * expected ** 2) / pooled
    pooled = max(pooled, _LEAST_FREEDOM)
    return variance * pooled / (pooled - 1)
