# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A camera whose first pictures are no good: none of them becomes the background."""

import math

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.outputs import image_message, jpeg_message
import cv2
import damaged_frames
import numpy as np
import pytest
from rclpy.qos import qos_profile_sensor_data
from ros_helpers import CAMERA_TOPIC, stamp_now
import scenes
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Header

TRUE = 400 * 36.0 / 640, 300 * 36.0 / 640


def table(empty_s):
    """Make a grained table, on which the precise detector repairs no background."""
    return scenes.still_coin(empty_s=empty_s, texture=400)


def green_lower_half(frame, number):
    """Lose what a decoder shows as YUV 0, 0, 0."""
    frame[240:] = (0, 135, 0)
    return frame


def white_lower_half(frame, number):
    """Lose what a driver fills with white."""
    frame[240:] = 255
    return frame


def black(frame, number):
    """See nothing but noise."""
    return np.random.default_rng(number).integers(0, 3, frame.shape, np.uint8)


def flat(frame, number):
    """Have one colour all over, another one each time."""
    return np.full_like(frame, 60 + 20 * number)


def brightening(frame, number):
    """Warm up: the exposure grows from nothing."""
    return cv2.convertScaleAbs(frame, alpha=number / 10)


def half_a_jpeg(frame, number):
    """Be decoded by a driver that takes what has come."""
    jpeg = damaged_frames.cut_but_ended(cv2.imencode('.jpg', frame)[1].tobytes())
    return cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)


def play(ros, make_message, *arguments):
    """Start the node; give a function that sends it a picture as a driver does."""
    node = ros.add(CameraPublisher, *arguments)
    message = make_message(Header(), np.zeros((8, 8, 3), np.uint8))
    topic = 'image/compressed' if isinstance(message, CompressedImage) else 'image'
    driver = ros.node.create_publisher(type(message), topic, qos_profile_sensor_data)
    assert ros.spin_until(
        lambda: driver.get_subscription_count() and node.count_publishers(f'/{topic}'))
    ros.spin_for(0.2)

    def send(message):
        driver.publish(message)
        ros.spin_for(0.04)

    return send


def check_coin_is_found_and_nothing_else(positions, send, make_message):
    take_frame = table(empty_s=0.6)
    for _ in range(150):
        send(make_message(Header(stamp=stamp_now()), take_frame()))
        if len(positions) > 5:
            break
    assert len(positions) > 5
    assert max(math.dist(position, TRUE) for position in positions) < 0.05


@pytest.mark.slow
@pytest.mark.parametrize('count', [1, 3])
@pytest.mark.parametrize('spoil', [
    green_lower_half, white_lower_half, black, flat, brightening, half_a_jpeg])
def test_bad_first_pictures_of_a_topic_do_not_become_the_background(ros, spoil, count):
    positions = ros.listen(CAMERA_TOPIC)
    send = play(ros, image_message, '-p', 'source:=topic')
    take_frame = table(empty_s=60.0)
    for number in range(10 if spoil is brightening else count):
        send(image_message(Header(stamp=stamp_now()), spoil(take_frame(), number)))
    check_coin_is_found_and_nothing_else(positions, send, image_message)


@pytest.mark.slow
@pytest.mark.parametrize('name', damaged_frames.DAMAGES)
def test_damaged_first_jpegs_of_a_topic_do_not_become_the_background(ros, name):
    positions = ros.listen(CAMERA_TOPIC)
    send = play(ros, jpeg_message, '-p', 'source:=compressed_topic')
    take_frame = table(empty_s=60.0)
    for _ in range(2):
        jpeg = cv2.imencode('.jpg', take_frame())[1].tobytes()
        send(CompressedImage(header=Header(stamp=stamp_now()), format='jpeg',
                             data=damaged_frames.DAMAGES[name](jpeg)))
    check_coin_is_found_and_nothing_else(positions, send, jpeg_message)


@pytest.mark.slow
def test_camera_that_stays_black_is_told(ros):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    send = play(ros, image_message, '-p', 'source:=topic')
    frame = scenes.still_coin()()
    for number in range(100):
        send(image_message(Header(stamp=stamp_now()), black(frame, number)))
        if statuses and 'black' in statuses[-1].message:
            break
    assert statuses[-1].level > 0 and 'black' in statuses[-1].message
    assert statuses[-1].values['background'] == 'none'
