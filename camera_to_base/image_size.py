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

"""The size of a picture: width and height, in px."""

from typing import Sequence, Tuple

from camera_to_base.checks import finite_numbers, whole_number

ImageSize = Tuple[int, int]

# The picture size of the tutorial's camera.
DEFAULT_IMAGE_SIZE: ImageSize = (640, 480)
LARGEST_SIDE = 10000


def check_image_size(image_size: Sequence[int]) -> ImageSize:
    """
    Check a picture size.

    :returns: Width and height, in px.
    :raises InvalidValueError: If it is not two whole numbers from 1 to `LARGEST_SIDE`.
    """
    width, height = finite_numbers('image_size', image_size, 2)
    return (whole_number("image_size's width", width, 1, LARGEST_SIDE),
            whole_number("image_size's height", height, 1, LARGEST_SIDE))
