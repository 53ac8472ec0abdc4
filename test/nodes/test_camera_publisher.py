# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math
import os
import time

from ament_index_python.packages import get_package_share_directory
from camera_to_base import settings as named_source
from camera_to_base.errors import CameraToBaseError, FrameSourceError
from camera_to_base.nodes import services as background_service
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.sources.kinds import DEVICE
from captures import Device
import cv2
from geometry_msgs.msg import PoseArray
import numpy as np
import pytest
from rclpy.exceptions import ParameterException
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from ros_helpers import assert_in_time, CAMERA_TOPIC, TRUE_TOPIC
from std_srvs.srv import Trigger


ERROR = 40
OVERHEAD = os.path.join(
    get_package_share_directory('camera_to_base'), 'config', 'overhead_camera.yaml')
# The tutorial's surface to a hundredth of a mm, and yet a calibration of one's own.
CALIBRATED = 'surface.parallel.width_cm:=36.001'


class GivenFrames:
    """A camera that plays given frames, the last one for ever; an error among them is raised."""

    kind = DEVICE

    def __init__(self, frames):
        self._frames = list(frames)
        self._count = 0

    def read(self):
        time.sleep(0.03)
        frame = self._frames.pop(0) if len(self._frames) > 1 else self._frames[0]
        if isinstance(frame, Exception):
            raise frame
        self._count += 1
        return self._with_noise(frame)

    def _with_noise(self, frame):
        # A picture without any noise would be taken for a repeated one.
        noise = np.random.default_rng(self._count).integers(0, 3, frame.shape, np.uint8)
        return cv2.add(frame, noise)

    def release(self):
        pass


@pytest.fixture
def play(ros, monkeypatch):
    def play_frames(frames, *arguments):
        monkeypatch.setattr(
            named_source, 'open_frame_source', lambda name: GivenFrames(frames))
        return ros.add(CameraPublisher, '-p', 'source:=given', '-p', CALIBRATED, *arguments)
    return play_frames


def table(width=640, height=480):
    return np.full((height, width, 3), 200, np.uint8)


def table_with_disc(u, v, width=640, height=480):
    return cv2.circle(table(width, height), (u, v), 21, (50, 50, 50), -1)


def table_with_cylinder(u, v, height_share):
    """Draw an upright cylinder, seen from above (320, 240), by its height / the camera's."""
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    bottom = 21 * np.column_stack([np.cos(angles), np.sin(angles)]) + (u, v)
    top = (320, 240) + (bottom - (320, 240)) / (1 - height_share)
    hull = cv2.convexHull(np.rint(16 * np.concatenate([bottom, top])).astype(np.int32))
    return cv2.fillConvexPoly(table(), hull, (50, 50, 50), cv2.LINE_AA, 4)


def listen_for_camera(ros):
    return ros.listen(CAMERA_TOPIC)


def distances_to_the_truth_cm(ros, *arguments):
    """Run the node on the simulated board; give each position's distance to the true one."""
    received, true = ros.listen_with_time(CAMERA_TOPIC), ros.listen_with_time(TRUE_TOPIC)
    ros.add(CameraPublisher, '-p', 'source:=simulated', *arguments)
    assert ros.spin_until(lambda: len(received) >= 10 and len(true) >= 10)
    positions = [(sent, position) for sent, position in received if sent > true[0][0]]
    ros.spin_for(0.2)  # topics do not wait for each other: let the last one's truth arrive
    assert len(positions) >= 5
    return [math.dist(position, max(entry for entry in true if entry[0] <= sent)[1])
            for sent, position in positions]


def test_simulated_coin_is_published_within_2_mm_of_its_true_position(ros):
    assert max(distances_to_the_truth_cm(ros)) < 0.2


def test_position_of_an_object_is_in_cm(ros, play):
    received = listen_for_camera(ros)
    play([table(), table_with_disc(320, 240)])
    assert ros.spin_until(lambda: received)
    assert received[0] == pytest.approx([18.0, 13.5], abs=0.12)


def test_nothing_is_published_for_a_frame_without_an_object(ros, play):
    received = listen_for_camera(ros)
    play([table()])
    ros.spin_for(0.5)
    assert received == []


@pytest.mark.slow
def test_frame_of_another_size_gives_no_position_and_the_node_lives(ros, play):
    received, lines = listen_for_camera(ros), ros.listen_to_log('camera_publisher')
    small = table_with_disc(100, 100, 320, 240)
    play([table(), table(), *[small] * 30, table_with_disc(320, 240)])
    assert ros.spin_until(lambda: received)
    assert received[0] == pytest.approx([18.0, 13.5], abs=0.12)
    assert len([line for line in lines if line.level == ERROR]) == 1


