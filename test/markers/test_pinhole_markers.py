# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Markers with a pinhole file: the camera's new pose, with its height and its foot point."""

from camera_to_base.markers import MarkedSurface, marker_values
from camera_to_base.markers.fit import fit_markers
from camera_to_base.parameters import checked_values
from camera_to_base.settings import CAMERA_SPECS
from camera_to_base.surface import LensModel, PinholeSurface, surface_values
import cv2
import numpy as np
import pytest

SIZE = 1280, 720
LENS = LensModel(SIZE, (1000.0, 1000.0), (650.0, 352.0), (-0.2, 0.06, 0.001, -0.001, 0.0))
MIDDLES = ((4.0, 4.0), (36.0, 5.0), (35.0, 24.0), (5.0, 23.0))
MARKERS = {number: np.array(middle) + 2.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
           for number, middle in enumerate(MIDDLES)}
OBJECTS = np.array([[20.0, 15.0, 5.0], [8.0, 20.0, 5.0], [33.0, 10.0, 3.0]])


def camera_at(position, tilt_deg):
    rotation = np.radians([tilt_deg, 0.6 * tilt_deg, 2.0])
    matrix = cv2.Rodrigues(rotation)[0]
    # It looks at the middle of the table from wherever it is.
    away = matrix.T @ [0.0, 0.0, 1.0]
    foot = np.array([20.0, 14.0]) - away[:2] / away[2] * position
    return PinholeSurface(LENS, rotation, [*foot, -position])


def seen_by(camera, numbers=(0, 1, 2, 3), noise=0.0, seed=0):
    random = np.random.default_rng(seed)
    return {number: camera.pixels(MARKERS[number]) + random.normal(0, noise, (4, 2))
            for number in numbers}


def calibrated(camera):
    values = {**surface_values(camera, None), **marker_values(MARKERS)}
    return MarkedSurface.of(checked_values(CAMERA_SPECS, values))


@pytest.mark.parametrize('numbers', [(0, 1, 2, 3), (0, 2, 3)])
@pytest.mark.parametrize('height, tilt', [(60.0, 8.0), (75.0, 20.0), (68.0, -15.0)])
def test_moved_camera_has_its_new_height_and_foot(numbers, height, tilt):
    marked, moved = calibrated(camera_at(70.0, 4.0)), camera_at(height, tilt)
    verdict = marked.judge(seen_by(moved, numbers))
    assert verdict.fit is not None
    surface = marked.anew(verdict.fit).surface
    assert surface.camera_place.height_cm == pytest.approx(height, abs=0.02)
    assert surface.camera_place.foot_cm == pytest.approx(moved.camera_place.foot_cm, abs=0.02)
    np.testing.assert_allclose(
        surface.pixels_of(OBJECTS), moved.pixels_of(OBJECTS), atol=0.05)


def test_pose_is_less_uncertain_than_a_homography():
    moved = camera_at(75.0, 20.0)
    fit = fit_markers(MARKERS, seen_by(moved, noise=0.1), SIZE, LENS)
    plain = fit_markers(MARKERS, seen_by(moved, noise=0.1), SIZE, moved_plain(LENS))
    assert np.trace(fit.gain @ fit.gain.T) < np.trace(plain.gain @ plain.gain.T)
    assert fit.rms_px < 0.3


def moved_plain(lens):
    """Give a lens of the division model that is about the same."""
    from camera_to_base.surface import RadialDistortion
    return RadialDistortion.of_picture(SIZE, lens.coefficient, lens.centre)
