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

import time

from camera_to_base.camera_health import camera_problem, DetectionRate
from camera_to_base.camera_pipeline import CameraPipeline
from camera_to_base.errors import FrameSizeError
from camera_to_base.surface import HomographySurface, ParallelSurface
import cv2
import numpy as np
import pytest

RATE, WITH_OBJECT = 'detection rate (frames/s)', 'frames with an object (1/s)'


def table(disc=None):
    frame = np.full((240, 320, 3), 200, np.uint8)
    return frame if disc is None else cv2.circle(frame, disc, 20, (40, 40, 40), -1)


def test_detection_rate_is_that_since_the_last_look(monkeypatch):
    now = 100.0
    monkeypatch.setattr(time, 'monotonic', lambda: now)
    pipeline, rate = CameraPipeline(ParallelSurface(36.0, 320)), DetectionRate()
    for frame in (table(), table((100, 100)), table((110, 100)), table()):
        pipeline.process(frame)
    now = 102.0
    assert rate.values(pipeline) == {RATE: '2.0', WITH_OBJECT: '1.0'}
    pipeline.process(table((100, 100)))
    now = 103.0
    assert rate.values(pipeline) == {RATE: '1.0', WITH_OBJECT: '1.0'}
    now = 104.0
    assert rate.values(pipeline) == {RATE: '0.0', WITH_OBJECT: '0.0'}


def size_complaint(surface, *frames):
    pipeline = CameraPipeline(surface)
    with pytest.raises(FrameSizeError):
        for frame in frames:
            pipeline.process(frame)
    return camera_problem(None, pipeline, 'camera').sentence


def test_new_background_is_proposed_only_where_it_helps_against_another_picture_size():
    small = cv2.resize(table(), (160, 120))
    assert 'call ~/capture_background' in size_complaint(ParallelSurface(), table(), small)
    complaint = size_complaint(HomographySurface(np.eye(3), (640, 480)), small)
    assert 'calibrate again' in complaint and 'capture_background' not in complaint
