# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Checks values and frames where they enter the package, and the size of a picture in px."""

from typing import Any, Sequence, Tuple

from camera_to_base.errors import FrameSizeError, InvalidValueError
import numpy as np

ImageSize = Tuple[int, int]

# The picture size of the tutorial's camera.
DEFAULT_IMAGE_SIZE: ImageSize = (640, 480)
LARGEST_SIDE = 10000


def finite_numbers(name: str, values: Any, *shape: int) -> np.ndarray:
    """
    Check an array of numbers.

    :param name: Its name in the error.
    :param shape: The required shape; -1 allows any length.
    :returns: A copy, of float.
    :raises InvalidValueError: If the shape differs, or an element is not a finite number.
    """
    try:
        numbers = np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InvalidValueError(f'{name} must be numbers of shape {_text(shape)}, got {values!r}')
    if len(numbers.shape) != len(shape) or any(
            length not in (-1, found) for length, found in zip(shape, numbers.shape)):
        raise InvalidValueError(f'{name} must be of shape {_text(shape)}, got shape '
                                f'{numbers.shape}: {_short(numbers)}')
    if not np.isfinite(numbers).all():
        raise InvalidValueError(f'{name} must be finite numbers, got {_short(numbers)}')
    return numbers


def frame_id(name: str, value: str) -> str:
    """
    Check the name of a coordinate frame.

    :raises InvalidValueError: If tf2 would refuse it.
    """
    if not value or value.startswith('/'):
        raise InvalidValueError(
            f"{name} must be a frame's name as tf2 takes it, without a leading /, got '{value}'")
    return value


def finite_number(name: str, value: Any, lowest: float, highest: float) -> float:
    """
    Check a number.

    :raises InvalidValueError: If it is no number, or outside lowest..highest.
    """
    number = float(finite_numbers(name, value))
    if not lowest <= number <= highest:
        raise InvalidValueError(f'{name} must be {lowest:g}..{highest:g}, got {value}')
    return number


def whole_number(name: str, value: Any, lowest: int, highest: int) -> int:
    """
    Check a whole number.

    :raises InvalidValueError: If it is no whole number, or outside lowest..highest.
    """
    number = finite_number(name, value, lowest, highest)
    if number != int(number):
        raise InvalidValueError(f'{name} must be a whole number, got {value}')
    return int(number)


def _text(shape: Tuple[int, ...]) -> str:
    return f'({", ".join("n" if length == -1 else str(length) for length in shape)})'


def _short(numbers: np.ndarray) -> str:
    return np.array2string(numbers, threshold=20, separator=', ')


def check_image_size(image_size: Sequence[int]) -> ImageSize:
    """
    Check a picture size.

    :returns: Width and height, in px.
    :raises InvalidValueError: If it is not two whole numbers from 1 to `LARGEST_SIDE`.
    """
    width, height = finite_numbers('image_size', image_size, 2)
    return (whole_number("image_size's width", width, 1, LARGEST_SIDE),
            whole_number("image_size's height", height, 1, LARGEST_SIDE))


def check_frame(frame: np.ndarray, name: str = 'frame') -> None:
    """
    Check that an array is a colour picture.

    :raises InvalidValueError: If it is not an array of shape (h, w, 3), uint8, with pixels in it.
    """
    if not isinstance(frame, np.ndarray) or frame.ndim != 3 or frame.shape[2] != 3:
        raise InvalidValueError(
            f'expected a {name} of shape (h, w, 3), got {getattr(frame, "shape", type(frame))}')
    if frame.dtype != np.uint8 or frame.size == 0:
        raise InvalidValueError(
            f'expected a {name} of uint8 with pixels in it, got {frame.dtype} {frame.shape}')


def check_same_size(frame: np.ndarray, background: np.ndarray) -> None:
    """
    Check that a frame can be compared with a background.

    :raises FrameSizeError: If its size is not the background's.
    :raises InvalidValueError: If it is not a colour picture.
    """
    check_frame(frame)
    if frame.shape[:2] != background.shape[:2]:
        raise FrameSizeError(
            f'the frame is {_size_text(frame)}, but the background is {_size_text(background)}: '
            'use one picture size')


def _size_text(picture: np.ndarray) -> str:
    return f'{picture.shape[1]} x {picture.shape[0]} px'
