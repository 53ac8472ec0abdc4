# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Two cameras give an object's height, place and size; one camera needs to be told the height."""

from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.fusion import KnownHeight, solve, Viewpoint
import numpy as np
import pytest
from two_cameras import base_of, PAIRS, place, random_object, seen


@pytest.mark.parametrize('pair', PAIRS)
def test_height_and_place_of_exact_silhouettes_are_exact(pair):
    base = base_of('box', 5.0, 3.0, (4.0, -3.0), 0.4)
    found = solve([seen(base, 3.0, camera) for camera in PAIRS[pair]])
    assert found.height.height_cm == pytest.approx(3.0, abs=0.01)
    np.testing.assert_allclose(found.moments.centre, [4.0, -3.0], atol=0.01)
    assert found.extent == pytest.approx((5.0, 3.0, 0.4), abs=0.02)
    assert found.moments.yaw == pytest.approx(0.4, abs=0.02)
    assert found.agreement > 0.9


@pytest.mark.parametrize('pair, height_mm, place_mm', list(zip(
    PAIRS, [(0.4, 1.4), (0.4, 1.5), (0.4, 1.1), (0.6, 1.5)],
    [(0.16, 0.31), (0.18, 0.56), (0.17, 0.45), (0.13, 0.38)])))
def test_outlines_with_noise_give_heights_and_places_to_parts_of_a_mm(pair, height_mm, place_mm):
    random = np.random.default_rng(5)
    heights, places = [], []
    for _ in range(60):
        base, height, centre = random_object(random)
        found = solve([seen(base, height, camera, random) for camera in PAIRS[pair]])
        heights.append(10 * abs(found.height.height_cm - height))
        places.append(10 * np.hypot(*(found.moments.centre - centre)))
    assert np.mean(heights) <= height_mm[0] and max(heights) <= height_mm[1]
    assert np.mean(places) <= place_mm[0] and max(places) <= place_mm[1]


@pytest.mark.parametrize('pair', PAIRS)
def test_nine_of_ten_heights_and_places_lie_where_the_covariance_says(pair):
    random, error_cm = np.random.default_rng(7), 0.05
    in_height, in_place = [], []
    for _ in range(200):
        base, height, centre = random_object(random)
        found = solve([seen(base, height, camera, random, error_cm ** 2,
                            random.normal(0, error_cm, 2)) for camera in PAIRS[pair]])
        in_height.append(
            abs(found.height.height_cm - height) < 1.645 * found.height.deviation_cm)
        off = found.moments.centre - centre
        in_place.append(off @ np.linalg.solve(found.covariance, off) < 4.605)
    assert 0.84 <= np.mean(in_height) <= 0.99
    assert 0.84 <= np.mean(in_place) <= 0.99


def test_flat_object_is_not_below_the_surface():
    random, base = np.random.default_rng(1), base_of('disc', 3.0, 3.0, (2.0, 5.0), 0.0)
    for _ in range(20):
        found = solve([seen(base, 0.0, camera, random)
                       for camera in PAIRS['tilted 30 degrees, opposite sides']])
        assert -1e-3 <= found.height.height_cm < 0.15
        assert found.moments.yaw is None


def test_one_camera_takes_the_height_that_it_is_told_and_its_doubt():
    base, camera = base_of('hexagon', 4.0, 4.0, (-6.0, 8.0), 0.2), place(30, -90)
    outline = seen(base, 4.0, camera)
    sure, unsure = (solve([outline], KnownHeight(4.0, doubt)) for doubt in (0.05, 1.0))
    for found in (sure, unsure):
        assert found.height.height_cm == pytest.approx(4.0)
        np.testing.assert_allclose(found.moments.centre, [-6.0, 8.0], atol=0.02)
    assert unsure.height.deviation_cm == pytest.approx(1.0, rel=0.01)
    # A height of 1 cm more moves the centre along the line of sight by about 0.3 cm.
    assert 0.2 < np.sqrt(np.linalg.eigvalsh(unsure.covariance)[-1]) < 0.5
    assert np.sqrt(np.linalg.eigvalsh(sure.covariance)[-1]) < 0.03


