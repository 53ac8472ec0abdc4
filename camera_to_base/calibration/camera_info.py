# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.


"""Reads a lens's intrinsics from the files of ROS's camera_calibration and camera_info_manager."""

from typing import Any, Mapping

from camera_to_base.checks import finite_numbers
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import load_yaml
from camera_to_base.surface import CameraIntrinsics

DISTORTION_MODELS = ('plumb_bob', 'rational_polynomial')


def read_camera_info(path: str) -> CameraIntrinsics:
    """
    Read a camera_info file.

    :raises InvalidValueError: If there is no such file, or its content is invalid; the message
        names the file, the key and the value.
    """
    _, content = load_yaml(path, 'camera_info file')
    try:
        return _intrinsics(content)
    except InvalidValueError as error:
        raise InvalidValueError(f"'{path}' is no camera_info file: {error}") from error


def _intrinsics(content: Any) -> CameraIntrinsics:
    size = [_value(content, 'image_width'), _value(content, 'image_height')]
    # Older files have no such key; ROS reads them the same way.
    model = content.get('distortion_model', DISTORTION_MODELS[0])
    if model not in DISTORTION_MODELS:
        raise InvalidValueError(
            f'distortion_model must be {" or ".join(DISTORTION_MODELS)}, got {model!r}')
    matrix = finite_numbers('camera_matrix.data', _data(content, 'camera_matrix'), 9)
    return CameraIntrinsics(size, matrix.reshape(3, 3), _data(content, 'distortion_coefficients'))


def _data(content: Any, key: str) -> Any:
    return _value(_value(content, key), 'data', f'{key}.data')


def _value(content: Any, key: str, name: str = '') -> Any:
    if not isinstance(content, Mapping) or key not in content:
        raise InvalidValueError(f'it has no {name or key}')
    return content[key]
