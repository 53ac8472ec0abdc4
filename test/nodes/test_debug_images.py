# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.drawing.pictures import draw_note
from camera_to_base.nodes import outputs as debug_images
from camera_to_base.nodes.camera_publisher import CameraPublisher
import cv2
import numpy as np
import pytest
from ros_helpers import CAMERA_TOPIC
from sensor_msgs.msg import CompressedImage, Image

SIMULATED = ('-p', 'source:=simulated', '-p', 'simulated.frame_rate:=20.0')


@pytest.fixture
def drawn(monkeypatch):
    """Count what is drawn and encoded, while it is."""
    calls = []
    for name in ('draw_objects', 'draw_note', 'object_mask', 'image_message', 'jpeg_message'):
        original = getattr(debug_images, name)
        monkeypatch.setattr(
            debug_images, name,
            lambda *arguments, name=name, original=original: (
                calls.append(name), original(*arguments))[1])
    return calls


def picture_of(message):
    channels = 3 if message.encoding == 'bgr8' else 1
    return np.frombuffer(message.data, np.uint8).reshape(
        message.height, message.width, channels)


def test_nothing_is_drawn_while_nobody_looks(ros, drawn):
    positions = ros.listen(CAMERA_TOPIC)
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: len(positions) >= 10)
    assert drawn == []


def test_only_what_somebody_looks_at_is_encoded(ros, drawn):
    received = ros.listen_to(CompressedImage, '/debug_image/compressed')
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: len(received) >= 3)
    assert set(drawn) == {'draw_objects', 'draw_note', 'jpeg_message'}
    jpeg = cv2.imdecode(np.frombuffer(received[-1].data, np.uint8), cv2.IMREAD_COLOR)
    assert jpeg.shape == (480, 640, 3)


@pytest.mark.slow
def test_drawing_ends_when_the_last_one_looks_away(ros, drawn):
    received = ros.listen_to(Image, '/debug_image')
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: received)
    ros.stop_listening('/debug_image')
    ros.spin_for(0.5)
    drawn.clear()
    ros.spin_for(0.5)
    assert drawn == []


def test_debug_image_shows_outline_box_and_position_and_keeps_the_stamp(ros):
    images = ros.listen_to(Image, '/debug_image')
    masks = ros.listen_to(Image, '/mask')
    ros.add(CameraPublisher, *SIMULATED)
    assert ros.spin_until(lambda: len(images) >= 10 and len(masks) >= 10)
    mask = masks[-1]
    image = next((image for image in images if image.header == mask.header), None)
    assert image is not None and image.header.frame_id == 'camera_surface'
    inside = picture_of(mask)[:, :, 0] == 255
    assert 1000 < np.count_nonzero(inside) < 2000  # a coin of 2.4 cm is 43 px wide
    rows, columns = np.nonzero(inside)
    around = picture_of(image)[rows.min() - 1:rows.max() + 2, columns.min() - 1:columns.max() + 2]
    box_colour = np.array([36, 200, 36])
    assert np.count_nonzero((around == box_colour).all(axis=2)) > 2 * len(around)


@pytest.mark.parametrize('coordinates', ['camera', 'base'])
def test_coordinates_are_those_of_the_frame_that_the_parameter_names(
        ros, monkeypatch, coordinates):
    labels = []
    draw = debug_images.draw_objects

    def draw_and_keep(frame, objects, label):
        labels.extend(label(found.point) for found in objects)
        return draw(frame, objects, label)

    monkeypatch.setattr(debug_images, 'draw_objects', draw_and_keep)
    positions, _ = ros.listen(CAMERA_TOPIC), ros.listen_to(Image, '/debug_image')
    ros.add(CameraPublisher, *SIMULATED, '-p', f'debug_image.coordinates:={coordinates}')
    assert ros.spin_until(lambda: len(labels) > 3 and len(positions) > 3)
    texts = [f'x {x:.2f}, y {y:.2f} cm' if coordinates == 'camera'
             else f'base x {x - 17.8:.2f}, y {24.4 - y:.2f} cm' for x, y in positions]
    assert set(labels) & set(texts)


@pytest.mark.parametrize('arguments, notes', [
    ((), [f'background taken {age} s ago' for age in range(30)]),
    (('-p', 'background_frames:=1000'), ['taking the background: keep the surface clear'])])
def test_state_of_the_background_is_written_on_the_debug_image(ros, arguments, notes):
    images = ros.listen_to(Image, '/debug_image')
    ros.add(CameraPublisher, *SIMULATED, *arguments)
    assert ros.spin_until(lambda: images)
    picture = picture_of(images[-1])

    def shows(note):
        # On a patch of its own: what is there already changes nothing when it is written again.
        again = picture.copy()
        draw_note(again, note)
        return np.array_equal(again, picture)

    assert any(map(shows, notes))
