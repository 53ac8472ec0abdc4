# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Converts the pictures of camera drivers, raw or compressed, to frames: uint8, BGR."""

from typing import Any, NamedTuple, Optional

from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

_JPEG_START, _JPEG_SCAN, _JPEG_END = b'\xff\xd8\xff', b'\xff\xda', b'\xff\xd9'
_PNG_START, _PNG_END = b'\x89PNG\r\n\x1a\n', b'IEND\xaeB`\x82'


class _Layout(NamedTuple):
    """The bytes of a pixel, and OpenCV's code for their conversion to BGR."""

    bytes_per_pixel: int
    conversion: Optional[int] = None


_BGR = _Layout(3)
_BGRA = _Layout(4, cv2.COLOR_BGRA2BGR)
_GREY = _Layout(1, cv2.COLOR_GRAY2BGR)
_GREY_16 = _Layout(2, cv2.COLOR_GRAY2BGR)
_UYVY = _Layout(2, cv2.COLOR_YUV2BGR_UYVY)
_YUYV = _Layout(2, cv2.COLOR_YUV2BGR_YUYV)
# The names that sensor_msgs/image_encodings.hpp defines.
_LAYOUTS = {
    'bgr8': _BGR, '8UC3': _BGR,
    'rgb8': _Layout(3, cv2.COLOR_RGB2BGR),
    'bgra8': _BGRA, '8UC4': _BGRA,
    'rgba8': _Layout(4, cv2.COLOR_RGBA2BGR),
    'mono8': _GREY, '8UC1': _GREY,
    'mono16': _GREY_16, '16UC1': _GREY_16,
    'uyvy': _UYVY, 'yuv422': _UYVY,
    'yuyv': _YUYV, 'yuv422_yuy2': _YUYV,
}
ENCODINGS = tuple(_LAYOUTS)


def frame_from_image_message(message: Any) -> np.ndarray:
    """
    Convert a picture to a frame, see :func:`decode_image`; it may share the message's memory.

    :param message: A sensor_msgs/Image, from ROS or from a bag reader.
    :returns: Shape (h, w, 3), uint8, BGR.
    :raises InvalidValueError: If it cannot be used.
    """
    return decode_image(message.encoding, message.width, message.height, message.step,
                        bool(message.is_bigendian), message.data)


def frame_from_compressed_message(message: Any) -> np.ndarray:
    """
    Convert a compressed picture to a frame, see :func:`decode_compressed`.

    :param message: A sensor_msgs/CompressedImage, from ROS or from a bag reader.
    :returns: Shape (h, w, 3), uint8, BGR.
    :raises InvalidValueError: If it cannot be used.
    """
    return decode_compressed(message.data, message.format)


def decode_image(
    encoding: str, width: int, height: int, step: int, is_bigendian: bool, data: Any
) -> np.ndarray:
    """
    Convert an uncompressed picture to a frame.

    bgr8 without padding is not copied: such a frame shares its memory with `data`, and is
    read-only if `data` is.

    :param encoding: One of ENCODINGS, as sensor_msgs/Image names them.
    :param width: In px.
    :param height: In px.
    :param step: Bytes from one row to the next.
    :param is_bigendian: Whether the high byte of a 16-bit pixel comes first; only the high byte
        is used.
    :param data: Bytes, or anything else that has a buffer of them.
    :returns: Shape (height, width, 3), uint8, BGR.
    :raises InvalidValueError: If the encoding is not supported, or the sizes do not match.
    """
    layout = _LAYOUTS.get(encoding)
    if layout is None:
        raise InvalidValueError(
            f'picture encoding {encoding[:40]!r} is not known: let the camera driver send one '
            f'of {", ".join(ENCODINGS)}')
    if layout in (_UYVY, _YUYV) and width % 2:
        raise InvalidValueError(
            f'a picture of encoding {encoding} must have an even width, got {width} px: choose '
            'another size in the camera driver')
    pixels = _pixels(width, height, step, layout.bytes_per_pixel, data)
    if layout is _GREY_16:
        pixels = np.ascontiguousarray(pixels[..., 0 if is_bigendian else 1])
    if layout.conversion is None:
        return np.ascontiguousarray(pixels)
    return cv2.cvtColor(pixels, layout.conversion)


def decode_compressed(data: Any, format_name: str = '') -> np.ndarray:
    """
    Convert a JPEG or PNG picture to a frame; grey, 16-bit and transparent ones become BGR, too.

    :param data: Bytes, or anything else that has a buffer of them.
    :param format_name: The sender's name of the format, for the error only.
    :returns: Shape (h, w, 3), uint8, BGR.
    :raises InvalidValueError: If it is no such picture, or not a whole one.
    """
    content = bytes(data)
    if not content.startswith((_JPEG_START, _PNG_START)):
        raise InvalidValueError(
            f'expected a JPEG or PNG picture, got {len(content)} bytes of format '
            f'{format_name[:40]!r}: choose jpeg or png in the camera driver')
    if not _has_end(content):
        raise InvalidValueError(
            f'the compressed picture of {len(content)} bytes was cut off: check the camera and '
            'its network')
    try:
        # As it is stored: a calibration is made of pictures without their EXIF orientation.
        frame = cv2.imdecode(np.frombuffer(content, np.uint8),
                             cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error:
        frame = None  # for example a size above OpenCV's limit
    if frame is None:
        raise InvalidValueError(
            f'the compressed picture of {len(content)} bytes is damaged: check the camera and '
            'its network')
    return frame


def _pixels(width: int, height: int, step: int, bytes_per_pixel: int, data: Any) -> np.ndarray:
    # A view of shape (height, width, bytes_per_pixel).
    if width <= 0 or height <= 0:
        raise InvalidValueError(
            f'a picture of {width} x {height} px is empty: choose another size in the camera '
            'driver')
    row_bytes = width * bytes_per_pixel
    if step < row_bytes:
        raise InvalidValueError(
            f'a row of {width} px at {bytes_per_pixel} byte(s) needs a step of {row_bytes} bytes '
            f'or more, got {step}: check the encoding and size that the camera driver sends')
    content = memoryview(data).cast('B')
    if len(content) < height * step:
        raise InvalidValueError(
            f'{height} rows of {step} bytes need {height * step} bytes, got {len(content)}: '
            'check the encoding and size that the camera driver sends')
    rows = np.frombuffer(content, np.uint8, height * step).reshape(height, step)
    return rows[:, :row_bytes].reshape(height, width, bytes_per_pixel)


def _has_end(content: bytes) -> bool:
    # OpenCV 4.6 fills the missing part of a cut JPEG with uninitialised memory, and returns it.
    # Neither marker can occur in the data of a scan; a thumbnail has both, but before the scan.
    if content.startswith(_PNG_START):
        return _PNG_END in content
    return content.rfind(_JPEG_END) > content.rfind(_JPEG_SCAN)
