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
"""
The least-squares problem of touched markers: squares of a known size, and the robot's touches.

Four squares tell more than their places: the size of each tells the scale near it, and its shape
the tilt and the lens. Fitted are the eight numbers of a homography from the base frame to the
picture, three of the lens, where each square lies and how it is turned, by how much blur moves all
edges inwards, and by how much the size of the print is off.
"""

from typing import NamedTuple, Optional, Tuple

from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.image_size import ImageSize
from camera_to_base.markers import outward_moves
from camera_to_base.surface import homogeneous, HomographySurface, RadialDistortion, undivide
from camera_to_base.uncertainty import LENS_DEVIATIONS, pooled_variance
import cv2
import numpy as np

# A marker's edge differs from what was measured by this share.
SIZE_DEVIATION = 0.01
# The usual error of a corner: of the picture, in pictures of this width, and of the print.
_CORNER_PX, _USUAL_WIDTH, _PRINT_CM, _CORNER_WORTH = 0.1, 1280, 0.005, 10.0
# That of a touch. Four touches with four squares leave little that shows it.
_TOUCH_CM, _TOUCH_WORTH = 0.12, 8.0
# Blur and the camera's gamma move edges inwards: by 0.2 to 0.6 px on rendered cameras.
INSET_PX, INSET_DEVIATION_PX = 0.35, 0.35
_HOMOGRAPHY, _COEFFICIENT, _CENTRE, _INSET, _SIZE, _FIRST_PLACE = (
    np.s_[:8], 8, np.s_[9:11], 11, 12, 13)
_SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
# What a corner is off that no camera shows, in px.
_UNSEEN_PX = 1e3
_ROUNDS = 3
# Usual touches need 5 to 15 steps; wrong ones may never converge.
_MOST_STEPS = 40


class TouchedMarkers(NamedTuple):
    """
    Markers that the camera sees and the robot has touched.

    :param numbers: Of the markers, n of them.
    :param pixels: Shape (n, 4, 2), their corners as printed, in px.
    :param touches: Shape (n, 2), their middles in the base frame, in cm.
    :param edge_cm: Their black squares' edge.
    """

    numbers: Tuple[int, ...]
    pixels: np.ndarray
    touches: np.ndarray
    edge_cm: float


class TouchedFit(NamedTuple):
    """
    Where the markers are, and what the camera sees.

    :param surface: From pixels to x and y of the base frame.
    :param places: Shape (n, 3): x and y of each marker's middle, in cm, and its turn, in rad.
    :param size: The edge, as a share of the edge that was given.
    :param inset_px: By how much all edges are seen moved inwards.
    :param pixels: Shape (4 n, 2), the corners without the inset that blur causes.
    :param points: Shape (4 n, 2), the corners in the base frame, in cm.
    :param residuals_px: Shape (4 n, 2).
    :param corner_px: Standard deviation of a corner's coordinate.
    :param touch_cm: Standard deviation of a touch's coordinate.
    """

    surface: HomographySurface
    places: np.ndarray
    size: float
    inset_px: float
    pixels: np.ndarray
    points: np.ndarray
    residuals_px: np.ndarray
    corner_px: float
    touch_cm: float


def fit_touched(
    markers: TouchedMarkers, image_size: ImageSize, *, without_touch: Optional[int] = None,
    is_size_known: bool = True,
) -> TouchedFit:
    """
    Fit the camera's view of the base frame's plane.

    :param without_touch: The index of a touch that does not count; it only starts the search.
    :param is_size_known: Whether the squares' size counts; otherwise the touches give it.
    :raises CalibrationError: If no camera sees the markers where they were touched.
    """
    return _Problem(markers, image_size, without_touch, is_size_known).solve()


