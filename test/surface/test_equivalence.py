# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Surfaces as homographies, and surfaces that are the same."""

from camera_to_base.surface import (
    as_homography, HomographySurface, is_same_surface, NudgedSurface, PictureMap,
    PolynomialSurface, RadialDistortion)
from camera_to_base.surface.models import ParallelSurface
import numpy as np
import pytest

SIZE = 640, 480
LENS = RadialDistortion.of_picture(SIZE, -0.12, [300.0, 250.0])
TILTED = HomographySurface(
    np.array([[0.06, 0.002, 1.0], [0.001, 0.07, 2.0], [1e-5, 9e-4, 1.0]]), SIZE, LENS)
NUDGE = PictureMap(np.array([[1.01, 0.004, 5.0], [-0.004, 1.0, -7.0], [1e-6, -2e-6, 1.0]]), LENS)
PIXELS = np.random.default_rng(1).uniform((0, 0), SIZE, (50, 2))


@pytest.mark.parametrize('surface', [
    TILTED, NudgedSurface(TILTED, NUDGE, SIZE), ParallelSurface(36.0, 1280)],
    ids=['tilted', 'nudged', 'parallel'])
def test_surface_as_a_homography_gives_the_same_points(surface):
    found = as_homography(surface, SIZE)
    expected = surface.for_image_size(SIZE).locate(PIXELS)
    assert found.locate(PIXELS) == pytest.approx(expected, abs=1e-5)
    assert is_same_surface(found, surface, SIZE)


def test_camera_that_sees_the_horizon_has_a_homography():
    surface = HomographySurface(np.array([[0.06, 0, 0], [0, 0.06, 0], [0, 3e-3, -0.4]]), SIZE)
    found = as_homography(surface, SIZE)
    assert found.locate([[320, 470]]) == pytest.approx(surface.locate([[320, 470]]), abs=1e-5)


def test_polynomial_is_no_homography():
    assert as_homography(PolynomialSurface(), SIZE) is None


def test_surface_that_is_nudged_by_a_tenth_of_a_pixel_is_another_one():
    shift = PictureMap(np.array([[1, 0, 0.1], [0, 1, 0], [0, 0, 1]]), LENS)
    assert not is_same_surface(NudgedSurface(TILTED, shift, SIZE), TILTED, SIZE)
