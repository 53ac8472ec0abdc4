# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Error figures of a calibration, and a single outlier among its measurements."""

from dataclasses import dataclass
from typing import Any, Callable, List, Optional, Sequence

from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, HorizonError
from camera_to_base.surface import HomographySurface, Hull, MatchedPoints, Surface
import numpy as np

# Of a hundred tables without an outlier, one is wrongly reported to have one.
FALSE_ALARMS = 0.01

MM_PER_CM = 10

# Errors of points below this need no doubt: a ruler and a click are off by more.
_LEAST_DOUBT_MM = 0.2

# The tilt is reported if its standard error is less than this, in degrees.
TILT_TOLERANCE_DEG = 3.0


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


@dataclass(frozen=True)
class ErrorFigures:
    """
    Distances between the measured and the computed positions of points.

    :param leave_one_out_rms_mm: The rms error of each point under the calibration from all other
        points; None if the others do not suffice.
    :param worst_row: The row of the largest error.
    """

    points: int
    mean_mm: float
    rms_mm: float
    max_mm: float
    worst_row: int
    leave_one_out_rms_mm: Optional[float] = None


def error_figures(errors_cm: np.ndarray, rows: Sequence[int],
                  left_out_cm: Optional[np.ndarray] = None) -> ErrorFigures:
    """
    Summarise errors.

    :param errors_cm: Shape (n,), the distances.
    :param rows: The rows of the n points.
    :param left_out_cm: Shape (n,), each point's distance under the calibration without it; None if
        unknown.
    """
    errors = MM_PER_CM * np.asarray(errors_cm, float)
    left_out = None if left_out_cm is None else MM_PER_CM * root_mean_square(left_out_cm)
    return ErrorFigures(len(errors), float(errors.mean()), root_mean_square(errors),
                        float(errors.max()), rows[int(np.argmax(errors))], left_out)


def surface_errors(surface: Surface, matched: MatchedPoints) -> np.ndarray:
    """
    Return the error of a surface at each point.

    :returns: Shape (n,), in cm.
    :raises HorizonError: If a pixel lies on the horizon or beyond it.
    """
    return np.linalg.norm(surface.locate(matched.pixels) - matched.points, axis=1)


def left_out_errors(
    surfaces: Sequence[Optional[Surface]], matched: MatchedPoints
) -> Optional[np.ndarray]:
    """
    Return each point's error under the surface that was fitted without it.

    :param surfaces: n surfaces; None where the other points do not suffice.
    :returns: Shape (n,), in cm; None if one of them is unknown.
    """
    if None in surfaces:
        return None
    try:
        located = [surface.locate([pixel])[0] for surface, pixel in zip(surfaces, matched.pixels)]
    except HorizonError:
        return None
    return np.linalg.norm(located - matched.points, axis=1)


def leave_one_out(fit: Callable[[np.ndarray], Any], count: int) -> List[Any]:
    """
    Fit without each of `count` points in turn.

    :param fit: Makes a fit from the indices of the points that are kept.
    :returns: The fits; None where the other points do not suffice.
    """
    return leave_out(fit, count, count)


def leave_out(fit: Callable[[np.ndarray], Any], count: int, most_fits: int) -> List[Any]:
    """
    Fit without each of `count` points, or without a few at once where there are many.

    :param fit: Makes a fit from the indices of the points that are kept.
    :param most_fits: At most so many fits are made.
    :returns: For each point a fit that has not seen it; None where the others do not suffice.
    """
    groups = np.arange(count) % min(count, most_fits)
    fits = [_or_none(fit, np.flatnonzero(groups != group)) for group in range(groups.max() + 1)]
    return [fits[group] for group in groups]


def _or_none(fit, kept):
    try:
        return fit(kept)
    except CalibrationError:
        return None


def root_mean_square(values: np.ndarray) -> float:
    """
    Return the root of the mean square.

    :param values: Shape (n,).
    """
    return float(np.sqrt(np.mean(np.square(values))))


def coverage(hull: Hull, image_size: ImageSize) -> float:
    """
    Return the share of the picture that a hull covers, 0 to 1.

    :param image_size: Width and height, in px.
    """
    return hull.area / (image_size[0] * image_size[1])


def tilt(
    surface: HomographySurface, without: Sequence[Optional[HomographySurface]]
) -> Optional[float]:
    """
    Return the angle between the camera's axis and the surface's normal, if it is well determined.

    It is well determined if it is about the same without each of the points. With few points, or a
    camera that looks almost straight down, the tilt and the focal length cannot be separated.

    :param without: The n surfaces that were fitted without one point each, or None.
    :returns: In degrees, 0 for a camera that looks straight down; None if not well determined.
    """
    if None in without or not without:
        return None
    value = tilt_of(surface)
    # A fit without several points stands for each of them.
    others = np.array([tilt_of(other) for other in {id(one): one for one in without}.values()])
    # Jackknife: the standard error of a value from its values without each point.
    deviation = np.sqrt((len(others) - 1) * np.mean((others - others.mean()) ** 2))
    return value if deviation < TILT_TOLERANCE_DEG else None


def tilt_of(surface: HomographySurface) -> float:
    """
    Return the tilt, assuming square pixels and a principal point at the centre of distortion.

    With the surface's axes turned so that only x runs to the horizon, exactly one focal length
    makes the columns of the homography equally long.

    :returns: In degrees; NaN if no focal length fits.
    """
    centre = np.array(surface.distortion.centre)
    pixel_from_surface = np.linalg.inv(surface.surface_from_pixel)
    columns = pixel_from_surface[:, :2]
    columns = np.vstack([columns[:2] - centre[:, None] * columns[2], columns[2]])
    fall = np.linalg.norm(columns[2])
    if fall == 0:
        return float('nan')
    along = columns[2] / fall
    towards, across = columns @ along, columns @ np.array([-along[1], along[0]])
    focal_squared = (across[:2] @ across[:2] - towards[:2] @ towards[:2]) / fall ** 2
    if not focal_squared > 0:
        return float('nan')
    scale = np.array([1, 1, np.sqrt(focal_squared)])
    normal = np.cross(towards * scale, across * scale)
    return float(np.degrees(np.arccos(abs(normal[2]) / np.linalg.norm(normal))))


def warnings(figures: ErrorFigures, covered: Optional[float] = None) -> List[str]:
    """
    Return warnings about figures that cannot be trusted.

    :param covered: The share of the picture that the points cover, 0 to 1.
    """
    found = []
    left_out = figures.leave_one_out_rms_mm
    if left_out is None:
        found.append('there are too few points to tell how well points are located that the fit '
                     'has not seen: add some')
    elif left_out > 2 * figures.rms_mm and left_out > _LEAST_DOUBT_MM:
        found.append(f'points that the fit has not seen are off by {left_out:.2f} mm, much more '
                     f'than the {figures.rms_mm:.2f} mm of those that it has: add points')
    if covered is not None and covered < 0.1:
        found.append(f'the points cover only {100 * covered:.0f} % of the picture, and outside of '
                     'them the figures do not hold: spread them over the working area')
    return found