def test_camera_that_gives_no_frame_publishes_nothing_and_is_read_again(ros, play):
    received = listen_for_camera(ros)
    play([table(), FrameSourceError('unplugged'), table_with_disc(320, 240)])
    assert ros.spin_until(lambda: received, 3.0)


@pytest.mark.slow
def test_error_that_nobody_foresaw_in_the_camera_is_said_and_the_camera_is_read_again(ros, play):
    received, lines = listen_for_camera(ros), ros.listen_to_log('camera_publisher')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    play([table(), *[table_with_disc(320, 240)] * 90, *[ValueError('odd')] * 4,
          table_with_disc(320, 240)])
    assert ros.spin_until(lambda: statuses and 'ValueError' in statuses[-1].message, 8.0)
    assert statuses[-1].level == 2 and 'nothing is published' in statuses[-1].message
    assert statuses[-1].values['reason'] == 'camera_lost'
    told = [line for line in lines if 'ValueError: odd' in line.text]
    assert [line.level for line in told] == [ERROR]
    count = len(received)
    assert ros.spin_until(lambda: len(received) > count, 5.0)
    assert ros.spin_until(lambda: statuses[-1].level == 0, 3.0)


def test_homography_refuses_pictures_that_it_was_not_made_for(ros, play):
    received = listen_for_camera(ros)
    play([table(320, 240), table_with_disc(100, 100, 320, 240)],
         '-p', 'surface.model:=homography')
    ros.spin_for(0.5)
    assert received == []


@pytest.mark.slow
def test_precise_method_puts_the_simulated_coin_within_a_tenth_of_a_mm(ros):
    assert max(distances_to_the_truth_cm(ros, '-p', 'detector.method:=precise')) < 0.01


@pytest.mark.slow
def test_random_pixels_come_from_the_tutorials_range(ros):
    received = listen_for_camera(ros)
    ros.add(CameraPublisher, '-p', 'source:=random', '-p', 'period:=0.01')
    assert ros.spin_until(lambda: len(received) >= 100)
    pixels = np.array(received) / (36.0 / 640)
    assert pixels == pytest.approx(np.rint(pixels))
    assert pixels.min() >= 250 and pixels.max() <= 450


def test_period_can_be_changed_while_the_node_runs(ros):
    received = listen_for_camera(ros)
    node = ros.add(CameraPublisher, '-p', 'source:=random', '-p', 'period:=1000')
    assert node.set_parameters([Parameter('period', value=0.01)])[0].successful
    assert ros.spin_until(lambda: len(received) >= 5, 3.0)


def test_whole_number_is_accepted_for_the_period(ros):
    node = ros.add(CameraPublisher, '-p', 'source:=random', '-p', 'period:=3')
    assert node.get_parameter('period').value == 3.0
    assert node.get_parameter('period').type_ == Parameter.Type.DOUBLE


def test_new_threshold_takes_effect_with_the_old_background(ros, play):
    received = listen_for_camera(ros)
    node = play([table(), table_with_disc(320, 240)], '-p', 'detector.method:=tutorial',
                '-p', 'detector.threshold:=200')
    ros.spin_for(0.5)
    assert received == []
    assert node.set_parameters([Parameter('detector.threshold', value=95)])[0].successful
    assert ros.spin_until(lambda: received)


@pytest.mark.parametrize('name, value', [
    ('detector.threshold', 256), ('detector.threshold', 'high'), ('detector.median_size', 4),
    ('detector.closing_size', 0), ('period', 0.0), ('period', math.nan),
    ('surface.model', 'cubic'), ('surface.parallel.width_cm', -1.0), ('source', 'random'),
    ('surface.homography.surface_from_pixel', [1.0, 2.0])])
def test_bad_value_is_rejected_with_the_reason_and_changes_nothing(ros, name, value):
    node = ros.add(CameraPublisher, '-p', 'source:=random', '-p', 'surface.model:=homography')
    before = node.get_parameter(name).value
    result = node.set_parameters([Parameter(name, value=value)])[0]
    assert not result.successful
    assert str(value) in result.reason or 'STRING' in result.reason or name in result.reason
    assert node.get_parameter(name).value == before


