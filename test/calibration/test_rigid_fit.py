# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The transform from the camera frame to the base frame."""

import re

from camera_to_base.calibration.rigid_fit import align, fit_rigid, rotation_deg
from camera_to_base.coordinate_transform import rotation_matrix
from camera_to_base.errors import CalibrationError
from camera_to_base.surface.points import PointPairs
import numpy as np
import pytest

POINTS = np.array([[0.0, 0.0], [36.0, 0.0], [36.0, 27.0], [0.0, 27.0], [10.0, 20.0]])


def flat(points):
    return np.column_stack([points, np.zeros(len(points))])


def pairs(camera_points, base_points, rows=()):
    return PointPairs(flat(camera_points), flat(base_points), rows)


def test_the_tutorials_camera_comes_out_as_half_a_turn_about_x():
    base = POINTS * [1, -1] + [-17.8, 24.4]
    fit = fit_rigid(pairs(POINTS, base))
    np.testing.assert_allclose(fit.rotation_deg, (180, 0, 0), atol=1e-9)
    np.testing.assert_allclose(fit.displacement_cm, (-17.8, 24.4, 0), atol=1e-9)
    assert np.abs(fit.residuals).max() < 1e-9 and np.abs(fit.left_out_residuals).max() < 1e-9


def test_the_tutorials_camera_survives_a_rulers_errors():
    noise = np.random.default_rng(0).normal(0, 0.1, POINTS.shape)
    fit = fit_rigid(pairs(POINTS, POINTS * [1, -1] + [-17.8, 24.4] + noise))
    np.testing.assert_allclose(fit.rotation_deg, (180, 0, 0), atol=0.5)
    np.testing.assert_allclose(fit.displacement_cm, (-17.8, 24.4, 0), atol=0.2)


@pytest.mark.parametrize('angles', [(0, 0, 0), (0, 0, 35), (180, 0, 90), (180, 0, -120),
                                    (170, 5, 20), (10, -80, 30)])
def test_exact_pairs_recover_any_rotation(angles):
    truth = rotation_matrix(*angles)
    camera = flat(POINTS)
    fit = fit_rigid(PointPairs(camera, camera @ truth.T + [1, 2, 3]))
    np.testing.assert_allclose(rotation_matrix(*fit.rotation_deg), truth, atol=1e-9)
    np.testing.assert_allclose(fit.displacement_cm, [1, 2, 3], atol=1e-9)


def test_the_rotation_is_proper_even_for_mirrored_bodies():
    body = np.random.default_rng(0).normal(size=(8, 3))
    rotation, _ = align(body, body * [1, 1, -1])
    assert np.linalg.det(rotation) == pytest.approx(1)


def test_angles_go_round_trip_where_pitch_is_a_right_angle(recwarn):
    truth = rotation_matrix(40, 90, 0)
    np.testing.assert_allclose(rotation_matrix(*rotation_deg(truth)), truth, atol=1e-9)
    assert rotation_deg(truth)[2] == 0 and not recwarn.list


def test_pairs_that_nothing_fits_are_refused_by_the_worst_row():
    base = POINTS[:4] * [1, -1] + [-17.8, 24.4]
    base[3] += [0, 8]
    with pytest.raises(CalibrationError, match=r'row \d is off by \d\d mm, allowed are 20 mm'):
        fit_rigid(pairs(POINTS[:4], base, (2, 3, 4, 5)))


SIX = np.array([[3.0, 4.0], [33.0, 5.0], [32.0, 24.0], [5.0, 23.0], [18.0, 6.0], [20.0, 15.0]])


@pytest.mark.parametrize('bad', range(6))
@pytest.mark.parametrize('error', [(0.8, 0), (0, -6.0), (100, 0)])
def test_bad_row_among_six_is_named_with_the_fit_without_it(bad, error):
    base = SIX * [1, -1] + [-17.8, 24.4] + np.random.default_rng(bad).normal(0, 0.05, SIX.shape)
    base[bad] += error
    with pytest.raises(CalibrationError) as caught:
        fit_rigid(pairs(SIX, base, (2, 3, 4, 5, 6, 7)))
    said = re.match(
        r'row (\d) does not belong to the others: it is off by ([\d.]+) mm .* which they meet to '
        r'([\d.]+) mm rms: measure it again or delete it. Without it: rotation \(([-\d.]+), '
        r'[-\d.]+, [-\d.]+\) degrees, displacement \(([-\d.]+), ([-\d.]+), [-\d.]+\) cm',
        str(caught.value))
    assert int(said[1]) == bad + 2
    assert float(said[2]) == pytest.approx(10 * np.linalg.norm(error), abs=3)
    assert float(said[3]) < 1.5
    assert abs(float(said[4])) == pytest.approx(180, abs=0.01)
    assert [float(said[5]), float(said[6])] == pytest.approx([-17.8, 24.4], abs=0.3)


def test_pairs_of_an_honest_ruler_are_hardly_ever_suspected():
    suspected, rng = 0, np.random.default_rng(0)
    for _ in range(200):
        count = int(rng.integers(5, 12))
        points = rng.uniform((0, 0), (36, 27), (count, 2))
        base = points * [1, -1] + [-17.8, 24.4] + rng.normal(0, 0.1, (count, 2))
        try:
            fit_rigid(pairs(points, base))
        except CalibrationError as error:
            assert 'does not belong' in str(error)
            suspected += 1
    assert suspected <= 6  # one of a hundred is expected


@pytest.mark.parametrize('scale', [0.1, 10, 1 / 2.54])
def test_frames_in_two_units_are_refused_with_their_ratio(scale):
    with pytest.raises(CalibrationError, match=f'lie {scale:.3g} times as far apart .* in cm'):
        fit_rigid(pairs(POINTS, scale * POINTS))


def test_three_pairs_have_no_leave_one_out_residuals():
    fit = fit_rigid(pairs(POINTS[:3], POINTS[:3]))
    assert fit.left_out_residuals is None


@pytest.mark.parametrize('points, message', [
    (POINTS[:2], '2 pairs are too few'),
    (np.array([[0, 0], [1, 1], [2, 2], [5, 5]]), 'all 4 pairs lie on one line'),
])
def test_pairs_that_leave_the_side_open_are_refused(points, message):
    with pytest.raises(CalibrationError, match=message):
        fit_rigid(pairs(points, points))


def test_order_of_the_pairs_and_their_unit_do_not_matter():
    noise = np.random.default_rng(1).normal(0, 0.1, POINTS.shape)
    base = POINTS * [1, -1] + [-17.8, 24.4] + noise
    fit = fit_rigid(pairs(POINTS, base))
    shuffled = fit_rigid(pairs(POINTS[[3, 1, 4, 0, 2]], base[[3, 1, 4, 0, 2]]))
    smaller = fit_rigid(pairs(POINTS / 100, base / 100))
    for other, scale in ((shuffled, 1), (smaller, 100)):
        np.testing.assert_allclose(other.rotation_deg, fit.rotation_deg, atol=1e-8)
        np.testing.assert_allclose(
            np.multiply(scale, other.displacement_cm), fit.displacement_cm, atol=1e-9)
