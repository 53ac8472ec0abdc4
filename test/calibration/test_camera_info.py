# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Intrinsics from a file, as ROS's camera_calibration writes it."""

import re

from camera_to_base.calibration.tables import read_camera_info
from camera_to_base.errors import InvalidValueError
import pytest

USABLE = """\
image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [532.5, 0, 320.1, 0, 533.25, 239.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 6e-2, -1e-05, 0, 0.09]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [480.0, 0, 320.0, 0, 0, 480.0, 240.0, 0, 0, 0, 1, 0]
"""


@pytest.fixture
def read(tmp_path):
    def read_text(text):
        path = tmp_path / 'camera_info.yaml'
        path.write_text(text)
        return read_camera_info(str(path))
    return read_text


def test_file_of_the_camera_calibration_is_read(read):
    intrinsics = read(USABLE)
    assert intrinsics.image_size == (640, 480)
    assert intrinsics.matrix.tolist() == [[532.5, 0, 320.1], [0, 533.25, 239.5], [0, 0, 1]]
    # 1e-05 is what YAML takes for a text, and C++ for a number.
    assert intrinsics.coefficients == (-0.28, 0.06, -1e-5, 0, 0.09)


def test_rational_polynomial_has_eight_numbers(read):
    text = USABLE.replace('plumb_bob', 'rational_polynomial').replace('0.09]', '0.09, 1, 2, 3]')
    assert read(text).coefficients[5:] == (1, 2, 3)


def test_file_without_a_distortion_model_is_plumb_bob_as_in_ros(read):
    assert len(read(USABLE.replace('distortion_model: plumb_bob\n', '')).coefficients) == 5


@pytest.mark.parametrize('old, new, said', [
    (USABLE, '', 'it has no image_width'),
    (USABLE, 'text', 'it has no image_width'),
    (USABLE, '[1, 2]', 'it has no image_width'),
    (USABLE, 'a: [1', 'is no YAML'),
    (USABLE, '/**: {ros__parameters: {surface: {model: homography}}}', 'it has no image_width'),
    ('image_height: 480\n', '', 'it has no image_height'),
    ('image_width: 640', 'image_width: 0', "image_size's width must be 1..10000"),
    ('image_width: 640', 'image_width: wide', 'image_size must be numbers'),
    ('camera_matrix:', 'matrix:', 'it has no camera_matrix'),
    ('  data: [532.5', '  numbers: [532.5', 'it has no camera_matrix.data'),
    (', 0, 0, 1]\ndist', ', 0, 0]\ndist', r'camera_matrix.data must be of shape \(9\)'),
    ('532.5', '.nan', 'camera_matrix.data must be finite'),
    ('532.5', '0', 'needs fx and fy above 0, got'),
    ('532.5, 0, 320.1, 0, 533.25, 239.5, 0, 0, 1', '532.5, 0, 0, 0, 533.25, 0, 320.1, 239.5, 1',
     r'must be \[fx, 0, cx, 0, fy, cy, 0, 0, 1\]'),
    ('plumb_bob', 'thin_prism', "one of plumb_bob, rational_polynomial, .*got 'thin_prism'"),
    ('plumb_bob', 'equidistant', 'equidistant has 4 distortion_coefficients, got 5'),
    ('plumb_bob', '[1]', r'got \[1\]'),
    ('[-0.28, 6e-2, -1e-05, 0, 0.09]', '[1, 2, 3]',
     'plumb_bob has 4 or 5 distortion_coefficients, got 3'),
    ('-0.28', '.inf', 'distortion_coefficients must be finite'),
    ('[-0.28, 6e-2, -1e-05, 0, 0.09]', 'none', 'distortion_coefficients must be numbers'),
])
def test_file_that_cannot_be_used_is_one_sentence(read, old, new, said):
    assert old in USABLE
    with pytest.raises(InvalidValueError) as error:
        read(USABLE.replace(old, new, 1))
    assert 'camera_info.yaml' in str(error.value) and '\n' not in str(error.value)
    assert re.search(said, str(error.value)), error.value


def test_file_that_is_not_there_is_named():
    with pytest.raises(InvalidValueError, match="cannot read the camera_info file 'none.yaml'"):
        read_camera_info('none.yaml')