@pytest.mark.parametrize('argument', [
    'detector.threshold:=300', 'detector.threshold:=95.5', 'detector.median_size:=2',
    'period:=soon', 'surface.model:=cubic', 'surface.image_size:=[640]', 'period:=.nan',
    'surface.polynomial.y_of_v:=text',
    'surface.hull:=[1.0, 2.0, 3.0]', 'surface.hull:=[1.0, 1.0, 2.0, 2.0, 3.0, 3.0]',
    'surface.homography.distortion_coefficient:=5.0',
    'source:=/does/not/exist.avi', 'source:=/dev/video99', 'camera_frame_id:=/table'])
def test_bad_value_at_start_is_refused_and_nothing_of_the_node_stays(ros, argument):
    with pytest.raises((CameraToBaseError, ParameterException)) as error:
        ros.add(CameraPublisher, '-p', argument, '-p', 'wait_for_camera:=false')
    assert len(str(error.value)) > 20
    assert ros.spin_until(lambda: 'camera_publisher' not in ros.node.get_node_names())


def test_topic_is_reliable_with_depth_10(ros):
    node = ros.add(CameraPublisher, '-p', 'source:=random', '-r', '__ns:=/apart')
    topic = f'/apart{CAMERA_TOPIC}'
    info, = node.get_publishers_info_by_topic(topic)
    assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert node.get_parameter(f'qos_overrides.{topic}.publisher.depth').value == 10


def test_every_parameter_is_described_and_every_number_has_a_range(ros):
    node = ros.add(CameraPublisher, '-p', 'source:=random')
    names = [name for name in node.list_parameters([], 0).names
             if not name.startswith('qos_overrides') and name != 'use_sim_time'
             and not name.startswith('start_type_description_service')]
    assert len(names) > 10
    for name in names:
        descriptor = node.describe_parameter(name)
        assert descriptor.description, name
        if descriptor.type in (Parameter.Type.INTEGER.value, Parameter.Type.DOUBLE.value):
            assert descriptor.integer_range or descriptor.floating_point_range, name


def test_names_of_parameters_of_earlier_versions_are_one_sentence_each(ros, tmp_path):
    lines = ros.listen_to_log('camera_publisher')
    path = tmp_path / 'cell.yaml'
    path.write_text('/**:\n  ros__parameters: {source: random, reach_cm: 50, annotated_picture: '
                    'it.png, view: {check_period: 1.0}}\n')
    ros.add(CameraPublisher, '--params-file', str(path))
    assert ros.spin_until(lambda: sum('there is no' in line.text for line in lines) == 2)
    for name in ('annotated_picture', 'view.check_period'):
        assert any(line.text == f"there is no parameter '{name}', it is left out"
                   for line in lines)


def warnings_of(node, monkeypatch):
    texts = []
    logger = node.get_logger()
    monkeypatch.setattr(logger, 'warning', lambda text, **options: texts.append(text))
    monkeypatch.setattr(node, 'get_logger', lambda: logger)
    return texts


# The left half of the picture.
HULL = 'surface.hull:=[0.0, 0.0, 320.0, 0.0, 320.0, 480.0, 0.0, 480.0]'


@pytest.mark.parametrize('u, warned', [(200, False), (400, True)])
def test_object_outside_the_calibrated_area_is_published_with_a_warning(
        ros, play, monkeypatch, u, warned):
    received = listen_for_camera(ros)
    warnings = warnings_of(play([table(), table_with_disc(u, 240)], '-p', HULL), monkeypatch)
    assert ros.spin_until(lambda: received)
    assert bool(warnings) == warned
    if warned:
        assert f'({received[0][0]:.2f}, {received[0][1]:.2f}) cm' in warnings[0]


def test_object_outside_the_calibrated_area_is_left_out_where_that_is_asked_for(ros, play):
    received = listen_for_camera(ros)
    both = cv2.circle(table_with_disc(450, 240), (150, 240), 15, (50, 50, 50), -1)
    play([table(), both], '-p', HULL, '-p', 'surface.reject_outside_hull:=true')
    assert ros.spin_until(lambda: received)
    assert received[0][0] == pytest.approx(150 * 0.05625, abs=0.12)


def test_calibrated_area_can_be_changed_while_the_node_runs(ros, play):
    node = play([table()], '-p', 'surface.hull:=[]')
    for hull, good in ([0.0, 0.0, 9.0, 0.0, 9.0, 9.0], True), ([1.0, 2.0], False), ([], True):
        result = node.set_parameters([Parameter('surface.hull', value=hull)])[0]
        assert result.successful == good


