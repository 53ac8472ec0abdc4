# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A surface behind a homography, and the map between two pictures of one lens."""

from camera_to_base.errors import FrameSizeError, HorizonError
from camera_to_base.surface import (
    HomographySurface, NudgedSurface, PictureMap, PolynomialSurface, RadialDistortion)
import numpy as np
import pytest

SIZE = 640, 480
LENS = RadialDistortion.of_picture(SIZE, -0.15)
MATRIX = np.array([[1.01, 0.02, 7.0], [-0.015, 0.99, -4.0], [1e-5, -2e-5, 1.0]])
PIXELS = np.array([[3.0, 5.0], [600.0, 20.0], [320.0, 240.0], [15.0, 470.0], [630.0, 475.0]])


def test_map_and_its_inverse_cancel():
    there = PictureMap(MATRIX, LENS)
    assert there.inverse.pixels(there.pixels(PIXELS)) == pytest.approx(PIXELS, abs=1e-6)


def test_map_of_a_lens_undistorts_maps_and_distorts():
    undistorted = np.column_stack([LENS.undistort(PIXELS), np.ones(len(PIXELS))]) @ MATRIX.T
    expected = LENS.distort(undistorted[:, :2] / undistorted[:, 2:])
    assert PictureMap(MATRIX, LENS).pixels(PIXELS) == pytest.approx(expected)


@pytest.mark.parametrize('lens', [None, LENS])
def test_grid_holds_what_the_map_says_at_each_pixel(lens):
    there = PictureMap(MATRIX, lens)
    grid = there.grid(SIZE)
    assert grid.shape == (480, 640, 2)
    for pixel in PIXELS.astype(int):
        assert grid[pixel[1], pixel[0]] == pytest.approx(
            there.pixels(pixel[None])[0], abs=0.01)


def test_grid_of_a_smaller_picture_is_in_its_own_px():
    there = PictureMap(MATRIX)
    grid = there.grid((320, 240), scale=2.0)
    full = there.pixels(np.array([[200.5, 100.5]]))[0]
    assert grid[50, 100] == pytest.approx((full + 0.5) / 2 - 0.5, abs=0.01)


def test_one_map_after_another_is_their_product():
    first, second = PictureMap(MATRIX, LENS), PictureMap(np.linalg.inv(MATRIX) + 0.001, LENS)
    assert second.after(first).pixels(PIXELS) == pytest.approx(
        second.pixels(first.pixels(PIXELS)))


@pytest.mark.parametrize('surface', [
    HomographySurface(np.diag([0.05, 0.05, 1.0]), SIZE, LENS), PolynomialSurface()])
def test_nudged_camera_sees_a_point_where_the_nudge_has_moved_its_pixel(surface):
    moved = PictureMap(MATRIX, surface.distortion)
    nudged = NudgedSurface(surface, moved.inverse, SIZE)
    inside = PIXELS[2:4]
    assert nudged.locate(moved.pixels(inside)) == pytest.approx(surface.locate(inside), abs=1e-6)


def test_pixel_that_the_calibrated_camera_could_not_see_lies_beyond_the_horizon():
    back = PictureMap(np.array([[1.0, 0, 0], [0, 1, 0], [0, -0.003, 1]]))
    nudged = NudgedSurface(HomographySurface(np.diag([0.05, 0.05, 1.0]), SIZE), back, SIZE)
    with pytest.raises(HorizonError):
        nudged.locate([[320.0, 470.0]])


def test_nudge_holds_for_its_picture_size_alone():
    surface = HomographySurface(np.diag([0.05, 0.05, 1.0]), SIZE)
    nudged = NudgedSurface(surface, PictureMap(MATRIX), SIZE)
    assert nudged.for_image_size(SIZE).locate(PIXELS) == pytest.approx(nudged.locate(PIXELS))
    with pytest.raises(FrameSizeError, match='320 x 240'):
        nudged.for_image_size((320, 240))
