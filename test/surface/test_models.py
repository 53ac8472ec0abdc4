# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import re

from camera_to_base.errors import FrameSizeError, HorizonError, InvalidValueError
from camera_to_base.parameters.spec import checked_values
from camera_to_base.surface.distortion import RadialDistortion
from camera_to_base.surface.models import (
    HomographySurface, ParallelSurface, PolynomialSurface, SURFACE_DEFAULTS, SURFACE_SPECS)
from camera_to_base.surface.parameters import make_hull, make_surface
import cv2
import numpy as np
import pytest

# A camera that looks along a road: x = (u - 320) / (v - 112), y = 128 / (v - 112). Its horizon
# is the row 112, and all numbers are exact in binary.
ROAD = np.array([[1.0, 0.0, -320.0], [0.0, 0.0, 128.0], [0.0, 1.0, -112.0]])
# Half a turn of a picture of 640 x 480 px.
HALF_TURN = np.array([[-1.0, 0.0, 640.0], [0.0, -1.0, 480.0], [0.0, 0.0, 1.0]])
PIXELS = np.array([[390.0, 275.0], [417.0, 265.0], [10.5, 300.25], [639.0, 479.0]])
MODELS = [ParallelSurface(), PolynomialSurface(), HomographySurface(ROAD)]

all_models = pytest.mark.parametrize(
    'surface', MODELS, ids=[type(model).__name__ for model in MODELS])


def test_parallel_surface_gives_the_tutorials_position():
    np.testing.assert_allclose(
        ParallelSurface(32.0).locate([[390, 275]]), [[19.5, 13.75]], rtol=1e-12)


def test_parallel_surface_is_36_cm_across_640_px_by_default():
    np.testing.assert_allclose(
        ParallelSurface().locate([[640, 480], [0, 0]]), [[36.0, 27.0], [0.0, 0.0]], rtol=1e-12)


def test_parallel_surface_shows_a_point_where_it_locates_it():
    np.testing.assert_allclose(ParallelSurface(32.0).pixels([[19.5, 13.75]]), [[390, 275]])


def test_parallel_surface_has_pixels_outside_the_picture_too():
    np.testing.assert_allclose(ParallelSurface(64.0).locate([[-10, 1000]]), [[-1.0, 100.0]])


def test_polynomial_surface_gives_the_tutorials_y():
    by_hand = 0.00006 * 285**2 - 0.0833 * 285 + 25.848
    y = PolynomialSurface().locate([[292, 285]])[0, 1]
    assert y == pytest.approx(by_hand, abs=1e-9)
    assert y == pytest.approx(6.981, abs=0.01)


def test_polynomial_surface_gives_the_tutorials_position():
    assert PolynomialSurface().locate([[417, 265]])[0] == pytest.approx([6.26, 7.99], abs=0.01)


def test_polynomial_surface_has_x_zero_on_its_centre_line():
    pixels = [[292, v] for v in range(0, 480, 40)]
    assert not PolynomialSurface().locate(pixels)[:, 0].any()


def test_homography_of_a_parallel_camera_is_the_parallel_surface():
    surface = HomographySurface(np.diag([0.05625, 0.05625, 1.0]))
    np.testing.assert_allclose(
        surface.locate(PIXELS), ParallelSurface(36.0).locate(PIXELS), rtol=1e-12)


def test_homography_gives_back_the_points_that_it_was_made_of():
    pixels = np.array([[100, 60], [540, 80], [620, 470], [15, 440]], np.float32)
    points = np.array([[0, 0], [30, 0], [30, 20], [0, 20]], np.float32)
    surface = HomographySurface(cv2.getPerspectiveTransform(pixels, points))
    np.testing.assert_allclose(surface.locate(pixels), points, rtol=0, atol=1e-6)


def test_homography_is_accepted_as_a_list_of_rows():
    np.testing.assert_array_equal(
        HomographySurface(ROAD.tolist()).locate(PIXELS), HomographySurface(ROAD).locate(PIXELS))


def distorted_radius(undistorted, coefficient):
    """Solve r / (1 + coefficient r^2) = undistorted by halving."""
    low, high = 0.0, 1.0
    for _ in range(100):
        middle = (low + high) / 2
        low, high = ((middle, high) if middle / (1 + coefficient * middle**2) < undistorted
                     else (low, middle))
    return low


@pytest.mark.parametrize('coefficient', [-0.4, -0.1, 0.1])
def test_distortion_is_that_of_the_division_model(coefficient):
    # A quarter of the diagonal (800 px) to the right of the centre.
    lens = RadialDistortion.of_picture((640, 480), coefficient, (300, 200))
    radius = 400 * distorted_radius(0.5, coefficient)
    np.testing.assert_allclose(lens.undistort(np.array([[300 + radius, 200]])), [[500, 200]])
    np.testing.assert_allclose(lens.distort(np.array([[500, 200]])), [[300 + radius, 200]])


