# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Random cells of a camera, a table and a robot, with known truth, for the benchmark."""

from dataclasses import dataclass
import math
from typing import Dict, NamedTuple, Tuple

from camera_to_base.calibration.checks import surface_error
from camera_to_base.calibration.homography_fit import HomographyProblem
from camera_to_base.calibration.rigid_fit import align
from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.surface import HomographySurface, MatchedPoints, RadialDistortion
from camera_to_base.uncertainty import (
    base_covariance, base_error, FrameState, PositionUncertainty, Shape, ShiftMean,
    Spread, WARP_NUMBERS)
import numpy as np

SIZE = 640, 480
_CENTRE = np.array([319.5, 239.5])
# Deviations of what the fitted lens does not describe, see :class:`WarpedSurface`.
_LENS = 0.04, 0.006, 0.006
TERMS = 'detection', 'surface', 'base', 'height', 'view', 'all'


class Outcome(NamedTuple):
    """
    A position's error and what was said of it.

    :param error: x and y, in cm, in the frame of the covariance.
    :param covariance: Shape (2, 2), in cm².
    """

    error: np.ndarray
    covariance: np.ndarray

    @property
    def square(self) -> float:
        """The squared error relative to the covariance."""
        return float(self.error @ np.linalg.pinv(self.covariance, rcond=1e-9) @ self.error)


class WarpedSurface:
    """
    The surface of a lens that the fitted model does not describe in full.

    :param surface: The part that it describes.
    :param numbers: Of the radial term of the fifth power, and of a lens that is not centred.
    """

    def __init__(self, surface: HomographySurface, numbers: np.ndarray) -> None:
        self._surface, self._numbers = surface, numbers
        self.distortion = surface.distortion

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the surface, both of shape (n, 2)."""
        pixels = np.asarray(pixels, float)
        return self._surface.locate(pixels + self._warp(pixels))

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Map points to pixels, both of shape (n, 2)."""
        there = self._surface.pixels(points)
        found = there
        for _ in range(20):
            # What lies far outside of the picture has no pixel.
            found = np.clip(there - self._warp(found), -1000, 2000)
        return found

    def for_image_size(self, image_size: Tuple[int, int]) -> 'WarpedSurface':
        """Give the model for pictures of a size: there is one."""
        return self

    def _warp(self, pixels: np.ndarray) -> np.ndarray:
        offsets = (pixels - _CENTRE) / 400
        squares = np.sum(offsets ** 2, axis=1, keepdims=True)
        fifth, shear = self._numbers[0], self._numbers[1:]
        return 400 * (fifth * offsets * squares ** 2 + squares * shear
                      + 2 * offsets * (offsets @ shear)[:, None])


