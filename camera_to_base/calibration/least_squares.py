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

"""Least squares for small smooth problems."""

from collections.abc import Callable

import numpy as np

# So small that squares vanish: the derivative by a complex step is exact to the last digit.
COMPLEX_STEP = 1e-30

# Near the minimum each step is the square of the one before: after such a one nothing is left.
SMALL_STEP = 1e-10


def minimise(residuals: Callable, start: np.ndarray, *, steps: int = 100) -> np.ndarray:
    """
    Find the parameters with the least sum of squared residuals (Levenberg-Marquardt).

    Directions that change nothing, such as a homography's scale, are left alone.

    :param residuals: From parameters of shape (p, b), b trials side by side, real or complex, to
        shape (m, b). NaN or infinity marks parameters that are not allowed.
    :param start: Shape (p,).
    :param steps: After so many it returns what it has.
    :returns: Shape (p,).
    """
    parameters = np.array(start, float)
    current, damping = residuals(parameters[:, None])[:, 0], 1e-4
    for _ in range(steps):
        jacobian = _jacobian(residuals, parameters)
        while True:
            step = _damped_step(jacobian, current, damping)
            if np.linalg.norm(step) < SMALL_STEP * np.linalg.norm(parameters):
                return parameters + step
            with np.errstate(all='ignore'):
                trial = residuals((parameters + step)[:, None])[:, 0]
            if np.isfinite(trial).all() and trial @ trial <= current @ current:
                break
            damping *= 10
        parameters, current, damping = parameters + step, trial, damping / 100
    return parameters


def _jacobian(residuals, parameters):
    trials = parameters[:, None] + 1j * COMPLEX_STEP * np.eye(len(parameters))
    return residuals(trials).imag / COMPLEX_STEP


def _damped_step(jacobian, current, damping):
    count = jacobian.shape[1]
    stacked = np.vstack([jacobian, np.sqrt(damping) * np.eye(count)])
    return np.linalg.lstsq(stacked, -np.append(current, np.zeros(count)), rcond=None)[0]
