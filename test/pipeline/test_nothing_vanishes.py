# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Whatever is detected on a frame is published, or it is left out with a reason."""

from camera_to_base.detection import PreciseDifferenceDetector, REASONS
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.surface.models import ParallelSurface
import cv2
import numpy as np
import pytest
from random_day import play, random_day


class Account:
    """Records what the detector finds on each frame, and compares it with what is told of it."""

    def __init__(self, monkeypatch):
        self.frames, self.left_out = 0, 0
        self._detected, self._dropped = [], []
        detect, process = PreciseDifferenceDetector.detect, CameraPipeline.process

        def detected(detector, frame):
            self._detected = detect(detector, frame)
            self._dropped = detector.dropped
            return self._detected

        def processed(pipeline, frame, taken_at=None):
            self._detected, self._dropped = [], []
            sighting = process(pipeline, frame, taken_at)
            self._check(sighting)
            return sighting

        monkeypatch.setattr(PreciseDifferenceDetector, 'detect', detected)
        monkeypatch.setattr(CameraPipeline, 'process', processed)

    def _check(self, sighting):
        told = [*(one.detection for one in sighting.objects),
                *(one.detection for one in sighting.left_out)]
        for one in self._detected:
            assert any(one is other for other in told)
        places = [one.detection.centre for one in sighting.left_out]
        assert all(one.kind in REASONS and one.position in places for one in self._dropped)
        self.frames += bool(self._detected)
        self.left_out += len(sighting.left_out)


@pytest.mark.parametrize('seed', [11, 23, 57])
def test_what_is_detected_on_a_random_day_is_published_or_has_a_reason(monkeypatch, seed):
    account = Account(monkeypatch)
    assert play(random_day(seed))[0] is None
    assert account.frames > 50 and account.left_out


def test_frame_full_of_changes_is_accounted_for(monkeypatch):
    account, random = Account(monkeypatch), np.random.default_rng(6)
    table = random.normal(150, 2, (480, 640, 3))
    pipeline = CameraPipeline(ParallelSurface(36.0))
    pipeline.use_background(np.uint8(table))
    for _ in range(3):
        frame = np.uint8(table)
        for _ in range(300):
            at = tuple(random.integers(0, (640, 480)).tolist())
            cv2.circle(frame, at, int(random.integers(1, 9)), tuple(
                random.integers(0, 255, 3).tolist()), cv2.FILLED)
        sighting = pipeline.process(frame)
    assert account.frames == 3 and sighting.left_out
    assert account.left_out == sum(
        number for name, number in pipeline.counts.items() if name.startswith('left out'))
