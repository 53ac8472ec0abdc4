# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.errors import HorizonError, InvalidValueError
from camera_to_base.parameters.spec import checked_values
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.specs import SIMULATION_SPECS
import numpy as np
import pytest

TILTS = [0, 15, 30, 60]
COIN_DIAMETER_CM = 2.4


def frames(count, **parameters):
    board = SimulatedBoard(**parameters)
    return [board.read() for _ in range(count)]


def project(matrix, point):
    x, y, w = matrix @ [*point, 1.0]
    return np.array([x / w, y / w])


def darkness(frame, empty):
    difference = empty.astype(float).sum(axis=2) - frame.astype(float).sum(axis=2)
    return difference / difference.max()


def centroid(weights):
    v, u = np.indices(weights.shape)
    return np.array([(u * weights).sum(), (v * weights).sum()]) / weights.sum()


def true_yaws_deg(**conditions):
    board = SimulatedBoard(**conditions)
    board.read()
    board.read()
    return [None if true.yaw is None else math.degrees(true.yaw) for true in board.true_objects]


def seen_spread(board, coverage):
    """Give the area (cm²), the centroid and the second moments of what a picture shows."""
    v, u = np.nonzero(coverage > 0.02)
    scaled = np.column_stack([u, v, np.ones(len(u))]) @ board.surface_from_pixel.T
    # How much surface a pixel sees goes with the cube of its nearness.
    weights = coverage[v, u] * abs(np.linalg.det(board.surface_from_pixel)) / scaled[:, 2]**3
    points = scaled[:, :2] / scaled[:, 2:]
    return (weights.sum(), np.average(points, axis=0, weights=weights),
            np.cov(points.T, aweights=weights, bias=True))


def test_first_frame_shows_the_empty_board():
    board = SimulatedBoard(noise=0)
    first = board.read()
    assert board.true_point is None
    assert first.max() - first.min() < 40
    np.testing.assert_array_equal(first, SimulatedBoard(noise=0, seed=1).read())


def test_every_later_frame_shows_the_coin_where_the_truth_says():
    board = SimulatedBoard(noise=0, frame_rate=1.0)
    empty = board.read()
    for _ in range(20):
        coverage = darkness(board.read(), empty)
        point = project(board.surface_from_pixel, centroid(coverage))
        assert point == pytest.approx(board.true_point, abs=0.005)


def test_tilted_camera_shows_the_coin_where_the_truth_says():
    # The centroid of an ellipse is not its circle's centre: a camera farther away would agree.
    board = SimulatedBoard(noise=0, frame_rate=1.0, tilt_deg=30)
    empty = board.read()
    for _ in range(20):
        coverage = darkness(board.read(), empty)
        point = project(board.surface_from_pixel, centroid(coverage))
        assert point == pytest.approx(board.true_point, abs=0.03)


@pytest.mark.parametrize('tilt_deg', [0, 30, 50])
@pytest.mark.parametrize('yaw_deg', [0.0, 35.0, 90.0, -60.0])
def test_oval_is_shown_where_and_as_the_truth_says(tilt_deg, yaw_deg):
    board = SimulatedBoard(noise=0, tilt_deg=tilt_deg, yaw_deg=yaw_deg, frame_rate=0.7,
                           diameters_cm=(4.0,), elongation=2.5)
    empty = board.read()
    for _ in range(10):
        coverage = darkness(board.read(), empty)
        area, centroid_, spread = seen_spread(board, coverage)
        true, = board.true_objects
        direction = np.array([math.cos(true.yaw), math.sin(true.yaw)])
        across = np.array([-direction[1], direction[0]])
        assert area == pytest.approx(math.pi / 4 * 4.0 * 1.6, rel=0.02)
        assert centroid_ == pytest.approx(true.point, abs=0.01)
        assert centroid(coverage) == pytest.approx(true.pixel, abs=0.1)
        assert 4 * math.sqrt(direction @ spread @ direction) == pytest.approx(4.0, rel=0.02)
        # Between two axes of 4 and 1.6 cm this is less than 0.2 degrees.
        assert abs(direction @ spread @ across) < 0.003
        assert true.cut_off < 0