def test_without_a_coefficient_nothing_is_distorted():
    lens = RadialDistortion.of_picture((640, 480))
    np.testing.assert_allclose(lens.undistort(PIXELS), PIXELS, rtol=1e-15)


@pytest.mark.parametrize('surface', [
    HomographySurface(ROAD), PolynomialSurface(), PolynomialSurface(y_of_v=(0, -0.08, 25)),
    HomographySurface(ROAD, (640, 480), RadialDistortion.of_picture((640, 480), -0.3)),
    HomographySurface(ROAD, (640, 480), RadialDistortion.of_picture((640, 480), 0.2, (300, 230))),
])
def test_pixels_and_points_go_round_trip(surface):
    np.testing.assert_allclose(surface.pixels(surface.locate(PIXELS)), PIXELS, rtol=1e-9)


def test_point_that_the_camera_cannot_see_has_no_pixel():
    behind_the_camera, far_away = [0, -10], [0, 1000]
    assert np.isnan(HomographySurface(ROAD).pixels([behind_the_camera, far_away])).all()
    assert np.isnan(PolynomialSurface().pixels([[0, -10]])).all()


def test_pixel_farther_out_than_the_distortion_model_reaches_is_refused():
    surface = HomographySurface(ROAD, (640, 480), RadialDistortion.of_picture((640, 480), -1.5))
    assert surface.locate([[320, 240]]).shape == (1, 2)
    with pytest.raises(HorizonError, match=re.escape('(639, 479)')):
        surface.locate([[639, 479]])


@pytest.mark.parametrize('coefficient, centre', [
    (float('nan'), (320, 240)), (3.0, (320, 240)), (-0.1, (320,)), (-0.1, (320, float('inf')))])
def test_distortion_that_no_lens_has_is_refused(coefficient, centre):
    with pytest.raises(InvalidValueError, match='distortion_c'):
        RadialDistortion.of_picture((640, 480), coefficient, centre)


@all_models
def test_pixels_together_are_located_as_each_alone(surface):
    together = surface.locate(PIXELS)
    assert together.shape == (4, 2)
    np.testing.assert_allclose(
        together, np.vstack([surface.locate(pixel[None]) for pixel in PIXELS]), rtol=1e-12)


@all_models
def test_no_pixels_give_no_points(surface):
    assert surface.locate(np.empty((0, 2))).shape == (0, 2)


@all_models
def test_pixels_are_left_as_they_are(surface):
    pixels = PIXELS.copy()
    surface.locate(pixels)
    np.testing.assert_array_equal(pixels, PIXELS)


@all_models
@pytest.mark.parametrize('shape', [(), (2,), (0,), (1, 3), (2, 1), (1, 2, 1)])
def test_pixels_of_another_shape_are_refused(surface, shape):
    with pytest.raises(InvalidValueError, match=re.escape(f'got shape {shape}')):
        surface.locate(np.full(shape, 300.0))


@all_models
@pytest.mark.parametrize('place', [(0, 0), (2, 1)])
@pytest.mark.parametrize('value', [float('nan'), float('inf'), -float('inf')])
def test_pixel_that_is_not_finite_is_refused(surface, place, value):
    pixels = PIXELS.copy()
    pixels[place] = value
    with pytest.raises(InvalidValueError, match='finite'):
        surface.locate(pixels)


def test_pixel_just_below_the_horizon_is_far_away():
    np.testing.assert_allclose(
        HomographySurface(ROAD).locate([[420, 114], [320, 113.5]]), [[50, 64], [0, 256 / 3]])


@pytest.mark.parametrize('v', [113.25, 113, 112, 111.999, 111, 0, -1000])
def test_pixel_near_the_horizon_on_it_or_above_it_is_refused(v):
    with pytest.raises(HorizonError, match=re.escape(f'(420, {v:g})')):
        HomographySurface(ROAD).locate([[420, v]])


def test_one_pixel_beyond_the_horizon_refuses_them_all():
    with pytest.raises(HorizonError, match=re.escape('(5, 60)')):
        HomographySurface(ROAD).locate([[320, 240], [5, 60], [320, 400]])


def test_upside_down_camera_sees_the_surface_above_the_horizon():
    upside_down = HomographySurface(ROAD @ HALF_TURN)
    np.testing.assert_allclose(upside_down.locate([[220, 366]]), [[50, 64]])
    for v in (367, 368, 368.001, 479):
        with pytest.raises(HorizonError):
            upside_down.locate([[320, v]])


def test_horizon_may_stand_upright():
    # The road camera turned by a quarter: its u is our v.
    on_its_side = HomographySurface(ROAD[:, [1, 0, 2]])
    np.testing.assert_allclose(on_its_side.locate([[116, 420]]), [[25, 32]])
    with pytest.raises(HorizonError):
        on_its_side.locate([[112, 240]])


@pytest.mark.parametrize('scale', [-1.0, -0.001, 1e6, 1e-9])
def test_scale_of_the_matrix_makes_no_difference(scale):
    scaled = HomographySurface(scale * ROAD)
    np.testing.assert_allclose(
        scaled.locate(PIXELS), HomographySurface(ROAD).locate(PIXELS), rtol=1e-12)
    with pytest.raises(HorizonError):
        scaled.locate([[320, 100]])


