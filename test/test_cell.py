# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The face for Python programs: the same positions as the pipeline and the topics."""

from pathlib import Path
import re
import sys
import time

from camera_to_base import Cell
from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import CameraToBaseError
from camera_to_base.settings import read_node_settings
from camera_to_base.sources import VIDEO_FILE
from camera_to_base.uncertainty import uncertain_transform
import cv2
import numpy as np
import pytest
from recordings import disc_frame, RADIUS, SIZE, write_video

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / 'examples'))
import webcam_without_ros  # noqa: E402 I100

CM_PER_PX = 36.0 / SIZE[0]
FILE = """/**:
  ros__parameters:
    surface: {model: parallel, parallel: {width_cm: 36.0}, image_size: [320, 240]}
    rotation_deg: [180.0, 0.0, 0.0]
    displacement_cm: [-17.8, 24.4, 0.0]
"""
PATH = [(60 + 9 * number, 70 + 5 * number) for number in range(20)]


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path('cell.yaml').write_text(FILE)
    return 'cell.yaml'


def bar_frame():
    frame = disc_frame([(60, 60), (250, 180)])
    cv2.fillPoly(frame, [cv2.boxPoints(((160, 120), (80, 20), 30.0)).astype(int)], (30, 30, 30))
    return frame


def test_objects_are_given_in_both_frames_with_size_yaw_and_covariance(file):
    cell = Cell.open(file)
    cell.take_background(disc_frame(None))
    seen = cell.locate(bar_frame())
    assert seen.reason is None and seen.warning is None and len(seen.objects) == 3
    bar, = (one for one in seen.objects if one.camera_yaw_deg is not None)
    x, y = bar.camera_xy_cm
    assert (x, y) == pytest.approx((160 * CM_PER_PX, 120 * CM_PER_PX), abs=0.06)
    assert bar.base_xy_cm == pytest.approx((x - 17.8, 24.4 - y))
    assert bar.base_xyz_cm[2] == pytest.approx(0.0)
    assert (bar.camera_yaw_deg, bar.base_yaw_deg) == pytest.approx((30, -30), abs=1.5)
    assert bar.size_cm == pytest.approx((81 * CM_PER_PX, 21 * CM_PER_PX), abs=0.15)
    disc = seen.objects[0]
    assert disc.base_yaw_deg is None
    assert disc.size_cm == pytest.approx([2 * RADIUS * CM_PER_PX] * 2, abs=0.1)
    assert disc.height_cm == 0
    assert np.linalg.eigvalsh(disc.base_covariance_cm2).min() > 0
    assert disc.base_covariance_cm2[0, 0] >= disc.camera_covariance_cm2[0, 0]


def test_numbers_are_those_of_the_pipeline_and_the_transform(file):
    settings, cell = read_node_settings(file), Cell.open(file)
    pipeline = settings.camera.pipeline('', VIDEO_FILE)
    transform = uncertain_transform(settings.transform)
    for frame in map(disc_frame, [None, *PATH[:3]]):
        seen, sighting = cell.locate(frame), pipeline.process(frame)
        uncertainty = pipeline.frame_uncertainty(frame, settings.camera.uncertainty)
        assert len(seen.objects) == len(sighting.objects)
        for one, found in zip(seen.objects, sighting.objects):
            covariance = transform.base_covariance(
                (*found.point, 0.0), uncertainty.of(found).matrix)
            assert one.camera_xy_cm == tuple(found.point)
            assert one.base_xyz_cm == settings.transform.base_pose(
                Pose(*found.point, 0.0, 0.0))[:3]
            assert (one.base_covariance_cm2 == covariance[:2, :2]).all()


def test_what_may_not_be_used_is_a_reason(file):
    Path(file).write_text(FILE + '    background_frames: 2\n')
    cell = Cell.open(file)
    assert cell.locate(disc_frame(None)).reason.kind == 'background_missing'
    assert cell.locate(disc_frame(None)) == ((), (), None, None)
    assert cell.locate(None).reason.kind == 'frame_unusable'
    assert cell.locate(disc_frame(None, (64, 48))).reason.kind == 'frame_size'
    with pytest.raises(CameraToBaseError, match='expected a frame'):
        cell.take_background(None)
    with pytest.raises(CameraToBaseError, match="there is no file 'none.yaml'|none.yaml"):
        Cell.open('none.yaml')


def test_live_positions_are_confirmed_new_and_undamaged(file):
    def noisy(disc, random=np.random.default_rng(1)):
        return cv2.add(disc_frame(disc), random.integers(0, 6, (240, 320, 3), np.uint8))

    cell = Cell.open(file, live=True)
    cell.take_background(noisy(None), noisy(None))
    assert cell.locate(noisy((60, 60))).reason.kind == 'unconfirmed'
    coin = noisy((60, 60))
    assert len(cell.locate(coin).objects) == 1
    repeated = cell.locate(coin.copy())
    assert repeated.reason.kind == 'repeated' and repeated.objects == ()
    late = cell.locate(noisy((60, 60)), time.monotonic() - 1.0)
    assert late.reason.kind == 'too_late' and late.objects == ()


