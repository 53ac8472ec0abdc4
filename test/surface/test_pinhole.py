# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The pinhole model: its lens, its pose, and its parameters."""

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import checked_values
from camera_to_base.surface import (
    LensModel, make_surface, nearest_pinhole, NudgedSurface, PictureMap, PinholeSurface,
    SURFACE_SPECS, surface_values)
import cv2
import numpy as np
import pytest

SIZE = 1280, 720
LENSES = {
    'without distortion': LensModel(SIZE, (900.0, 905.0), (650.0, 350.0)),
    'plumb_bob': LensModel(SIZE, (900.0, 905.0), (650.0, 350.0), (-.25, .1, 1e-3, -2e-3, -.02)),
    'rational': LensModel(SIZE, (900.0, 905.0), (650.0, 350.0), (
        .1, .2, 1e-3, 0.0, .02, .3, .1, 0.0), 'rational_polynomial'),
    'equidistant': LensModel(SIZE, (700.0, 705.0), (650.0, 350.0), (-.01, .02, 1e-3, 0.0),
                             'equidistant'),
}
PIXELS = np.stack(np.meshgrid(np.linspace(0, 1279, 9), np.linspace(0, 719, 7)), -1).reshape(-1, 2)


@pytest.fixture(params=LENSES)
def lens(request):
    return LENSES[request.param]


def looking_at(lens, position, at=(20.0, 15.0, 0.0)):
    """Give a camera at a position above a surface whose y turns right of x, as v does of u."""
    forward = np.subtract(at, position) / np.linalg.norm(np.subtract(at, position))
    down = np.array([0.0, 1.0, 0.0]) - forward[1] * forward
    down /= np.linalg.norm(down)
    matrix = np.stack([np.cross(down, forward), down, forward])
    return PinholeSurface(lens, cv2.Rodrigues(matrix)[0].ravel(), position)


def test_lens_maps_every_pixel_back(lens):
    np.testing.assert_allclose(lens.distort(lens.undistort(PIXELS)), PIXELS, atol=1e-6)


def test_pixels_look_where_opencv_says_the_point_is(lens):
    surface = looking_at(lens, (10.0, 40.0, -70.0))
    points = np.column_stack([surface.locate(PIXELS), np.zeros(len(PIXELS))])
    translation = -surface.optical_from_camera @ surface.position_cm
    project = cv2.fisheye.projectPoints if lens.model == 'equidistant' else cv2.projectPoints
    given = points[:, None] if lens.model == 'equidistant' else points
    shown = project(given, surface.rotation, translation, lens.matrix,
                    np.array(lens.coefficients or (0.0,) * 4))[0].reshape(-1, 2)
    np.testing.assert_allclose(shown, PIXELS, atol=1e-4)
    np.testing.assert_allclose(surface.pixels(points[:, :2]), PIXELS, atol=1e-4)


def test_point_above_the_surface_is_seen_farther_from_the_foot():
    surface = looking_at(LENSES['plumb_bob'], (10.0, 40.0, -70.0))
    top, = surface.locate(surface.pixels_of([[25.0, 20.0, 7.0]]))
    np.testing.assert_allclose(top, [10 + 15 / 0.9, 40 - 20 / 0.9], atol=1e-6)
    assert surface.camera_place == ((10.0, 40.0), 70.0)


def test_pixels_beyond_the_fold_of_a_lens_have_no_answer():
    lens = LensModel(SIZE, (600.0, 600.0), (640.0, 360.0), (-0.4, 0.0, 0.0, 0.0))
    straight = lens.undistort([[640.0, 360.0], [1279.0, 719.0]])
    assert np.isfinite(straight[0]).all() and np.isnan(straight[1]).all()


def test_parameters_make_the_same_surface(lens):
    surface = looking_at(lens, (10.0, 40.0, -70.0))
    again = make_surface(checked_values(SURFACE_SPECS, surface_values(surface, None)))
    np.testing.assert_allclose(again.locate(PIXELS), surface.locate(PIXELS), rtol=1e-12)
    assert again.camera_place == surface.camera_place


@pytest.mark.parametrize('name, value, complaint', [
    ('camera_matrix', [900.0, 1, 640, 0, 900, 360, 0, 0, 1], 'camera_matrix must be'),
    ('camera_matrix', [-900.0, 0, 640, 0, 900, 360, 0, 0, 1], 'fx and fy above 0'),
    ('distortion_coefficients', [0.1] * 8, 'plumb_bob has 4 or 5'),
    ('camera_position_cm', [0.0, 0.0, 0.0], 'height above the surface'),
    ('rotation', [np.pi, 0.0, 0.0], 'does not look at the surface'),
])
def test_value_that_describes_no_camera_is_refused(name, value, complaint):
    values = {'surface.model': 'pinhole', f'surface.pinhole.{name}': value}
    with pytest.raises(InvalidValueError, match=complaint):
        make_surface(checked_values(SURFACE_SPECS, values))


def test_pose_of_a_nudged_camera_is_found():
    lens = LENSES['plumb_bob']
    before = looking_at(lens, (10.0, 40.0, -70.0))
    after = looking_at(lens, (10.6, 40.2, -69.5), (20.4, 14.8, 0.0))
    pixel_of = [np.linalg.inv(surface.surface_from_pixel) for surface in (before, after)]
    moved = NudgedSurface(before, PictureMap(pixel_of[0] @ after.surface_from_pixel, lens), SIZE)
    found = nearest_pinhole(moved, before, SIZE)
    np.testing.assert_allclose(found.position_cm, after.position_cm, atol=1e-4)
