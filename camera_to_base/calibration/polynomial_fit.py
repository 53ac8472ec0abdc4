# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Fits the tutorial's model of a tilted camera, like the trend lines of its spreadsheet."""

from dataclasses import dataclass
from typing import Optional, Tuple

from camera_to_base.calibration.figures import leave_one_out
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import check_inside, MatchedPoints, PolynomialSurface
import numpy as np


@dataclass(frozen=True)
class PolynomialFit:
    """
    A fitted surface, and the share of the variance that each quadratic explains.

    :param surface: Fitted to all rows.
    :param y_r_squared: R squared of y over v on the centre line.
    :param px_per_cm_r_squared: R squared of px per cm over y.
    :param without: n surfaces, the i-th without point i; None where the others do not suffice.
    """

    surface: PolynomialSurface
    y_r_squared: float
    px_per_cm_r_squared: float
    without: Tuple[Optional[PolynomialSurface], ...]

    @property
    def equations(self) -> Tuple[str, str]:
        """Return both quadratics as the spreadsheet prints them."""
        return (f"y = {_quadratic(self.surface.y_of_v, 'v')}",
                f"px_per_cm = {_quadratic(self.surface.px_per_cm_of_y, 'y')}")


def fit_polynomial(matched: MatchedPoints, image_size: ImageSize) -> PolynomialFit:
    """
    Fit y to v along the centre line, and px per cm to y.

    Points with the same y form a row of the grid. A straight line through the u and v of a row,
    over x, gives its px per cm and its crossing with the centre line x = 0. A single point at
    x = 0 gives only the crossing.

    :param image_size: Width and height of the picture, in px.
    :raises InvalidValueError: If a pixel lies outside the picture.
    :raises CalibrationError: If fewer than three values of y have a px per cm, or cross the line.
    """
    check_inside(matched, image_size)
    surface, y_r_squared, px_per_cm_r_squared = _fit(matched, image_size)
    without = leave_one_out(lambda kept: _fit(matched.take(kept), image_size)[0], len(matched))
    return PolynomialFit(surface, y_r_squared, px_per_cm_r_squared, tuple(without))


def _fit(matched, image_size):
    """Return the surface, and R squared of y and of px per cm."""
    rows = [_grid_row(matched, y) for y in np.unique(matched.points[:, 1])]
    crossings = [row for row in rows if row.crossing is not None]
    scales = [row for row in rows if row.px_per_cm is not None]
    if len(crossings) < 3 or len(scales) < 3:
        raise CalibrationError(
            'the polynomial model needs at least three values of y_cm with two or more points '
            f'each, got {len(scales)}: measure points in rows of the same y_cm')
    v, centre_y = [row.crossing[1] for row in crossings], [row.y for row in crossings]
    y, px_per_cm = [row.y for row in scales], [row.px_per_cm for row in scales]
    surface = PolynomialSurface(_fit_quadratic(v, centre_y, 'v_px'),
                                _fit_quadratic(y, px_per_cm, 'y_cm'),
                                float(np.mean([row.crossing[0] for row in crossings])), image_size)
    return (surface, r_squared(centre_y, np.polyval(surface.y_of_v, v)),
            r_squared(px_per_cm, np.polyval(surface.px_per_cm_of_y, y)))


def r_squared(measured, predicted) -> float:
    """
    Return the share of the measured values' variance that the predicted ones explain.

    :param measured: Shape (n,).
    :param predicted: Shape (n,).
    """
    measured, predicted = np.asarray(measured), np.asarray(predicted)
    total = np.sum((measured - measured.mean()) ** 2)
    left = np.sum((measured - predicted) ** 2)
    return float(1 - left / total) if total > 0 else 1.0


@dataclass(frozen=True)
class _GridRow:
    """A row of points with the same y: u and v where x is 0, and px per cm, as far as known."""

    y: float
    crossing: Optional[np.ndarray]
    px_per_cm: Optional[float]


def _grid_row(matched, y):
    members = matched.points[:, 1] == y
    x, pixels = matched.points[members, 0], matched.pixels[members]
    if len(x) == 1:
        return _GridRow(float(y), pixels[0] if x[0] == 0 else None, None)
    terms = np.stack([x, np.ones_like(x)], axis=1)
    slope, crossing = np.linalg.lstsq(terms, pixels, rcond=None)[0]
    return _GridRow(float(y), crossing, float(slope[0]))


def _fit_quadratic(argument, value, name):
    if len(np.unique(argument)) < 3:
        raise CalibrationError(f'a quadratic needs three different values of {name}, got '
                               f'{sorted(set(argument))}: measure more rows')
    # Fitted about the middle, where the three terms are best conditioned, then multiplied out.
    series = np.polynomial.Polynomial.fit(argument, value, 2).convert()
    coefficients = np.append(series.coef, np.zeros(3))[:3]
    return tuple(float(number) for number in coefficients[::-1])


def _quadratic(coefficients, name):
    a, b, c = (f'{abs(number):.5g}' for number in coefficients)
    signs = ['-' if number < 0 else '+' for number in coefficients]
    return f"{signs[0].strip('+')}{a} {name}^2 {signs[1]} {b} {name} {signs[2]} {c}"
