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

from camera_to_base.detection.tutorial.dark_objects import DarkObjects
from camera_to_base.detection.tutorial.dark_squares import DarkSquares
from camera_to_base.detection.tutorial.median import Median
import cv2
import equality
import numpy as np
import pytest

LIMITS = np.full((480, 640), 105, np.uint8)
TABLE = np.full((480, 640, 3), 200, np.uint8)


def frame_with(*centres):
    frame = TABLE.copy()
    for number, centre in enumerate(centres):
        cv2.circle(frame, centre, 25 + 4 * number, (20, 20, 20), -1)
    return frame


@pytest.mark.parametrize('centres', [
    [(100, 100)],
    [(100, 100), (500, 100), (120, 400), (480, 380)],
    [(100, 100), (500, 100), (5, 300), (635, 300)],
    [(0, 0), (639, 0), (0, 479), (639, 479), (320, 0), (320, 479), (300, 250)],
    [(500, 100), (100, 100), (480, 380), (120, 400)],
], ids=['one', 'within', 'at two edges', 'in the corners', 'other sizes'])
def test_outlines_and_their_order_are_those_of_the_whole_picture(centres):
    frame, objects = frame_with(*centres), DarkObjects(LIMITS, 20, Median(5))
    boxes = DarkSquares(LIMITS, 20, 2).boxes(frame)
    assert len(boxes) == len(centres)
    outlines = objects.outlines(frame, boxes)
    expected, _ = cv2.findContours(equality.tutorial_mask(frame, TABLE),
                                   cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    assert len(outlines) == len(expected)
    for outline, other in zip(outlines, expected):
        np.testing.assert_array_equal(outline, other)


def test_a_box_without_an_object_has_no_outline():
    frame = TABLE.copy()
    frame[100:115, 200:400] = 20  # Less high than the closing kernel.
    boxes = DarkSquares(LIMITS, 20, 2).boxes(frame)
    assert len(boxes) == 1 and DarkObjects(LIMITS, 20, Median(5)).outlines(frame, boxes) == []
