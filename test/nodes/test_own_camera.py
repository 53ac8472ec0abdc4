# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A node whose calibration belongs to another camera, or to another view."""

from array import array

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.surface.thumbnail import view_thumbnail
import cv2
import numpy as np
import pytest
from rclpy.qos import qos_profile_sensor_data
from ros_helpers import CAMERA_TOPIC, stamp_now
from sensor_msgs.msg import Image

WARN, ERROR = 1, 2


def table(seed):
    noise = np.random.default_rng(seed).normal(0, 1, (480, 640))
    blurred = cv2.GaussianBlur(noise, (0, 0), 15)
    grey = (150 + 15 * blurred / blurred.std()).clip(0, 255).astype(np.uint8)
    return np.repeat(grey[:, :, None], 3, axis=2)


class Driver:
    """Shows the node an empty table, then a coin."""

    def __init__(self, ros):
        self._ros, self._random = ros, np.random.default_rng(1)
        self._publisher = ros.node.create_publisher(Image, 'image', qos_profile_sensor_data)

    def show_until(self, condition, coin=False):
        def next_frame():
            picture = table(1)
            if coin:
                cv2.circle(picture, (320, 240), 25, (20, 20, 20), -1)
            noisy = picture + self._random.normal(0, 1.5, picture.shape)
            message = Image(encoding='bgr8', height=480, width=640, step=1920, data=array(
                'B', noisy.clip(0, 255).astype(np.uint8).tobytes()))
            message.header.stamp = stamp_now()
            self._publisher.publish(message)
            self._ros.spin_for(0.05)
            return condition()
        self._ros.spin_until(next_frame)


@pytest.mark.slow
@pytest.mark.parametrize('seed, strict, level', [
    (1, False, 0), (2, False, WARN), (2, True, ERROR)])
def test_another_view_is_a_warning_and_strict_publishes_nothing(ros, seed, strict, level):
    positions = ros.listen(CAMERA_TOPIC)
    log = ros.listen_to_log('camera_publisher')
    status = ros.listen_to_diagnostics('/camera_publisher')
    ros.add(CameraPublisher, '-p', 'source:=topic', '-p', 'surface.parallel.width_cm:=30.0',
            '-p', f'calibration.thumbnail:={view_thumbnail(table(seed))}',
            '-p', f'calibration.strict:={str(strict).lower()}')
    driver = Driver(ros)
    driver.show_until(lambda: any('ready' in line.text for line in log) or (
        strict and any('shares nothing' in line.text for line in log)))
    if strict:
        driver.show_until(lambda: len(status) and status[-1].values['reason'] == 'other_view',
                          coin=True)
        seen = len(status)
        driver.show_until(lambda: len(status) > seen + 1, coin=True)
        assert positions == []
    else:
        driver.show_until(lambda: positions, coin=True)
        seen = len(status)
        driver.show_until(lambda: len(status) > seen + 1, coin=True)
    assert status[-1].values['reason'] == ('ok' if seed == 1 else 'other_view')
    assert status[-1].level == level
    warned = [line for line in log if 'shares nothing' in line.text]
    assert len(warned) == (0 if seed == 1 else 1)
