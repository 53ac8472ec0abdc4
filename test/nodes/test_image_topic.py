# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from array import array
import threading
import time

from builtin_interfaces.msg import Time
from camera_to_base.nodes.image_topic import ImageTopic
from camera_to_base.nodes.watch import camera_values
from camera_to_base.pipeline.damage import DamageCheck
from camera_to_base.pipeline.pipeline import CameraPipeline
from camera_to_base.sources.status import ReaderState
from camera_to_base.surface.models import ParallelSurface
import cv2
import damaged_frames
import numpy as np
import pytest
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data, QoSProfile, ReliabilityPolicy
from ros_helpers import assert_in_time, Ros
from rosgraph_msgs.msg import Clock
import scenes
from sensor_msgs.msg import CompressedImage, Image

ERROR = 40


class Received:
    """A node with an image topic; what came (frame, taken at, stamp), and when it was given."""

    def __init__(self, ros, *arguments, pause=0.0, **options):
        self.node = ros.add(lambda **others: Node('camera', **others), *arguments)
        self.frames, self.given_at = [], []
        self._pause = pause
        self.topic = ImageTopic(self.node, self._on_frame, **options)

    def _on_frame(self, *frame):
        self.given_at.append(time.monotonic())
        self.frames.append(frame)
        time.sleep(self._pause)

    @property
    def has_failed(self):
        """Tell whether an error is known."""
        return self.topic.error is not None


def driver(ros, message_type=Image, topic='image', qos=qos_profile_sensor_data):
    return ros.node.create_publisher(message_type, topic, qos)


def now(later_s=0.0):
    nanoseconds = time.time_ns() + round(later_s * 1e9)
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


def image(picture, encoding='bgr8', stamp=None):
    message = Image(encoding=encoding, height=picture.shape[0], width=picture.shape[1],
                    step=picture.strides[0], data=array('B', picture.tobytes()))
    message.header.stamp = stamp or now()
    return message


def compressed(content):
    message = CompressedImage(format='jpeg', data=array('B', content))
    message.header.stamp = now()
    return message


def random_picture(channels=3):
    return np.random.default_rng(3).integers(0, 255, (48, 64, channels), np.uint8)


def send_until(ros, publisher, message, condition, timeout=15.0):
    """Send as a driver does, again and again, until a condition holds."""
    return ros.spin_until(lambda: publisher.publish(message) or condition(), timeout)


@pytest.mark.parametrize('encoding, channels, conversion', [
    ('bgr8', 3, None), ('rgb8', 3, cv2.COLOR_RGB2BGR), ('mono8', 1, cv2.COLOR_GRAY2BGR),
    ('yuv422_yuy2', 2, cv2.COLOR_YUV2BGR_YUYV)])
def test_picture_arrives_as_a_frame_with_its_stamp(ros, encoding, channels, conversion):
    received, sent = Received(ros), random_picture(channels)
    message = image(sent, encoding)
    assert send_until(ros, driver(ros), message, lambda: received.frames)
    frame, taken_at, stamp = received.frames[0]
    assert np.array_equal(frame, sent if conversion is None else cv2.cvtColor(sent, conversion))
    assert stamp == message.header.stamp
    age_s = (time.time_ns() - stamp.sec * 10**9 - stamp.nanosec) / 1e9
    assert time.monotonic() - taken_at == pytest.approx(age_s, abs=0.05)
    assert received.topic.state is ReaderState.RUNNING and received.topic.error is None


@pytest.mark.parametrize('ending', ['.png', '.jpg'])
def test_compressed_picture_arrives_as_a_frame_with_its_stamp(ros, ending):
    received = Received(ros, compressed=True)
    content = cv2.imencode(ending, scenes.StillCoin(has_disc=True)())[1]
    publisher = driver(ros, CompressedImage, 'image/compressed')
    message = compressed(content.tobytes())
    assert send_until(ros, publisher, message, lambda: received.frames)
    frame, _, stamp = received.frames[0]
    assert np.array_equal(frame, cv2.imdecode(content, cv2.IMREAD_COLOR))
    assert stamp == message.header.stamp


