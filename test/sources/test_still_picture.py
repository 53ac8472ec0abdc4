# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.errors import FrameSourceError
from camera_to_base.sources import median_frame
from camera_to_base.sources.kinds import DEVICE, VIDEO_FILE
import numpy as np
import pytest


class Counting:
    """Gives frames whose pixels are their number, 0 first; ends after so many."""

    def __init__(self, kind, length=100):
        self.kind = kind
        self.count = 0
        self._length = length

    def read(self):
        if self.count == self._length:
            return None
        self.count += 1
        return np.full((2, 3, 3), self.count - 1, np.uint8)


def test_of_a_camera_the_first_10_frames_are_left_out_and_the_next_9_are_used():
    camera = Counting(DEVICE)
    assert (median_frame(camera) == 14).all()
    assert camera.count == 19


def test_of_a_video_the_first_9_frames_are_used():
    video = Counting(VIDEO_FILE)
    assert (median_frame(video) == 4).all()
    assert video.count == 9


def test_a_shorter_video_is_used_as_far_as_it_goes():
    assert (median_frame(Counting(VIDEO_FILE, length=3)) == 1).all()


def test_a_video_without_frames_is_an_error():
    with pytest.raises(FrameSourceError, match='has ended before its first frame'):
        median_frame(Counting(VIDEO_FILE, length=0))