def test_doubt_about_the_cameras_place_is_doubt_about_the_object():
    base = base_of('box', 4.0, 3.0, (0.0, 0.0), 0.0)
    views = [seen(base, 6.0, camera) for camera in (place(30, -90), place(30, 90))]
    doubtful = [one._replace(viewpoint=Viewpoint(one.viewpoint.place, np.diag([4.0, 4.0, 4.0])))
                for one in views]
    assert solve(doubtful).height.deviation_cm > 2 * solve(views).height.deviation_cm


def test_camera_that_is_off_by_half_a_cm_does_not_fit():
    base = base_of('box', 4.0, 3.0, (1.0, 2.0), 0.3)
    pair = PAIRS['tilted 30 degrees, opposite sides']
    # Across the line between the cameras, a height does not explain it.
    views = [seen(base, 3.0, pair[0]), seen(base, 3.0, pair[1], moved=(0.5, 0.0))]
    assert solve(views).agreement < 0.3
    right = solve([views[0], seen(base, 3.0, pair[1])])
    assert right.agreement > 0.99 and right.strain.max() < 0.1


def test_three_cameras_are_surer_than_two():
    base = base_of('box', 4.0, 3.0, (1.0, 2.0), 0.3)
    views = [seen(base, 3.0, camera, covariance_cm2=0.0025)
             for camera in (place(30, -90), place(30, 30), place(30, 150))]
    two, three = solve(views[:2]), solve(views)
    assert three.height.height_cm == pytest.approx(3.0, abs=0.01)
    assert three.height.deviation_cm < two.height.deviation_cm


def test_object_that_is_no_upright_one_does_not_fit():
    # A cone is as wide as a point at its top.
    base, cameras = base_of('disc', 6.0, 6.0, (0.0, 3.0), 0.0), PAIRS[
        'tilted 30 degrees, opposite sides']
    views = []
    for camera in cameras:
        apex = base.mean(axis=0) * 0.98 + 0.02 * base
        tall = seen(apex, 9.0, camera).corners
        views.append(seen(np.vstack([base, tall]), 0.0, camera))
    assert solve(views).agreement < 0.3
    assert solve([seen(base, 9.0, camera) for camera in cameras]).agreement > 0.9


@pytest.mark.parametrize('pair', PAIRS)
def test_part_that_one_camera_does_not_see_changes_little(pair):
    # A corner of a light box on a light table: 4 mm of it are not found.
    base, random = base_of('box', 5.0, 4.0, (3.0, 2.0), 0.3), np.random.default_rng(4)
    first, second = (seen(base, 4.0, camera, random, noise_px=0.1) for camera in PAIRS[pair])
    along = second.corners @ np.array([0.6, 0.8])
    lacking = second._replace(corners=second.corners[along < along.max() - 0.4])
    found = solve([first, lacking])
    assert found.height.height_cm == pytest.approx(4.0, abs=0.05)
    np.testing.assert_allclose(found.moments.centre, [3.0, 2.0], atol=0.03)
    assert found.extent[:2] == pytest.approx((5.0, 4.0), abs=0.1)
    assert found.agreement < solve([first, second]).agreement


def test_outlines_of_wide_pixels_may_be_farther_apart():
    base, random = base_of('box', 5.0, 4.0, (3.0, 2.0), 0.3), np.random.default_rng(4)
    fine = [seen(base, 4.0, camera, random, noise_px=0.9)
            for camera in PAIRS['tilted 30 degrees, opposite sides']]
    coarse = [one._replace(noise_cm=0.06) for one in fine]
    assert solve(fine).agreement < 0.7 < solve(coarse).agreement
    assert solve(coarse).height.deviation_cm > 1.5 * solve(fine).height.deviation_cm


def test_a_camera_right_above_an_object_is_a_camera_as_any():
    base = base_of('box', 4.0, 3.0, (1.0, 2.0), 0.3)
    above = CameraPlace((1.2, 1.9), 70.0)
    found = solve([seen(base, 3.0, above), seen(base, 3.0, place(35, 0))])
    assert found.height.height_cm == pytest.approx(3.0, abs=0.01)