def test_polynomial_surface_ends_where_its_px_per_cm_is_not_positive():
    surface = PolynomialSurface(
        y_of_v=(0, 1, 0), px_per_cm_of_y=(0, -1, 10), centre_u=300)
    np.testing.assert_allclose(surface.locate([[302, 9]]), [[2, 9]])
    for v in (10, 11, 400):
        with pytest.raises(HorizonError, match=re.escape(f'(302, {v})')):
            surface.locate([[302, 9], [302, v]])


@pytest.mark.parametrize('v', [1e200, -1e200])
def test_pixel_beyond_what_a_float_holds_is_refused(v):
    with pytest.raises((HorizonError, InvalidValueError)):
        PolynomialSurface().locate([[0, v]])


@pytest.mark.parametrize('width_cm', [0, -36.0, float('nan'), float('inf')])
def test_width_in_cm_must_be_positive_and_finite(width_cm):
    with pytest.raises(InvalidValueError, match='width_cm'):
        checked_values(SURFACE_SPECS, {'surface.parallel.width_cm': width_cm})


@pytest.mark.parametrize('image_size', [
    [0, 480], [640, -1], [640], [640, 480, 3], [640, 10001], [640.5, 480.0]])
def test_picture_size_must_be_two_positive_whole_numbers(image_size):
    with pytest.raises(InvalidValueError, match='surface.image_size must be'):
        checked_values(SURFACE_SPECS, {'surface.image_size': image_size})


def test_same_parameters_make_the_same_surface_and_hull():
    values = {**SURFACE_DEFAULTS, 'surface.model': 'polynomial',
              'surface.hull': [0, 0, 9, 0, 9, 9]}
    again = {name: list(value) if isinstance(value, list) else value
             for name, value in values.items()}
    assert make_surface(values) is make_surface(again)
    assert make_hull(values) is make_hull(again)
    other = {**values, 'surface.polynomial.centre_u': 293.0}
    assert make_surface(other) is not make_surface(values)
    assert make_hull(other) is make_hull(values)


@pytest.mark.parametrize('name, value', [
    ('y_of_v', [1, 2]),
    ('y_of_v', [1, 2, 3, 4]),
    ('y_of_v', [1, 2, float('nan')]),
    ('px_per_cm_of_y', []),
    ('px_per_cm_of_y', [float('inf'), 0, 0]),
    ('centre_u', float('nan')),
    ('image_size', (640,)),
])
def test_error_names_the_polynomials_bad_value(name, value):
    with pytest.raises(InvalidValueError, match=name):
        PolynomialSurface(**{name: value})


@pytest.mark.parametrize('matrix', [
    np.zeros((3, 3)),
    np.eye(4),
    ROAD.ravel()[:8],
    [*ROAD.ravel(), 1],
    np.diag([1, 1, float('nan')]),
    np.array([[1, 2, 3], [2, 4, 6], [0, 0, 1]]),
    np.array([[1, 0, 0], [0, 1, 0], [0, 0, 0]]),
], ids=['zeros', '4 x 4', '8 numbers', '10 numbers', 'nan', 'equal rows', 'no depth'])
def test_matrix_that_is_no_homography_is_refused(matrix):
    with pytest.raises(InvalidValueError, match='surface_from_pixel'):
        HomographySurface(matrix)


def test_homography_with_the_pictures_centre_on_its_horizon_is_refused():
    matrix = ROAD.copy()
    matrix[2] = 0, 1, -240
    with pytest.raises(InvalidValueError, match='centre'):
        HomographySurface(matrix)


def test_matrix_changed_after_construction_does_not_reach_the_surface():
    matrix = ROAD.copy()
    surface = HomographySurface(matrix)
    matrix[:] = 7.0
    np.testing.assert_array_equal(surface.locate(PIXELS), HomographySurface(ROAD).locate(PIXELS))


def test_parallel_surface_keeps_its_cm_when_the_picture_gets_more_pixels():
    larger = ParallelSurface(36.0, 640).for_image_size((1280, 960))
    np.testing.assert_allclose(
        larger.locate(2 * PIXELS), ParallelSurface(36.0, 640).locate(PIXELS), rtol=1e-12)


@pytest.mark.parametrize('make', [
    lambda size: PolynomialSurface(image_size=size),
    lambda size: HomographySurface(ROAD, image_size=size),
], ids=['PolynomialSurface', 'HomographySurface'])
def test_measured_surface_holds_for_its_own_picture_size_only(make):
    surface = make((800, 600))
    np.testing.assert_array_equal(
        surface.for_image_size((800, 600)).locate(PIXELS), surface.locate(PIXELS))
    for size in ((640, 480), (600, 800), (800, 480), (640, 600)):
        with pytest.raises(FrameSizeError, match=f'{size[0]} x {size[1]} px.*800 x 600 px'):
            surface.for_image_size(size)
