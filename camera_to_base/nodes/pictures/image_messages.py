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

"""Conversion of pictures to ROS messages; `sources/decoding.py` has the opposite direction."""

from array import array

import cv2
import numpy as np
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header


def image_message(header: Header, picture: np.ndarray) -> Image:
    """
    Make an image message.

    :param picture: Shape (h, w, 3), BGR, or (h, w); uint8.
    """
    height, width = picture.shape[:2]
    colour = picture.ndim == 3
    # rclpy copies any other type than array.array byte by byte, which is slow.
    return Image(header=header, height=height, width=width,
                 encoding='bgr8' if colour else 'mono8',
                 step=width * (3 if colour else 1), data=array('B', picture.tobytes()))


def jpeg_message(header: Header, picture: np.ndarray) -> CompressedImage:
    """
    Make a message with a JPEG picture, of OpenCV's usual quality of 95.

    :param picture: Shape (h, w, 3), uint8, BGR.
    """
    jpeg = cv2.imencode('.jpg', picture)[1].tobytes()
    return CompressedImage(header=header, format='jpeg', data=array('B', jpeg))


def png_message(header: Header, picture: np.ndarray) -> CompressedImage:
    """
    Make a message with a PNG picture, which loses nothing.

    :param picture: Shape (h, w, 3), BGR, or (h, w); uint8.
    """
    png = cv2.imencode('.png', picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])[1].tobytes()
    return CompressedImage(header=header, format='png', data=array('B', png))
