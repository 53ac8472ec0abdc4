# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The pictures that programs ask for, and what is said about objects that are left out."""

from camera_to_base.nodes import outputs as camera_pictures
from camera_to_base.nodes.camera_publisher import CameraPublisher
import cv2
import numpy as np
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from ros_helpers import CAMERA_TOPIC
from sensor_msgs.msg import CompressedImage, Image
from visualization_msgs.msg import Marker, MarkerArray

SIMULATED = ('-p', 'source:=simulated', '-p', 'simulated.frame_rate:=20.0')
LATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def picture_of(message):
    return cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_UNCHANGED)


def test_nothing_is_encoded_while_nobody_looks(ros, monkeypatch):
    encoded = []
    for name in ('jpeg_message', 'png_message', 'object_mask'):
        monkeypatch.setattr(camera_pictures, name, lambda *_, name=name: encoded.append(name))
    positions = ros.listen(CAMERA_TOPIC)
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: len(positions) >= 10)
    assert encoded == []


@pytest.mark.slow
def test_the_frame_has_nothing_drawn_on_it_and_comes_ten_times_a_second_at_most(ros):
    frames = ros.listen_to(CompressedImage, '/frame/compressed')
    drawn = ros.listen_to(Image, '/debug_image')
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: len(frames) >= 3)
    frames.clear()
    ros.spin_for(2.0)
    assert 5 <= len(frames) <= 23
    assert frames[-1].format == 'jpeg' and frames[-1].header.frame_id == 'camera_surface'
    frame = picture_of(frames[-1])
    assert frame.shape == (480, 640, 3)
    green = np.array([36, 200, 36])
    with_boxes = np.frombuffer(drawn[-1].data, np.uint8).reshape(480, 640, 3)
    assert (with_boxes == green).all(axis=2).any()
    assert not (np.abs(frame.astype(int) - green) < 20).all(axis=2).any()


def test_the_mask_is_white_where_objects_are(ros):
    masks = ros.listen_to(CompressedImage, '/mask/compressed')
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: masks and picture_of(masks[-1]).any())
    mask = picture_of(masks[-1])
    assert mask.shape == (480, 640) and set(np.unique(mask)) == {0, 255}
    assert 1000 < np.count_nonzero(mask) < 2000  # a coin of 2.4 cm is 43 px wide


@pytest.mark.slow
def test_who_comes_late_gets_the_background_and_then_each_new_one(ros):
    positions = ros.listen(CAMERA_TOPIC)
    node = ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: positions)
    first, second = [], []
    for received in (first, second):
        ros.node.create_subscription(
            CompressedImage, '/background/compressed', received.append, LATE)
        assert ros.spin_until(lambda received=received: received)
    assert picture_of(first[0]).shape == (480, 640, 3)
    assert (picture_of(first[0]) == node._pipeline.background).all()
    assert bytes(second[0].data) == bytes(first[0].data)
    ros.spin_for(0.5)
    assert len(first) == 1
    ros.call('/camera_publisher/capture_background')
    assert ros.spin_until(lambda: len(first) == 2 and len(second) == 2)


@pytest.mark.parametrize('option, kind', [
    ('detector.min_area_cm2:=50.0', 'too_small'),
    ('work_area:=[0.0, 0.0, 0.5, 0.0, 0.5, 0.5]', 'outside_work_area')])
def test_what_is_left_out_is_told_at_its_place_with_its_reason(ros, option, kind):
    told = ros.listen_to(MarkerArray, '/objects_in_cam_frame/left_out')
    truth = ros.listen('/true_pos_in_cam_frame')
    ros.add(CameraPublisher, *SIMULATED, '-p', option)
    assert ros.spin_until(lambda: told and len(told[-1].markers) > 1 and truth)
    first, marker = told[-1].markers[:2]
    assert first.action == Marker.DELETEALL
    assert marker.ns == kind and marker.type == Marker.TEXT_VIEW_FACING
    assert marker.header.frame_id == 'camera_surface' and marker.scale.z > 0
    assert max(map(len, marker.text.splitlines())) <= 32
    assert kind.split('_')[-1] in marker.text.replace('less', 'small')
    place = np.array([marker.pose.position.x, marker.pose.position.y]) * 100
    assert np.linalg.norm(truth - place, axis=1).min() < 0.1


@pytest.mark.parametrize('least_cm2, is_labelled', [(50.0, True), (0.0, False)])
def test_what_is_left_out_is_drawn_with_a_label_but_without_a_box(ros, least_cm2, is_labelled):
    images = ros.listen_to(Image, '/debug_image')
    ros.add(CameraPublisher, *SIMULATED, '-p', f'detector.min_area_cm2:={least_cm2}')

    def has(colour, message):
        picture = np.frombuffer(message.data, np.uint8).reshape(480, 640, 3)[60:]
        return np.count_nonzero((picture == colour).all(axis=2)) > 100

    green = (36, 200, 36)
    assert ros.spin_until(lambda: len(images) > 10 and any(has(40, one) for one in images[5:]))
    assert all(has(green, one) != is_labelled for one in images[5:])


@pytest.mark.slow
def test_a_calibration_that_is_set_while_the_node_runs_is_followed(ros):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    node = ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: statuses)
    from rclpy.parameter import Parameter
    assert node.set_parameters([Parameter(
        'calibration.device', value='/dev/v4l/by-id/usb-Other')])[0].successful
    assert ros.spin_until(lambda: statuses[-1].values['reason'] == 'other_camera')