def test_height_of_the_objects_can_be_told_while_the_node_runs(ros, play):
    received = listen_for_camera(ros)
    node = play([table(), table_with_cylinder(500, 240, 4 / 60)])
    assert ros.spin_until(lambda: received)
    assert received[-1][0] > 28.4, 'it looks as if it lay where its side faces are'
    height = Parameter('object_height_cm', value=4.0)
    refused, = node.set_parameters([height])
    assert not refused.successful and 'surface.camera_height_cm' in refused.reason
    results = node.set_parameters([Parameter('surface.camera_height_cm', value=60.0), height])
    assert all(result.successful for result in results)
    stands = [500 * 36 / 640, 13.5]
    assert ros.spin_until(lambda: received[-1] == pytest.approx(stands, abs=0.08))


@pytest.mark.slow
def test_background_is_captured_anew_by_a_service(ros, play):
    received = listen_for_camera(ros)
    play([*[table()] * 5, table_with_disc(320, 240)], '-p', 'background_frames:=3')
    assert ros.spin_until(lambda: received)
    response = ros.call('/camera_publisher/capture_background')
    assert response.success
    assert '640 x 480 px, the median of 3 frame(s)' in response.message
    count = len(received)
    ros.spin_for(0.5)
    assert len(received) == count  # the disc is part of the background now


@pytest.mark.slow
def test_calls_that_come_while_a_background_is_taken_share_the_next_one(ros, play):
    received = listen_for_camera(ros)
    play([table()] * 5 + [table_with_disc(320, 240)] * 5, '-p', 'background_frames:=5')
    assert ros.spin_until(lambda: received)
    client = ros.node.create_client(
        Trigger, '/camera_publisher/capture_background', qos_profile=QoSProfile(depth=100))
    assert ros.spin_until(client.service_is_ready)
    begin = time.monotonic()
    calls = [client.call_async(Trigger.Request()) for _ in range(50)]
    assert ros.spin_until(lambda: all(call.done() for call in calls), 20.0)
    assert_in_time(time.monotonic() - begin, 5.0)
    assert all(call.result().success for call in calls)


def test_random_pixels_have_no_background_to_capture(ros):
    ros.add(CameraPublisher, '-p', 'source:=random')
    response = ros.call('/camera_publisher/capture_background')
    assert not response.success and 'RANDOM' in response.message


def test_capture_without_a_camera_is_answered_at_once_with_the_cause(ros, play):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    play([FrameSourceError('unplugged')])
    assert ros.spin_until(lambda: statuses and 'unplugged' in statuses[-1].message)
    begin = time.monotonic()
    response = ros.call('/camera_publisher/capture_background')
    assert_in_time(time.monotonic() - begin, 5.0)
    assert not response.success and 'unplugged' in response.message


def test_capture_of_a_camera_that_was_lost_leaves_the_old_background(ros, play, monkeypatch):
    monkeypatch.setattr(background_service, '_TIMEOUT_S', 0.5)
    received, lines = listen_for_camera(ros), ros.listen_to_log('camera_publisher')
    play([*[table()] * 5, *[table_with_disc(320, 240)] * 60, *[FrameSourceError('unplugged')] * 3,
          table_with_disc(320, 240)], '-p', 'background_frames:=1000')
    # 65 frames are too few: no background at all so far.
    response = ros.call('/camera_publisher/capture_background')
    assert not response.success
    assert 'next ones become the background' in response.message
    assert received == [] and not any('Traceback' in line.text for line in lines)


class NudgedCamera(GivenFrames):
    """A camera over the board that somebody nudges; its first picture is without the object."""

    def __init__(self):
        super().__init__([])
        self._board = SimulatedBoard(image_size=(740, 480), noise=0.0).read()
        self.shift = 0

    def read(self):
        frame = self._board[:, 50 - self.shift:690 - self.shift].copy()
        if self._count:
            cv2.circle(frame, (320 + self.shift, 240), 21, (30, 30, 30), -1)
        self._frames = [frame]
        return super().read()


