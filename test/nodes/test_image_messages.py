# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.nodes.outputs import image_message, jpeg_message
import cv2
import numpy as np
import pytest
from std_msgs.msg import Header

HEADER = Header(frame_id='camera_surface')


@pytest.mark.parametrize('shape, encoding', [((5, 7, 3), 'bgr8'), ((5, 7), 'mono8')])
def test_picture_becomes_an_image_message(shape, encoding):
    picture = np.random.default_rng(1).integers(0, 256, shape, np.uint8)
    message = image_message(HEADER, picture)
    assert (message.height, message.width, message.encoding) == (5, 7, encoding)
    assert message.step == len(message.data) / 5
    assert (np.frombuffer(message.data, np.uint8).reshape(shape) == picture).all()


def test_picture_becomes_a_jpeg_message():
    picture = cv2.circle(np.full((48, 64, 3), 200, np.uint8), (30, 20), 10, (20, 30, 40), -1)
    message = jpeg_message(HEADER, picture)
    assert message.format == 'jpeg' and message.header == HEADER
    decoded = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)
    assert np.abs(decoded.astype(int) - picture).mean() < 3
