# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where the camera is, against cameras whose place is known."""

from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface.points import camera_pose, CameraIntrinsics, MatchedPoints
import cv2
import numpy as np
import pytest
from rendered_board import camera_place, CENTRE, IMAGE_SIZE, pixel_from_surface, project

CORNERS = np.array([[x, y] for y in np.arange(6) * 2.5 for x in np.arange(9) * 2.5])
CAMERA = np.array([[600.0, 0, CENTRE[0]], [0, 600.0, CENTRE[1]], [0, 0, 1]])
PLAIN = CameraIntrinsics(IMAGE_SIZE, CAMERA, np.zeros(5))


def seen(points=CORNERS, **camera):
    return MatchedPoints(points, project(pixel_from_surface(**camera), points))


@pytest.mark.parametrize('tilt_deg', [0, 3, 30, 60])
@pytest.mark.parametrize('yaw_deg', [0, 40, 200])
def test_exact_points_give_the_exact_place(tilt_deg, yaw_deg):
    pose = camera_pose(seen(tilt_deg=tilt_deg, yaw_deg=yaw_deg), PLAIN)
    foot, height = camera_place(tilt_deg, yaw_deg)
    assert pose.height_cm == pytest.approx(height, abs=1e-3)
    assert pose.foot_cm == pytest.approx(foot, abs=1e-3)
    assert pose.rms_px < 1e-3


def test_four_points_suffice():
    corners = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 12.5], [0.0, 12.5]])
    assert camera_pose(seen(corners), PLAIN).height_cm == pytest.approx(
        camera_place()[1], abs=1e-3)


def test_frame_with_y_to_the_other_side_has_the_foot_point_there():
    matched = seen()
    flipped = camera_pose(MatchedPoints(matched.points * [1, -1], matched.pixels), PLAIN)
    foot, height = camera_place()
    assert flipped.height_cm == pytest.approx(height, abs=1e-3)
    assert flipped.foot_cm == pytest.approx(foot * [1, -1], abs=1e-3)


@pytest.mark.parametrize('distortion', [
    [-0.3, 0.1, 0.001, -0.002, 0.02], [-0.3, 0.1, 0.001, -0.002],
    [0.5, -0.2, 0.001, 0.0, 0.02, 0.8, -0.3, 0.05]])
def test_distortion_is_taken_out(distortion):
    rotation, translation = np.array([0.5, 0.1, 0.2]), np.array([-8.0, -5.0, 50.0])
    distortion = np.array(distortion)
    points = np.column_stack([CORNERS, np.zeros(len(CORNERS))])
    pixels = cv2.projectPoints(points, rotation, translation, CAMERA, distortion)[0][:, 0]
    pose = camera_pose(MatchedPoints(CORNERS, pixels),
                       CameraIntrinsics(IMAGE_SIZE, CAMERA, distortion))
    x, y, z = -cv2.Rodrigues(rotation)[0].T @ translation
    assert (*pose.foot_cm, pose.height_cm) == pytest.approx((x, y, abs(z)), abs=1e-3)


def test_noise_of_a_fifth_of_a_pixel_moves_the_camera_by_less_than_1_percent():
    random = np.random.default_rng(0)
    for _ in range(100):
        tilt_deg, yaw_deg = random.uniform(0, 50), random.uniform(0, 360)
        exact = seen(tilt_deg=tilt_deg, yaw_deg=yaw_deg)
        noisy = exact.pixels + random.normal(0, 0.2, exact.pixels.shape)
        pose = camera_pose(MatchedPoints(CORNERS, noisy), PLAIN)
        foot, height = camera_place(tilt_deg, yaw_deg)
        assert pose.height_cm == pytest.approx(height, rel=0.01)
        assert np.linalg.norm(foot - pose.foot_cm) < 0.01 * 45
        assert 0.1 < pose.rms_px < 0.5


def test_intrinsics_of_another_lens_show_in_the_error():
    other = CameraIntrinsics(IMAGE_SIZE, CAMERA * [[0.5, 1, 1], [1, 0.5, 1], [1, 1, 1]],
                             np.zeros(5))
    assert camera_pose(seen(), other).rms_px > 3


def test_points_on_one_line_do_not_tell_where_the_camera_is():
    with pytest.raises(CalibrationError, match='on one line'):
        camera_pose(seen(CORNERS[:9]), PLAIN)


def test_intrinsics_that_no_camera_has_give_our_error():
    absurd = CameraIntrinsics(IMAGE_SIZE, CAMERA, np.full(5, 1e300))
    with pytest.raises(CalibrationError, match='no camera with these intrinsics'):
        camera_pose(seen(), absurd)


@pytest.mark.parametrize('values, said', [
    ({'image_size': (0, 480)}, 'width'), ({'matrix': np.eye(2)}, r'shape \(3, 3\)'),
    ({'matrix': CAMERA.T}, r'must be \[fx, 0, cx'), ({'matrix': -CAMERA}, 'fx and fy above 0'),
    ({'matrix': CAMERA * np.nan}, 'finite'), ({'distortion': np.zeros(6)}, 'numbers, got 6'),
    ({'distortion': []}, 'got 0'), ({'distortion': [np.inf] * 5}, 'finite')])
def test_intrinsics_that_cannot_be_used_are_refused(values, said):
    usable = {'image_size': IMAGE_SIZE, 'matrix': CAMERA, 'distortion': np.zeros(5)}
    with pytest.raises(InvalidValueError, match=said):
        CameraIntrinsics(**{**usable, **values})