@pytest.mark.slow
def test_nudged_camera_publishes_nothing_says_why_and_goes_on_when_it_is_back(ros, monkeypatch):
    camera = NudgedCamera()
    monkeypatch.setattr(named_source, 'open_frame_source', lambda name: camera)
    received = listen_for_camera(ros)
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    ros.add(CameraPublisher, '-p', 'source:=given', '-p', CALIBRATED,
            '-p', 'view.correct_up_to_px:=0.0')
    assert ros.spin_until(lambda: received and statuses and int(
        statuses[-1].values.get('frames', 0)) > 40)
    assert statuses[-1].level == 0
    camera.shift = 5
    assert ros.spin_until(lambda: 'has moved by' in statuses[-1].message, 5.0)
    assert statuses[-1].level == 2 and 'capture_background' in statuses[-1].message
    assert statuses[-1].values['reason'] == 'view_moved'
    count = len(received)
    ros.spin_for(0.5)
    assert len(received) == count
    camera.shift = 0
    assert ros.spin_until(lambda: len(received) > count + 3, 8.0)
    assert ros.spin_until(lambda: statuses[-1].level == 0, 3.0)


@pytest.mark.slow
def test_surface_without_structure_is_said_to_be_no_help_against_a_nudge(ros, play):
    lines = ros.listen_to_log('camera_publisher')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    play([table()])
    assert ros.spin_until(lambda: statuses and 'no structure' in statuses[-1].values[
        'view shift (px)'])
    assert statuses[-1].level == 0
    assert ros.spin_until(lambda: any('put marks into' in line.text for line in lines), 5.0)
    ros.spin_for(1.0)
    assert sum('put marks into' in line.text for line in lines) == 1


@pytest.mark.slow
def test_movement_along_the_only_lines_of_a_surface_is_said_to_be_no_movement_to_the_view(
        ros, play):
    lined = table()
    lined[60:64] = lined[400:404] = 120
    lines = ros.listen_to_log('camera_publisher')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    play([lined])
    assert ros.spin_until(lambda: statuses and 'without movements along' in statuses[-1].values[
        'view shift (px)'])
    assert statuses[-1].level == 0
    assert ros.spin_until(lambda: any('along it; put marks' in line.text for line in lines), 5.0)


@pytest.mark.slow
def test_objects_beyond_the_horizon_only_are_a_warning_for_as_long_as_nothing_else_is_seen(
        ros, play):
    def seen(*places):
        frame = table()
        for place in places:
            cv2.circle(frame, place, 21, (50, 50, 50), -1)
        return frame

    far, near = (500, 50), (320, 400)
    received, arrays = listen_for_camera(ros), ros.listen_to(PoseArray, 'objects_in_cam_frame')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    # A camera that looks along a road, see test_object_locator.py.
    play([table(), *[seen(near, far)] * 30, *[seen(far)] * 120, seen(near, far)],
         '-p', 'surface.model:=homography',
         '-p', 'surface.homography.surface_from_pixel:='
         '[1.0, 0.0, -320.0, 0.0, 0.0, 128.0, 0.0, 1.0, -112.0]')
    assert ros.spin_until(lambda: statuses and 'horizon' in statuses[-1].message, 8.0)
    assert statuses[-1].level == 1 and 'tilt the camera down' in statuses[-1].message
    count = len(received)
    assert count
    arrays.clear()
    ros.spin_for(0.3)
    assert len(received) == count
    assert arrays and not any(array.poses for array in arrays)  # the surface is empty
    assert ros.spin_until(lambda: len(received) > count + 3, 8.0)
    assert ros.spin_until(lambda: statuses[-1].level == 0, 3.0)


def test_picture_size_can_be_changed_for_the_next_time_that_a_device_is_opened(ros, monkeypatch):
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    monkeypatch.setattr(Device, 'opened', [])
    node = ros.add(CameraPublisher, '-p', 'source:=7')
    assert node.set_parameters([Parameter('surface.image_size', value=[320, 240])])[0].successful
    # The stand-in gives two frames, and is then opened anew.
    assert ros.spin_until(lambda: Device.opened and Device.opened[-1].wishes == {
        cv2.CAP_PROP_FRAME_WIDTH: 320, cv2.CAP_PROP_FRAME_HEIGHT: 240})


@pytest.mark.slow
def test_change_is_on_the_diagnostics_at_once(ros, play):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    lines = ros.listen_to_log('camera_publisher')
    play([table(), *[table()] * 100, FrameSourceError('unplugged')])
    assert ros.spin_until(lambda: lines and 'unplugged' in lines[-1].text)
    ros.spin_for(0.3)
    first = next(status for status in statuses if status.level == 2)
    assert abs(first.received_at - lines[-1].received_at) < 0.25