def test_object_beyond_reach_has_no_place_in_the_base_frame(file):
    Path(file).write_text(FILE + '    reach_cm: 5.0\n')
    cell = Cell.open(file)
    cell.take_background(disc_frame(None))
    one, = cell.locate(disc_frame((60, 60))).objects
    assert one.base_xy_cm is one.base_xyz_cm is one.base_yaw_deg is None
    assert one.camera_xy_cm == pytest.approx((6.75, 6.75), abs=0.1)


def test_another_camera_is_a_warning(file):
    Path(file).write_text(FILE + '    calibration: {device: /dev/video7}\n')
    for source, kind in ('/dev/video5', 'other_camera'), ('/dev/video7', None), ('', None):
        warning = Cell.open(file, source=source).locate(disc_frame(None)).warning
        assert (warning and warning.kind) == kind


def test_programs_of_the_page_and_of_the_examples_run(file, capsys):
    write_video('last_night.avi', [None, *PATH])
    page = (ROOT / 'docs' / 'python.md').read_text()
    program = re.search('```python\n(.*?)```', page, re.DOTALL).group(1)
    exec(program.replace('last_night.mp4', 'last_night.avi'), {})
    lines = capsys.readouterr().out.splitlines()
    webcam_without_ros.main([file, 'last_night.avi'])
    said = capsys.readouterr().out.splitlines()
    assert len(lines) == len(said) == len(PATH)
    x, y = 60 * CM_PER_PX - 17.8, 24.4 - 70 * CM_PER_PX
    assert [float(number) for number in re.findall(r'-?\d+\.\d+', lines[0])[:2]] == (
        pytest.approx([x, y], abs=0.1))
    assert [float(number) for number in re.findall(r'-?\d+\.\d+', said[0])[:2]] == (
        pytest.approx([x, y], abs=0.1))


@pytest.mark.slow
def test_positions_are_those_on_the_topics(file, ros):
    from camera_to_base.nodes.camera_publisher import CameraPublisher
    from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
    from geometry_msgs.msg import PoseWithCovarianceStamped

    video = write_video(Path('disc.avi').absolute(), [None, *PATH], fps=5.0)
    poses = ros.listen_to(PoseWithCovarianceStamped, 'pos_in_robot_base_frame/pose')
    ros.add(RobotBasePublisher, '--params-file', file)
    ros.spin_until(lambda: ros.hears('pos_in_robot_base_frame/pose'))
    ros.add(CameraPublisher, '--params-file', file, '-p', f'source:={video}',
            '-p', 'wait_for_subscribers:=1')
    ros.spin_until(lambda: len(poses) >= 8)

    capture, cell = cv2.VideoCapture(video), Cell.open(file)
    seen = [cell.locate(capture.read()[1]) for _ in range(len(PATH) + 1)]
    objects = [one for frame in seen for one in frame.objects]
    assert len(objects) == len(PATH)
    expected = np.array([one.base_xy_cm for one in objects])
    numbers = []
    for message in poses:
        position = message.pose.pose.position
        off_cm = np.hypot(*(expected - [100 * position.x, 100 * position.y]).T)
        numbers.append(int(off_cm.argmin()))
        assert off_cm.min() < 1e-9
        covariance_cm2 = 1e4 * np.reshape(message.pose.covariance, (6, 6))[:2, :2]
        np.testing.assert_allclose(
            covariance_cm2, objects[numbers[-1]].base_covariance_cm2, rtol=1e-9)
    assert numbers == sorted(set(numbers))


def test_single_pictures_have_no_budget(file):
    Path(file).write_text(FILE + '    detector: {budget_px: 1000}\n')
    places = (60, 60), (160, 120), (250, 180)
    shade = np.zeros(SIZE[::-1], np.float32)
    for u, v in places:
        cv2.circle(shade, (u + 8, v + 6), RADIUS, 1.0, cv2.FILLED)
    dimmed = disc_frame(None) * (1 - 0.4 * cv2.GaussianBlur(shade, (0, 0), 2))[..., None]
    for u, v in places:
        cv2.circle(dimmed, (u, v), RADIUS, (40, 50, 170), cv2.FILLED)
    cell = Cell.open(file)
    cell.take_background(disc_frame(None))
    seen = cell.locate(dimmed.astype(np.uint8))
    assert len(seen.objects) == 3
    assert 'too_much' not in [one.reason.kind for one in seen.left_out]
