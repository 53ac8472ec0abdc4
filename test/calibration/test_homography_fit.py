# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The homography fit, against closed-form truth."""

from camera_to_base.calibration.figures import left_out_errors, surface_errors
from camera_to_base.calibration.homography_fit import (
    fit_homography, moved as moved_points, plane_motion)
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface.distortion import RadialDistortion
from camera_to_base.surface.models import HomographySurface
from camera_to_base.surface.points import MatchedPoints
import cv2
import numpy as np
import pytest
from rendered_board import CENTRE, IMAGE_SIZE, pixel_from_surface, project

GRID = np.array([[x, y] for y in np.linspace(0, 12.5, 6) for x in np.linspace(0, 20, 9)])
THREE_COLUMNS = GRID[np.isin(np.arange(54) % 9, [0, 4, 8])]
# Of a sum of squares near its minimum: the root of a float's last digit.
ROUNDING = 1e-7
ELSEWHERE = np.array([[3.3, 2.2], [11.1, 7.7], [19.0, 12.0]])


def matched(points, homography, coefficient=0.0, centre=CENTRE, noise=0.0, seed=0):
    pixels = project(homography, points, coefficient, centre)
    noise_px = np.random.default_rng(seed).normal(0, noise, pixels.shape)
    return MatchedPoints(points, pixels + noise_px)


@pytest.mark.parametrize('tilt', [0, 20, 60])
def test_four_exact_points_recover_the_homography(tilt):
    homography = pixel_from_surface(tilt)
    fit = fit_homography(matched(GRID[[0, 8, 45, 53]], homography), IMAGE_SIZE)
    located = fit.surface.locate(project(homography, ELSEWHERE))
    np.testing.assert_allclose(located, ELSEWHERE, atol=1e-9)


@pytest.mark.parametrize('tilt', [0, 20, 60])
@pytest.mark.parametrize('coefficient', [-0.4, -0.2, -0.02, 0.0, 0.1])
def test_exact_points_recover_the_homography_and_the_coefficient(tilt, coefficient):
    homography = pixel_from_surface(tilt)
    fit = fit_homography(matched(THREE_COLUMNS, homography, coefficient), IMAGE_SIZE)
    assert fit.surface.distortion.coefficient == pytest.approx(coefficient, abs=1e-9)
    located = fit.surface.locate(project(homography, ELSEWHERE, coefficient))
    np.testing.assert_allclose(located, ELSEWHERE, atol=1e-9)


def test_exact_points_recover_a_distortion_centre_off_the_middle():
    homography, centre = pixel_from_surface(30), (331.0, 228.0)
    fit = fit_homography(matched(GRID, homography, -0.2, centre), IMAGE_SIZE)
    np.testing.assert_allclose(fit.surface.distortion.centre, centre, atol=1e-6)
    located = fit.surface.locate(project(homography, ELSEWHERE, -0.2, centre))
    np.testing.assert_allclose(located, ELSEWHERE, atol=1e-9)


def test_the_order_of_the_points_does_not_matter():
    given = matched(THREE_COLUMNS, pixel_from_surface(), -0.2, noise=0.3)
    shuffled = given.take(np.random.default_rng(1).permutation(len(given)))
    one, other = fit_homography(given, IMAGE_SIZE), fit_homography(shuffled, IMAGE_SIZE)
    np.testing.assert_allclose(one.surface.locate(given.pixels),
                               other.surface.locate(given.pixels), atol=ROUNDING)


@pytest.mark.parametrize('scale', [1e-3, 1e4])
def test_the_unit_of_the_surface_does_not_matter(scale):
    given = matched(THREE_COLUMNS, pixel_from_surface(), -0.2, noise=0.3)
    scaled = MatchedPoints(scale * given.points, given.pixels)
    one, other = fit_homography(given, IMAGE_SIZE), fit_homography(scaled, IMAGE_SIZE)
    np.testing.assert_allclose(other.surface.locate(given.pixels) / scale,
                               one.surface.locate(given.pixels), atol=ROUNDING)


def test_the_size_of_the_picture_does_not_matter():
    given = matched(THREE_COLUMNS, pixel_from_surface(), -0.2, noise=0.3)
    # Pixel centres lie at whole numbers, so twice the size is 2 u + 0.5.
    larger = MatchedPoints(given.points, 2 * given.pixels + 0.5)
    one, other = fit_homography(given, IMAGE_SIZE), fit_homography(larger, (1280, 960))
    assert other.surface.distortion.coefficient == pytest.approx(
        one.surface.distortion.coefficient, abs=ROUNDING)
    np.testing.assert_allclose(other.surface.locate(larger.pixels),
                               one.surface.locate(given.pixels), atol=ROUNDING)


def test_the_origin_of_the_surface_does_not_matter():
    given = matched(THREE_COLUMNS, pixel_from_surface(), -0.2, noise=0.3)
    moved = MatchedPoints(given.points + [500.0, -900.0], given.pixels)
    one, other = fit_homography(given, IMAGE_SIZE), fit_homography(moved, IMAGE_SIZE)
    np.testing.assert_allclose(other.surface.locate(given.pixels) - [500.0, -900.0],
                               one.surface.locate(given.pixels), atol=ROUNDING)


def test_no_coefficient_is_fitted_to_fewer_than_eight_points():
    fit = fit_homography(matched(GRID[[0, 4, 8, 20, 45, 49, 53]], pixel_from_surface(), -0.2),
                         IMAGE_SIZE)
    assert fit.surface.distortion.coefficient == 0