@dataclass
class Cell:
    """
    A cell: camera with lens above a table, board, touches of a robot, an object.

    :param random: The generator that all of it is drawn from.
    """

    random: np.random.Generator

    def __post_init__(self) -> None:
        """Draw the cell."""
        uniform = self.random.uniform
        self.focal_px = SIZE[0] * uniform(0.8, 1.4)
        self.height_cm = uniform(40, 100)
        self._pixel_from_surface, self.foot = self._camera(uniform(0, np.radians(45)))
        self.lens = RadialDistortion.of_picture(
            SIZE, float(np.clip(self.random.normal(0, 0.1), -0.3, 0.3)),
            _CENTRE + 400 * 0.02 * self.random.normal(size=2))
        self.surface = WarpedSurface(
            HomographySurface(np.linalg.inv(self._pixel_from_surface), SIZE, self.lens),
            self.random.normal(0, _LENS))
        self.pixel = np.array([uniform(40, SIZE[0] - 40), uniform(40, SIZE[1] - 40)])
        self.point = self.surface.locate([self.pixel])[0]

    def _camera(self, tilt: float) -> Tuple[np.ndarray, np.ndarray]:
        """Return the homography from the surface to undistorted pixels, and the foot point."""
        turn, roll = self.random.uniform(-np.pi, np.pi, 2)
        down = np.array([[1, 0, 0], [0, -1, 0], [0, 0, -1.0]])
        rotation = _about_z(roll) @ _about_x(tilt) @ down @ _about_z(turn)
        place = np.array([*self.random.uniform(-10, 10, 2), self.height_cm])
        matrix = np.diag([self.focal_px, self.focal_px, 1.0])
        matrix[:2, 2] = _CENTRE
        return matrix @ np.column_stack(
            [rotation[:, 0], rotation[:, 1], -rotation @ place]), place[:2]

    def outcomes(self) -> Dict[str, Outcome]:
        """Return the outcome of each term alone, and of all together."""
        shape, centre_error, noise = self._seen()
        fitted, fit = self._calibrated()
        view = self._shaken()
        tolerance = self.random.uniform(0.05, 0.5)
        higher = tolerance * self.random.normal()
        exact, errors = np.zeros((WARP_NUMBERS,) * 2), {}
        place = CameraPlace(tuple(self.foot), self.height_cm)
        truth = PositionUncertainty(self.surface, exact, place, 0.0, 0.0)
        still = FrameState(SIZE, noise)
        errors['detection'] = Outcome(
            self.surface.locate([shape.pixel])[0] - self.point,
            _plane(truth.covariance(shape, still)))
        at_truth = shape._replace(pixel=tuple(self.pixel))
        none = shape._replace(spread=Spread(0.0, 0.0, 0.0), pixel=tuple(self.pixel))
        said = PositionUncertainty(fitted, fit.covariance, place)
        errors['surface'] = Outcome(
            fitted.locate([self.pixel])[0] - self.point, said.at_pixels(self.pixel[None], SIZE)[0])
        seen = self._raised(higher)
        high = PositionUncertainty(self.surface, exact, place, 0.0, tolerance)
        errors['height'] = Outcome(self.surface.locate([seen])[0] - self.point,
                                   high.at_pixels(self.pixel[None], SIZE)[0])
        shifted = self.pixel + view[0]
        errors['view'] = Outcome(
            self.surface.locate([shifted])[0] - self.point,
            _plane(truth.covariance(none, FrameState(SIZE, noise, view[1]))))
        everything = PositionUncertainty(fitted, fit.covariance, place, 0.0, tolerance)
        pixel = seen + view[0] + centre_error
        said = everything.covariance(at_truth, FrameState(SIZE, noise, view[1])).matrix
        errors['base'] = self._touched(self.surface, self.point, np.zeros((6, 6)))
        errors['all'] = self._touched(fitted, fitted.locate([pixel])[0], said)
        return errors

    def _seen(self) -> Tuple[Shape, np.ndarray, float]:
        """Draw an ellipse with noise; return what a detector tells, its error, and the noise."""
        uniform = self.random.uniform
        axes, angle = np.array([uniform(6, 20), uniform(6, 20)]), uniform(0, np.pi)
        contrast, noise, width = uniform(15, 120), uniform(0.5, 4), uniform(1, 4)
        place = uniform(-0.5, 0.5, 2)
        v, u = np.mgrid[-30:31, -30:31].astype(float)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        along = (np.stack([u, v], axis=-1) - place) @ turn.T / axes
        radius = np.hypot(along[..., 0], along[..., 1])
        slope = np.hypot(along[..., 0] / axes[0], along[..., 1] / axes[1]) / np.maximum(radius, .1)
        outside_px = (radius - 1) / np.maximum(slope, 1e-6)
        shares = np.clip(0.5 - outside_px / width, 0, 1)
        rim = np.abs(outside_px) < width / 2
        seen = shares + rim * self.random.normal(0, noise / contrast, shares.shape)
        centre = _centroid(seen, u, v)
        spread = turn.T @ np.diag(axes ** 2 / 4) @ turn
        error = centre - _centroid(shares, u, v)
        shape = Shape(tuple(self.pixel + error), float(shares.sum()),
                      Spread(spread[0, 0], spread[0, 1], spread[1, 1]), contrast, width)
        return shape, error, noise

    def _calibrated(self):
        """Fit a surface to a board that covers a part of the picture."""
        columns, rows = self.random.integers(6, 10), self.random.integers(5, 8)
        middle = self.surface.locate([_CENTRE + self.random.uniform(-60, 60, 2)])[0]
        square = self.random.uniform(0.06, 0.11) * SIZE[0] / self.focal_px * self.height_cm
        v, u = np.mgrid[:rows, :columns].astype(float)
        grid = square * np.stack([u.ravel() - (columns - 1) / 2, v.ravel() - (rows - 1) / 2], 1)
        points = grid @ _about_z(self.random.uniform(-np.pi, np.pi))[:2, :2] + middle
        pixels = self.surface.pixels(points)
        inside = ((pixels > 2) & (pixels < np.array(SIZE) - 3)).all(axis=1)
        noise = math.exp(self.random.uniform(math.log(0.1), math.log(0.25)))
        pixels = pixels[inside] + self.random.normal(0, noise, (inside.sum(), 2))
        matched = MatchedPoints(points[inside], pixels)
        problem = HomographyProblem([matched], SIZE, with_distortion=True)
        fitted = problem.surface(problem.solve()[0], np.arange(len(matched)))
        return fitted, surface_error(fitted, matched, SIZE, 'corner')

    def _shaken(self) -> Tuple[np.ndarray, float]:
        """Shake the camera; return a frame's shift and what the last frames told of it."""
        deviation, mean = self.random.uniform(0.1, 1.0), ShiftMean()
        for shift in self.random.normal(0, deviation, (200, 2)):
            mean.add(float(np.hypot(*shift)))
        return self.random.normal(0, deviation, 2), mean.deviation_px

    def _raised(self, height: float) -> np.ndarray:
        """Return the pixel that shows a point above the object's."""
        lift = 1 / (1 - height / self.height_cm)
        return self.surface.pixels([self.foot + (self.point - self.foot) * lift])[0]

    def _touched(self, surface: HomographySurface, point: np.ndarray, said: np.ndarray) -> Outcome:
        """Calibrate the base on touches of points that a surface has located."""
        count = self.random.integers(6, 13)
        pixels = self.random.uniform(40, np.array(SIZE) - 40, (count, 2))
        touch = math.exp(self.random.uniform(math.log(0.07), math.log(0.14)))
        truth = np.pad(self.surface.locate(pixels), ((0, 0), (0, 1)))
        camera = np.pad(surface.locate(pixels), ((0, 0), (0, 1)))
        rotation = _about_z(self.random.uniform(-np.pi, np.pi)) @ np.diag([1.0, -1, -1])
        base = truth @ rotation.T
        base[:, :2] += self.random.normal(0, touch, (count, 2))
        fit = align(camera, base)
        folds = [align(np.delete(camera, i, 0), np.delete(base, i, 0)) for i in range(count)]
        left_out = np.stack([fold[0] @ one + fold[1] - other
                             for fold, one, other in zip(folds, camera, base)])
        error = base_error(camera @ fit[0].T, left_out, flat=True)
        spot = np.append(point, 0.0)
        covariance = base_covariance(said, spot, fit[0], error)
        found = fit[0] @ spot + fit[1] - rotation @ np.append(self.point, 0.0)
        return Outcome(found[:2], covariance[:2, :2])


def _plane(covariance) -> np.ndarray:
    return covariance.matrix[:2, :2]


def _centroid(shares: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.array([(shares * u).sum(), (shares * v).sum()]) / shares.sum()


def _about_z(angle: float) -> np.ndarray:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1.0]])


def _about_x(angle: float) -> np.ndarray:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0, 0], [0, cos, -sin], [0, sin, cos]])