def test_each_further_oval_is_turned_by_fifty_degrees():
    assert true_yaws_deg(elongation=2.0, yaw_deg=-20.0, diameters_cm=(3.0,) * 4) == [
        pytest.approx(yaw) for yaw in (-20.0, 30.0, 80.0, -50.0)]


@pytest.mark.parametrize('yaw_deg, true_yaw_deg', [(90, 90), (-90, 90), (180, 0), (-120, 60)])
def test_true_yaw_lies_between_a_quarter_turn_to_both_sides(yaw_deg, true_yaw_deg):
    assert true_yaws_deg(elongation=2.0, yaw_deg=yaw_deg) == [pytest.approx(true_yaw_deg)]


def test_coin_has_no_true_yaw_and_does_not_turn():
    assert true_yaws_deg(diameters_cm=(2.4, 2.0)) == [None, None]
    for frame, turned in zip(frames(3), frames(3, yaw_deg=30.0)):
        np.testing.assert_array_equal(frame, turned)


def test_true_point_is_that_of_the_largest_oval_whichever_way_they_lie():
    board = SimulatedBoard(elongation=3.0, diameters_cm=(3.0, 2.6), yaw_deg=0.0)
    board.read()
    board.read()
    assert board.true_point == board.object_point(1, 0)


@pytest.mark.parametrize('width_cm', [36.0, 72.0])
def test_coin_is_as_large_as_the_scale_says(width_cm):
    empty, frame = frames(2, noise=0, width_cm=width_cm)
    area_cm2 = darkness(frame, empty).sum() * (width_cm / 640)**2
    assert area_cm2 == pytest.approx(math.pi / 4 * COIN_DIAMETER_CM**2, rel=0.01)


def test_frames_are_colour_pictures_of_the_size_that_was_asked_for():
    for frame in frames(3, image_size=(320, 200)):
        assert frame.shape == (200, 320, 3) and frame.dtype == np.uint8


@pytest.mark.parametrize('image_size', [(1, 1), (2, 3), (7, 5), (640, 1)])
def test_small_pictures_are_rendered_too(image_size):
    for frame in frames(5, image_size=image_size, tilt_deg=30):
        assert frame.shape == (image_size[1], image_size[0], 3)


def test_same_seed_gives_the_same_frames():
    for frame, again in zip(frames(3, seed=7), frames(3, seed=7)):
        np.testing.assert_array_equal(frame, again)


def test_another_seed_gives_other_noise():
    first, other = frames(1, seed=7)[0], frames(1, seed=8)[0]
    assert (first != other).mean() > 0.5


def test_noise_differs_from_frame_to_frame():
    _, second, third = frames(3, seed=7)
    assert (second[:20] != third[:20]).mean() > 0.5


@pytest.mark.parametrize('noise', [1.0, 2.0, 5.0])
def test_noise_is_as_strong_as_it_was_asked_for(noise):
    empty, noisy = frames(1, noise=0)[0], frames(1, noise=noise)[0]
    difference = noisy.astype(float) - empty
    # Rounding to whole grey levels adds 1/12 to the variance.
    assert difference.std() == pytest.approx(math.sqrt(noise**2 + 1 / 12), rel=0.02)
    assert difference.mean() == pytest.approx(0.0, abs=0.05)