@pytest.mark.slow
def test_diagnostics_come_once_a_second_with_what_a_user_should_know(ros, play):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    play([table()])
    assert ros.spin_until(lambda: len(statuses) >= 3, 6.0)
    assert_in_time(abs(statuses[2].received_at - statuses[1].received_at - 1.0), 0.3)
    assert statuses[-1].level == 0
    assert statuses[-1].values['reason'] == 'ok'
    assert {'source', 'detection rate (frames/s)', 'frames with an object (1/s)', 'frames read',
            'frames dropped: damaged', 'reconnects', 'background', 'view shift (px)',
            'age of the last frame (s)'} <= set(statuses[-1].values)


@pytest.mark.parametrize('text', [
    '/**: {ros__parameters: {surface: {parallel: {width_cm: 50.0}}}}',
    'camera_publisher: {ros__parameters: {detector: {threshold: 60}}}',
    'robot_base_publisher: {ros__parameters: {displacement_cm: [1.0, 2.0, 0.0]}}',
    '/**: {ros__parameters: {sourc: /dev/video2}}',
    'camera_publsher: {ros__parameters: {source: /dev/video2}}', ''])
def test_node_that_was_set_up_waits_for_a_camera_instead_of_random_pixels(
        ros, monkeypatch, tmp_path, text):
    monkeypatch.setattr('glob.glob', lambda pattern: [])
    (tmp_path / 'cell.yaml').write_text(text)
    received, lines = listen_for_camera(ros), ros.listen_to_log('camera_publisher')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    ros.add(CameraPublisher, '--params-file', str(tmp_path / 'cell.yaml'), '-p', 'period:=0.05')
    assert ros.spin_until(lambda: statuses and statuses[-1].level == 2)
    assert statuses[-1].values['reason'] == 'camera_waiting'
    assert 'no camera is attached: plug one in' in statuses[-1].message
    ros.spin_for(0.5)
    assert received == []
    assert sum('no camera is attached' in line.text for line in lines) == 1
    in_vain = text == '' or 'sourc:' in text or 'publsher' in text
    assert sum('no random positions' in line.text for line in lines) == in_vain


def test_misspelt_parameter_on_the_command_line_means_no_random_pixels(ros, monkeypatch):
    monkeypatch.setattr('glob.glob', lambda pattern: [])
    received, lines = listen_for_camera(ros), ros.listen_to_log('camera_publisher')
    ros.add(CameraPublisher, '-p', 'sorce:=simulated', '-p', 'period:=0.05')
    assert ros.spin_until(lambda: any('no random positions' in line.text for line in lines))
    assert any("no parameter 'sorce'" in line.text and "'source'" in line.text for line in lines)
    ros.spin_for(0.5)
    assert received == []


@pytest.mark.parametrize('arguments', [
    [], ['--params-file', OVERHEAD], ['--params-file', OVERHEAD, '-p', 'camera_frame_id:=cell/1',
                                      '-p', 'background_file:=kept.png']])
def test_node_that_was_not_set_up_has_the_tutorials_random_pixels(ros, monkeypatch, arguments):
    monkeypatch.setattr('glob.glob', lambda pattern: [])
    received = listen_for_camera(ros)
    ros.add(CameraPublisher, *arguments, '-p', 'period:=0.05')
    assert ros.spin_until(lambda: len(received) >= 3)


@pytest.mark.slow
def test_surface_that_is_the_tutorials_is_told_once_and_a_warning_until_it_is_calibrated(
        ros, monkeypatch):
    monkeypatch.setattr(named_source, 'open_frame_source', lambda name: GivenFrames([table()]))
    lines = ros.listen_to_log('camera_publisher')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    node = ros.add(CameraPublisher, '-p', 'source:=given')
    assert ros.spin_until(
        lambda: statuses and statuses[-1].values['reason'] == 'not_calibrated')
    assert statuses[-1].level == 1 and 'run calibrate' in statuses[-1].message
    node.set_parameters([Parameter('surface.parallel.width_cm', value=50.0)])
    assert ros.spin_until(lambda: statuses[-1].level == 0)
    assert sum('is not calibrated' in line.text for line in lines) == 1


@pytest.mark.parametrize('arguments, reason', [
    ([], 'not_calibrated'), (['--params-file', OVERHEAD], 'not_calibrated'),
    (['--params-file', OVERHEAD.replace('overhead', 'simulated')], 'ok')])
def test_simulated_camera_is_calibrated_with_its_own_file_only(ros, arguments, reason):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    ros.add(CameraPublisher, '-p', 'source:=simulated', *arguments)
    assert ros.spin_until(
        lambda: statuses and statuses[-1].values.get('reason') == reason)