def test_driver_may_be_reliable(ros):
    received = Received(ros)
    publisher = driver(ros, qos=QoSProfile(depth=5))
    assert send_until(ros, publisher, image(random_picture()), lambda: received.frames)


@pytest.mark.slow
def test_slow_consumer_gets_the_newest_picture_and_the_rest_is_counted_as_replaced(ros):
    received = Received(ros, pause=0.3)
    publisher, sent_at = driver(ros), {}

    def send():
        stamp = Time(sec=len(sent_at))
        sent_at[stamp.sec] = time.monotonic()
        publisher.publish(image(random_picture(), stamp=stamp))

    def send_all():
        while not over.wait(0.02):
            send()

    over, thread = threading.Event(), threading.Thread(target=send_all)
    thread.start()
    try:
        assert ros.spin_until(lambda: len(received.frames) > 8)
    finally:
        over.set()
        thread.join()
    ages = [given_at - sent_at[stamp.sec]
            for given_at, (_, _, stamp) in zip(received.given_at, received.frames)]
    assert np.median(ages) < 0.1
    numbers = [stamp.sec for _, _, stamp in received.frames]
    assert np.median(np.diff(numbers)) >= 10
    assert received.topic.counts.overwritten >= 50


def test_picture_that_had_to_wait_was_taken_when_it_came(ros):
    received, publisher = Received(ros), driver(ros)
    assert send_until(ros, publisher, image(random_picture()), lambda: received.frames)
    ros.spin_for(0.3)
    received.frames.clear()
    publisher.publish(image(random_picture()))
    sent_at = time.monotonic()
    time.sleep(0.5)
    assert ros.spin_until(lambda: received.frames)
    assert received.frames[0][1] == pytest.approx(sent_at, abs=0.1)


@pytest.mark.parametrize('later_s, kind', [
    (-1.7e9, 'stamp_old'), (-2.0, 'stamp_old'), (0.5, 'stamp_ahead'), (1e6, 'stamp_ahead')])
def test_pictures_whose_stamp_is_not_the_time_are_an_error_with_the_cure(ros, later_s, kind):
    received, publisher = Received(ros, max_age_s=0.3), driver(ros)

    def send(later_s):
        publisher.publish(image(random_picture(), stamp=now(later_s)))

    assert ros.spin_until(lambda: send(later_s) or received.topic.reason is not None
                          and received.topic.reason.kind == kind)
    assert 'clocks' in received.topic.reason.sentence
    assert 'use_sim_time' in received.topic.reason.sentence
    assert received.frames == [] and received.topic.counts.old >= 3
    assert ros.spin_until(lambda: send(0.0) or received.frames)
    assert received.topic.reason is None


def test_pictures_without_a_stamp_are_an_error(ros):
    received, publisher = Received(ros, max_age_s=0.3), driver(ros)
    message = image(random_picture())
    message.header.stamp = Time()
    assert send_until(ros, publisher, message, lambda: received.topic.reason is not None
                      and received.topic.reason.kind == 'no_stamp')
    assert received.frames == []


def test_stamps_are_compared_with_the_simulations_clock_where_there_is_one(ros):
    received = Received(ros, '-p', 'use_sim_time:=true', max_age_s=0.3)
    publisher, clock = driver(ros), ros.node.create_publisher(Clock, '/clock', 10)
    message = image(random_picture(), stamp=Time(sec=12, nanosec=900000000))

    def send():
        clock.publish(Clock(clock=Time(sec=13)))
        publisher.publish(message)

    assert ros.spin_until(lambda: send() or received.frames)
    _, taken_at, stamp = received.frames[0]
    assert stamp == message.header.stamp
    assert time.monotonic() - taken_at == pytest.approx(0.1, abs=0.05)


@pytest.mark.slow
def test_unknown_encoding_is_an_error_that_names_it_until_a_good_picture_comes(ros):
    received, publisher = Received(ros), driver(ros)
    lines = ros.listen_to_log('camera')
    bad = image(random_picture(1), 'bayer_rggb8')
    assert send_until(ros, publisher, bad, lambda: received.has_failed and lines)
    assert "on /image: picture encoding 'bayer_rggb8'" in str(received.topic.error)
    assert received.topic.state is ReaderState.WAITING
    assert received.topic.snapshot().damaged_in_a_row == received.topic.counts.damaged > 1
    assert [line.level for line in lines] == [ERROR]  # once in 5 s
    assert 'bayer_rggb8' in lines[0].text and 'bgr8' in lines[0].text
    assert send_until(ros, publisher, image(random_picture()), lambda: received.frames)
    assert received.topic.error is None and received.topic.snapshot().damaged_in_a_row == 0
    assert received.topic.state is ReaderState.RUNNING