def test_overhead_camera_is_one_factor_from_px_to_cm():
    np.testing.assert_allclose(
        SimulatedBoard(tilt_deg=0).surface_from_pixel, np.diag([0.05625, 0.05625, 1.0]),
        rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize('tilt_deg', TILTS)
def test_pictures_centre_looks_at_the_same_point_at_any_tilt(tilt_deg):
    matrix = SimulatedBoard(tilt_deg=tilt_deg).surface_from_pixel
    assert project(matrix, (320, 240)) == pytest.approx([18.0, 13.5])


@pytest.mark.parametrize('tilt_deg', TILTS)
def test_the_two_matrices_undo_each_other(tilt_deg):
    board = SimulatedBoard(tilt_deg=tilt_deg)
    for pixel in ((0, 0), (639, 0), (100, 400), (639, 479)):
        point = project(board.surface_from_pixel, pixel)
        assert project(board.pixel_from_surface, point) == pytest.approx(pixel, abs=1e-9)


def test_tilt_turns_the_camera_by_its_angle():
    # Half the picture's height is seen at atan(13.5 / 60) from its centre, 60 cm away.
    half_view = math.atan2(13.5, 60.0)
    tilt = math.radians(30)
    seen_at = math.sin(half_view) / math.cos(tilt + half_view) * 60.0
    top = project(SimulatedBoard(tilt_deg=30).surface_from_pixel, (320, 0))
    assert top == pytest.approx([18.0, 13.5 - seen_at])


def test_top_of_a_tilted_picture_sees_more_than_its_bottom():
    matrix = SimulatedBoard(tilt_deg=30).surface_from_pixel
    top, bottom = (project(matrix, (640, v))[0] - project(matrix, (0, v))[0] for v in (0, 480))
    assert top > 1.2 * bottom


def test_matrix_of_the_board_cannot_be_changed_from_outside():
    board = SimulatedBoard()
    board.pixel_from_surface[:] = 0
    assert board.pixel_from_surface.any()


@pytest.mark.parametrize('tilt_deg', [0, 30])
def test_whole_coin_is_seen_all_the_way(tilt_deg):
    board = SimulatedBoard(tilt_deg=tilt_deg, frame_rate=10.0)
    for number in range(1, 601):
        x, y = board.object_point(number)
        for angle in np.linspace(0, 2 * math.pi, 8, endpoint=False):
            edge = x + 1.2 * math.cos(angle), y + 1.2 * math.sin(angle)
            u, v = project(board.pixel_from_surface, edge)
            assert 0 < u < 639 and 0 < v < 479


def test_coins_path_closes_after_a_minute():
    board = SimulatedBoard(frame_rate=10.0)
    for number in (1, 77, 300):
        assert board.object_point(number + 600) == pytest.approx(board.object_point(number))


def test_coins_path_covers_the_middle_half_of_the_board():
    board = SimulatedBoard()
    x, y = np.array([board.object_point(number) for number in range(1, 601)]).T
    assert x.min() < 9.0 and x.max() > 27.0 and y.min() < 6.76 and y.max() > 20.24


def test_frame_rate_is_that_of_the_coins_time():
    slow, fast = SimulatedBoard(frame_rate=5.0), SimulatedBoard(frame_rate=50.0)
    assert fast.object_point(70) == pytest.approx(slow.object_point(7))
    assert (slow.frame_rate, fast.frame_rate) == (5.0, 50.0)


def test_true_point_is_that_of_the_last_frame():
    board = SimulatedBoard()
    assert board.true_point is None
    board.read()
    assert board.true_point is None
    for number in range(1, 4):
        board.read()
        assert board.true_point == board.object_point(number)


def test_board_can_be_released_as_any_source():
    board = SimulatedBoard()
    board.release()
    assert board.read().shape == (480, 640, 3)


@pytest.mark.parametrize('name, value', [
    ('tilt_deg', -1.0), ('tilt_deg', 61.0), ('tilt_deg', float('nan')),
    ('noise', -0.1), ('noise', float('inf')), ('diameters_cm', [2.4, 0.0]),
    ('frame_rate', 0.0), ('frame_rate', -10.0),
    ('seed', -1),
    ('elongation', 0.9), ('elongation', 11.0), ('yaw_deg', 181.0),
])
def test_error_names_the_bad_parameter(name, value):
    with pytest.raises(InvalidValueError, match=name):
        checked_values(SIMULATION_SPECS, {f'simulated.{name}': value})


@pytest.mark.parametrize('name, value', [
    ('tilt_deg', 61.0), ('width_cm', 0.0), ('width_cm', float('nan')),
    ('image_size', (0, 480)), ('image_size', (640,)),
])
def test_error_names_the_bad_value(name, value):
    with pytest.raises(InvalidValueError, match=name):
        SimulatedBoard(**{name: value})


def test_picture_that_would_reach_the_horizon_is_refused():
    with pytest.raises(HorizonError):
        SimulatedBoard(image_size=(1, 480), tilt_deg=30)