@pytest.mark.slow
def test_the_coefficient_is_hardly_worse_where_the_lens_has_none():
    homography, plain, chosen = pixel_from_surface(20), [], []
    for seed in range(30):
        given = matched(THREE_COLUMNS, homography, noise=0.5, seed=seed)
        without_lens = np.linalg.inv(cv2.findHomography(given.points, given.pixels)[0])
        for surface, errors in ((fit_homography(given, IMAGE_SIZE).surface, chosen),
                                (HomographySurface(without_lens), plain)):
            errors.append(np.linalg.norm(surface.locate(project(homography, GRID)) - GRID, axis=1))
    assert np.mean(chosen) < 1.15 * np.mean(plain)


@pytest.mark.slow
def test_clicked_points_are_located_to_a_quarter_of_a_millimetre():
    homography = pixel_from_surface(20, away_cm=40, middle=(15, 9.4))
    board, errors = 1.5 * GRID, []
    for seed in range(20):
        given = matched(1.5 * THREE_COLUMNS, homography, -0.1, noise=0.5, seed=seed)
        surface = fit_homography(given, IMAGE_SIZE).surface
        located = surface.locate(project(homography, board, -0.1))
        errors.append(np.linalg.norm(located - board, axis=1))
    assert 10 * np.mean(errors) < 0.25


def test_leaving_a_point_out_equals_fitting_without_it():
    given = matched(THREE_COLUMNS[:7], pixel_from_surface(), noise=0.5)
    fit = fit_homography(given, IMAGE_SIZE)
    others = fit_homography(given.take([0, 1, 2, 4, 5, 6]), IMAGE_SIZE)
    error = np.linalg.norm(others.surface.locate(given.pixels[3:4]) - given.points[3])
    assert left_out_errors(fit.without, given)[3] == pytest.approx(error, rel=1e-6)


def test_four_points_have_no_leave_one_out_error():
    given = matched(GRID[[0, 8, 45, 53]], pixel_from_surface())
    fit = fit_homography(given, IMAGE_SIZE)
    assert left_out_errors(fit.without, given) is None
    assert surface_errors(fit.surface, given).max() < 1e-9


@pytest.mark.parametrize('points, message', [
    (GRID[[0, 8, 53]], '3 points are too few'),
    (GRID[:9], 'all 9 points lie on one line of the surface'),
    (GRID[[0, 1, 2, 3, 30]], 'all points but row 5 lie on one line'),
    (GRID[[0, 1, 2, 3, 4, 30, 48]][:6], 'all points but row 6 lie on one line'),
])
def test_points_that_leave_the_surface_open_are_refused(points, message):
    with pytest.raises(CalibrationError, match=message):
        fit_homography(matched(points, pixel_from_surface()), IMAGE_SIZE)


def test_swapped_rows_that_no_camera_can_see_are_refused():
    given = matched(GRID[[0, 8, 53, 45]], pixel_from_surface())
    swapped = MatchedPoints(given.points, given.pixels[[0, 2, 1, 3]])
    with pytest.raises(CalibrationError, match='are rows swapped'):
        fit_homography(swapped, IMAGE_SIZE)


def test_a_pixel_outside_of_the_picture_is_refused_by_its_row():
    given = matched(GRID, pixel_from_surface())
    with pytest.raises(InvalidValueError, match=r'row \d+: .* outside a picture of 320 x 240'):
        fit_homography(given, (320, 240))


def test_duplicate_points_are_refused_by_their_rows():
    with pytest.raises(InvalidValueError, match=r'rows 1 and 3 have the same position \(x, y\)'):
        MatchedPoints([[0, 0], [1, 0], [0, 0]], [[0, 0], [1, 0], [2, 0]])
    with pytest.raises(InvalidValueError, match=r'rows 7 and 8 have the same pixel'):
        MatchedPoints([[0, 0], [1, 0]], [[5, 5], [5, 5]], (7, 8))


@pytest.mark.slow
def test_four_placements_are_as_good_all_over_the_picture_as_at_the_board():
    # A third of the picture's width each, 0.2 px noise; the goal is a ratio of 2.
    camera, ratios = pixel_from_surface(25, 0, away_cm=75.0), []
    u, v = np.meshgrid(np.linspace(0, 639, 13), np.linspace(0, 479, 10))
    everywhere = np.stack([u.ravel(), v.ravel()], axis=1)
    board = GRID - GRID.mean(axis=0)
    for seed in range(5):
        random, placements, true = np.random.default_rng(seed), [], []
        for x, y in ((-8, -6), (28, -6), (-3, 17), (23, 17)):
            turn = random.uniform(-0.2, 0.2)
            moved = board @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]] + [x, y]
            pixels = project(camera, moved, -0.2) + random.normal(0, 0.2, moved.shape)
            inside = ((pixels > 0) & (pixels < [639, 479])).all(axis=1)
            placements.append(MatchedPoints(board[inside], pixels[inside]))
            true.append(moved[inside])
        fit = fit_homography(placements[0], IMAGE_SIZE, placements[1:])
        truth = HomographySurface(np.linalg.inv(camera), IMAGE_SIZE, RadialDistortion.of_picture(
            IMAGE_SIZE, -0.2, CENTRE))
        # The camera frame is the first placement's: the best motion from it to the table.
        to_table = plane_motion(fit.points, np.concatenate(true))
        found = moved_points(fit.surface.locate(everywhere), to_table)
        errors = np.linalg.norm(found - truth.locate(everywhere), axis=1)
        at_board = np.linalg.norm(fit.surface.locate(np.concatenate(
            [placement.pixels for placement in placements])) - fit.points, axis=1)
        ratios.append(np.sqrt(np.mean(errors ** 2) / np.mean(at_board ** 2)))
    assert max(ratios) < 2, ratios