def test_single_bad_picture_does_not_lose_the_driver(ros):
    received, publisher = Received(ros), driver(ros)
    good, bad = image(random_picture()), image(random_picture())
    bad.step = 0
    assert send_until(ros, publisher, good, lambda: received.frames)
    assert send_until(ros, publisher, bad, lambda: received.topic.snapshot().damaged_in_a_row)
    assert received.topic.state is ReaderState.RUNNING
    assert 'step' in received.topic.snapshot().last_damage.sentence


@pytest.mark.slow
def test_publisher_whose_reliability_cannot_match_is_an_error_with_the_cure(ros):
    lines = ros.listen_to_log('camera')
    publisher = driver(ros)
    received = Received(ros, '-p', 'qos_overrides./image.subscription.reliability:=reliable')
    assert send_until(ros, publisher, image(random_picture()),
                      lambda: lines and received.has_failed)
    assert [line.level for line in lines] == [ERROR]
    assert ros.spin_until(lambda: str(received.topic.error) == lines[0].text)
    assert '/image: its reliability' in lines[0].text
    assert 'qos_overrides./image.subscription.reliability' in lines[0].text
    assert received.frames == []


@pytest.mark.slow
def test_topic_without_a_publisher_asks_for_the_driver_after_a_second(ros):
    received = Received(ros)
    assert received.topic.error is None and received.topic.state is ReaderState.WAITING
    assert ros.spin_until(lambda: received.has_failed, 2.0)
    assert_in_time(abs(received.topic.snapshot().seconds_without_frame - 1.0), 0.3)
    assert str(received.topic.error) == 'no picture on /image: is the camera driver running?'


@pytest.mark.slow
def test_driver_that_gives_no_picture_is_told_from_one_that_is_not_there(ros):
    driver(ros)
    received = Received(ros)
    assert ros.spin_until(
        lambda: received.has_failed and 'camera plugged in' in str(received.topic.error))


@pytest.mark.slow
def test_topic_that_carries_something_else_is_named(ros):
    other = Ros()
    try:
        driver(other, CompressedImage, 'image')
        received = Received(ros)
        assert ros.spin_until(
            lambda: received.has_failed and 'CompressedImage, not' in str(received.topic.error))
        assert 'compressed_topic' in str(received.topic.error)
        # Another kind, so that it is logged after "is the driver running?".
        assert received.topic.reason.kind == 'topic_type'
    finally:
        other.close()


def states_at_a_rate(ros, received, publisher, period_s, seconds):
    """Send a picture every so often; give each state once that comes after another."""
    states, sent_at = [], 0.0
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if time.monotonic() - sent_at >= period_s:
            sent_at = time.monotonic()
            publisher.publish(image(random_picture()))
        ros.spin_for(0.02)
        if states[-1:] != [received.topic.state]:
            states.append(received.topic.state)
    return states


@pytest.mark.slow
def test_slow_but_regular_topic_is_not_lost_between_its_pictures(ros):
    received, publisher = Received(ros), driver(ros)
    assert send_until(ros, publisher, image(random_picture()), lambda: received.frames)
    states_at_a_rate(ros, received, publisher, 1.4, 4.5)  # it shows its rate
    assert states_at_a_rate(ros, received, publisher, 1.4, 6.0) == [ReaderState.RUNNING]
    assert received.topic.error is None
    seen_at = time.monotonic() - received.topic.snapshot().seconds_without_frame
    assert ros.spin_until(lambda: received.topic.state is ReaderState.LOST, 5.0)
    assert_in_time(abs(time.monotonic() - seen_at - 2.5 * 1.4), 0.3)
    assert received.topic.reason.kind == 'camera_lost'