class _Problem:
    """
    The problem in units without a dimension: the picture in halves of its diagonal.

    Touches are shifted and divided by their extent.
    """

    def __init__(self, markers: TouchedMarkers, image_size: ImageSize,
                 without_touch: Optional[int], is_size_known: bool) -> None:
        self._size, self._picture = image_size, RadialDistortion.of_picture(image_size)
        self._pixels = markers.pixels.reshape(-1, 2)
        self._offsets = (self._pixels - self._picture.centre) / self._picture.radius
        self._outwards = outward_moves(self._pixels)
        self._origin = markers.touches.mean(axis=0)
        self._extent_cm = float(np.ptp(markers.touches, axis=0).max())
        self._touches = (markers.touches - self._origin) / self._extent_cm
        self._counting = np.arange(len(self._touches)) != without_touch
        self._edge = markers.edge_cm / self._extent_cm
        self._size_deviation = SIZE_DEVIATION if is_size_known else 100.0
        edges_px = np.linalg.norm(markers.pixels - np.roll(markers.pixels, 1, axis=1), axis=2)
        self._expected_px = float(np.hypot(
            _CORNER_PX * max(image_size[0] / _USUAL_WIDTH, 0.5),
            _PRINT_CM * edges_px.mean() / markers.edge_cm))
        self._square = _SQUARE * self._side()

    def solve(self) -> TouchedFit:
        from scipy.optimize import least_squares

        trial = self._start()
        corner_px, touch_cm = self._expected_px, _TOUCH_CM
        for _ in range(_ROUNDS):
            found = least_squares(self._weighted, trial, args=(corner_px, touch_cm),
                                  max_nfev=_MOST_STEPS)
            trial = found.x
            corner_px, touch_cm = self._deviations(found.fun, found.jac, corner_px, touch_cm)
        return self._fit(trial, corner_px, touch_cm)

    def _side(self) -> Tuple[int, int]:
        """Return (1, -1) where the base frame's y is seen anticlockwise from x."""
        middles = self._offsets.reshape(-1, 4, 2).mean(axis=1)
        affine = np.linalg.lstsq(self._touches, middles - middles.mean(axis=0), rcond=None)[0]
        return 1, 1 if np.linalg.det(affine) > 0 else -1

    def _start(self) -> np.ndarray:
        middles = self._offsets.reshape(-1, 4, 2).mean(axis=1)
        homography, _ = cv2.findHomography(self._touches, middles)
        try:
            back = homogeneous(np.linalg.inv(homography), self._offsets)
        except (TypeError, np.linalg.LinAlgError) as error:  # findHomography returns None
            raise CalibrationError(_NO_CAMERA) from error
        if back[:, 2].min() * back[:, 2].max() <= 0:  # the horizon lies between the markers
            raise CalibrationError(_NO_CAMERA)
        corners = (back[:, :2] / back[:, 2:]).reshape(-1, 4, 2)
        along = corners[:, 1] - corners[:, 0] + corners[:, 2] - corners[:, 3]
        turns = np.arctan2(along[:, 1], along[:, 0])
        places = np.column_stack([self._touches, turns])
        return np.concatenate([(homography / homography[2, 2]).ravel()[:8], [0, 0, 0, INSET_PX, 1],
                               places.ravel()])

    def _points(self, trial: np.ndarray) -> np.ndarray:
        x, y, turn = trial[_FIRST_PLACE:].reshape(-1, 3).T
        turned = np.stack([np.cos(turn), -np.sin(turn), np.sin(turn), np.cos(turn)], axis=-1)
        square = self._edge * trial[_SIZE] * self._square
        corners = np.einsum('nij,kj->nki', turned.reshape(-1, 2, 2), square)
        return (corners + np.column_stack([x, y])[:, None]).reshape(-1, 2)

    def _misfit_px(self, trial: np.ndarray) -> np.ndarray:
        with np.errstate(all='ignore'):
            shown = homogeneous(np.append(trial[_HOMOGRAPHY], 1).reshape(3, 3),
                                self._points(trial))
            shown = shown[:, :2] / shown[:, 2:]
            shown = trial[_CENTRE] + undivide(shown - trial[_CENTRE], trial[_COEFFICIENT])
        misfit = self._picture.radius * (shown - self._offsets) - trial[_INSET] * self._outwards
        return np.nan_to_num(misfit, nan=_UNSEEN_PX).clip(-_UNSEEN_PX, _UNSEEN_PX)

    def _weighted(self, trial: np.ndarray, corner_px: float, touch_cm: float) -> np.ndarray:
        missed = (trial[_FIRST_PLACE:].reshape(-1, 3)[:, :2] - self._touches)[self._counting]
        lens = np.append(trial[_COEFFICIENT], trial[_CENTRE])
        return np.concatenate([
            self._misfit_px(trial).ravel() / corner_px,
            self._extent_cm / touch_cm * missed.ravel(), lens / LENS_DEVIATIONS[:3],
            [(trial[_SIZE] - 1) / self._size_deviation,
             (trial[_INSET] - INSET_PX) / INSET_DEVIATION_PX]])

    def _deviations(
        self, residuals: np.ndarray, jacobian: np.ndarray, corner_px: float, touch_cm: float
    ) -> Tuple[float, float]:
        """Return the standard deviations of a corner's and of a touch's coordinate."""
        leverage = np.sum(np.linalg.qr(jacobian)[0] ** 2, axis=1)
        corners = np.s_[:2 * len(self._pixels)]
        touches = np.s_[corners.stop:corners.stop + 2 * int(self._counting.sum())]
        return tuple(float(np.sqrt(pooled_variance(
            np.sum((unit * residuals[rows]) ** 2), float(np.sum(1 - leverage[rows])), usual,
            worth))) for rows, unit, usual, worth in (
                (corners, corner_px, self._expected_px, _CORNER_WORTH),
                (touches, touch_cm, _TOUCH_CM, _TOUCH_WORTH)))

    def _fit(self, trial: np.ndarray, corner_px: float, touch_cm: float) -> TouchedFit:
        centre, radius = np.array(self._picture.centre), self._picture.radius
        pixel_from_unit = np.array([[radius, 0, centre[0]], [0, radius, centre[1]], [0, 0, 1]])
        unit_from_base = np.array([[1, 0, -self._origin[0]], [0, 1, -self._origin[1]],
                                   [0, 0, self._extent_cm]])
        homography = np.append(trial[_HOMOGRAPHY], 1).reshape(3, 3)
        points = self._origin + self._extent_cm * self._points(trial)
        try:
            lens = RadialDistortion.of_picture(
                self._size, trial[_COEFFICIENT], centre + radius * trial[_CENTRE])
            surface = HomographySurface(np.linalg.inv(
                pixel_from_unit @ homography @ unit_from_base), self._size, lens)
            is_seen = bool(np.isfinite(surface.pixels(points)).all())
        except (InvalidValueError, np.linalg.LinAlgError):
            is_seen = False
        if not is_seen:
            raise CalibrationError(_NO_CAMERA)
        places = trial[_FIRST_PLACE:].reshape(-1, 3).copy()
        places[:, :2] = self._origin + self._extent_cm * places[:, :2]
        return TouchedFit(
            surface, places, float(trial[_SIZE]), float(trial[_INSET]),
            self._pixels + trial[_INSET] * self._outwards, points, self._misfit_px(trial),
            corner_px, touch_cm)


_NO_CAMERA = 'no camera sees the markers in the picture where they were touched'