@pytest.mark.slow
def test_driver_that_ends_is_lost_and_found_when_it_is_back(ros):
    received, publisher = Received(ros), driver(ros)
    assert send_until(ros, publisher, image(random_picture()), lambda: received.frames)
    ros.node.destroy_publisher(publisher)
    assert ros.spin_until(lambda: received.topic.state is ReaderState.LOST, 2.0)
    assert ros.spin_until(lambda: 'is the camera driver running' in str(received.topic.error))
    pipeline = CameraPipeline(ParallelSurface(36.0, 640))
    assert received.topic.reason.sentence == (
        'nothing is published: no picture on /image: is the camera driver running?')
    publisher, count = driver(ros), len(received.frames)
    assert send_until(
        ros, publisher, image(random_picture()), lambda: len(received.frames) > count)
    assert received.topic.state is ReaderState.RUNNING
    assert camera_values(received.topic, pipeline)['reconnects'] == '1'


@pytest.mark.parametrize('spoil, complaint', [
    (damaged_frames.cut_in_half, 'was cut off'), (damaged_frames.noise, 'expected a JPEG or PNG'),
    (damaged_frames.half_grey, 'its lower end has one colour')])
def test_damaged_jpeg_is_counted_and_never_given(ros, spoil, complaint):
    received = Received(ros, compressed=True, damage=DamageCheck().reason)
    publisher = driver(ros, CompressedImage, 'image/compressed')
    take_frame = scenes.StillCoin(has_disc=True)

    def content():
        return cv2.imencode('.jpg', take_frame())[1].tobytes()

    assert ros.spin_until(
        lambda: publisher.publish(compressed(content())) or len(received.frames) > 2)
    ros.spin_for(0.3)
    good, before = len(received.frames), received.topic.counts.damaged
    assert ros.spin_until(lambda: publisher.publish(compressed(spoil(content())))
                          or received.topic.counts.damaged > before + 2)
    assert complaint in received.topic.snapshot().last_damage.sentence
    assert len(received.frames) == good


@pytest.mark.parametrize('reliability', [
    ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT])
@pytest.mark.parametrize('driver_is_first', [True, False])
def test_subscription_is_as_reliable_as_the_driver(ros, reliability, driver_is_first):
    def make_driver():
        return driver(ros, qos=QoSProfile(depth=1, reliability=reliability))

    first = make_driver() if driver_is_first else None
    received = Received(ros)
    publisher = first or make_driver()
    message = image(random_picture())
    assert send_until(ros, publisher, message, lambda: received.frames)
    info, = received.node.get_subscriptions_info_by_topic('/image')
    assert info.qos_profile.reliability == reliability
    assert not received.has_failed


def test_driver_that_is_not_reliable_any_more_is_received_again(ros):
    received = Received(ros)
    message = image(random_picture())
    reliable = driver(ros, qos=QoSProfile(depth=1))
    assert send_until(ros, reliable, message, lambda: received.frames)
    ros.node.destroy_publisher(reliable)
    received.frames.clear()
    assert send_until(ros, driver(ros), message, lambda: received.frames)


def test_topic_is_remapped_and_its_reliability_can_be_chosen(ros):
    name = 'qos_overrides./cell/usb_cam/image_raw.subscription.reliability'
    received = Received(ros, '-r', '__ns:=/cell', '-r', 'image:=usb_cam/image_raw',
                        '-p', f'{name}:=best_effort')
    assert received.topic.topic_name == '/cell/usb_cam/image_raw'
    qos = received.node.get_subscriptions_info_by_topic('/cell/usb_cam/image_raw')[0].qos_profile
    assert qos.reliability == ReliabilityPolicy.BEST_EFFORT
    assert [name for name in received.node.list_parameters([], 0).names
            if name.startswith('qos_overrides./cell')] == [name]


def test_closed_topic_gives_no_more_frames(ros):
    received, publisher = Received(ros), driver(ros)
    assert send_until(ros, publisher, image(random_picture()), lambda: received.frames)
    received.topic.close()
    count, until = len(received.frames), time.monotonic() + 0.5
    assert send_until(ros, publisher, image(random_picture()), lambda: time.monotonic() > until)
    assert len(received.frames) == count
