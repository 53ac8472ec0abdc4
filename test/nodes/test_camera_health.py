# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import time

from camera_to_base.errors import Level
from camera_to_base.nodes.watch import camera_values, DetectionRate
from camera_to_base.pipeline.pipeline import CameraPipeline
from camera_to_base.pipeline.sighting import Limits
from camera_to_base.sources.kinds import DEVICE, SIMULATED
from camera_to_base.sources.status import ReaderStatus, source_reason
from camera_to_base.surface.models import HomographySurface, ParallelSurface
import cv2
import numpy as np

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
    for frame in frames:
        pipeline.process(frame)
    assert pipeline.reason.kind == 'frame_size'
    return pipeline.reason.sentence


def test_new_background_is_proposed_only_where_it_helps_against_another_picture_size():
    small = cv2.resize(table(), (160, 120))
    assert 'call ~/capture_background' in size_complaint(ParallelSurface(), table(), small)
    complaint = size_complaint(HomographySurface(np.eye(3), (640, 480)), small)
    assert 'calibrate again' in complaint and 'capture_background' not in complaint


# A camera that looks along a road: x = (u - 160) / (v - 112), y = 128 / (v - 112).
ROAD = HomographySurface(np.array([[1, 0, -160], [0, 0, 128], [0, 1, -112]]), (320, 240))
FAR, NEAR = (250, 40), (160, 200)


class Scene:
    """A pipeline that is shown frames, at times that pass as told."""

    def __init__(self, monkeypatch, surface, kind=SIMULATED, **limits):
        self.now = 100.0
        monkeypatch.setattr(time, 'monotonic', lambda: self.now)
        self._pipeline = CameraPipeline(surface, limits=Limits(**limits), kind=kind)
        self.show(*[table()] * (3 if kind.is_live else 1))

    def show(self, *frames, interval_s=0.1, age_s=None):
        for frame in frames:
            self.now += interval_s
            self._pipeline.process(frame, None if age_s is None else self.now - age_s)

    @property
    def reason(self):
        return self._pipeline.reason


def test_objects_beyond_the_horizon_only_are_told_after_a_second(monkeypatch):
    scene = Scene(monkeypatch, ROAD)
    scene.show(*[table(FAR)] * 8)
    assert scene.reason is None
    scene.show(*[table((240, 40))] * 8)
    assert scene.reason.level is Level.WARN
    assert 'no position is published: pixel (' in scene.reason.sentence
    assert 'tilt the camera down' in scene.reason.sentence
    scene.show(table(NEAR))
    assert scene.reason is None


def test_horizon_is_no_problem_while_every_other_frame_is_published(monkeypatch):
    scene = Scene(monkeypatch, ROAD)
    for _ in range(10):
        scene.show(table(FAR), table(NEAR))
        assert scene.reason is None


def test_pictures_of_a_slow_camera_that_are_all_beyond_the_horizon_are_told(monkeypatch):
    scene = Scene(monkeypatch, ROAD)
    scene.show(table(FAR), interval_s=4.0)
    assert scene.reason is None
    scene.show(table(FAR), interval_s=4.0)
    assert 'horizon' in scene.reason.sentence


def test_reasons_that_take_turns_are_told(monkeypatch):
    scene = Scene(monkeypatch, ParallelSurface(36.0, 320), DEVICE, max_frame_age_s=0.3)
    for number in range(30):
        # A jump is not confirmed; the same place again is, but too late.
        scene.show(table((60 + 20 * (number // 2 % 10), 100)), age_s=0.4 if number % 2 else 0.1)
    assert 'no position is published' in scene.reason.sentence


def test_stream_whose_frames_are_all_old_is_told_with_the_cure(monkeypatch):
    now = 100.0
    monkeypatch.setattr(time, 'monotonic', lambda: now)
    reader = ReaderStatus()
    for _ in range(50):
        now += 0.1
        reader._note_frame(now)
        reader._note_age(is_old=True)
    assert source_reason(reader, 'camera').kind == 'old_frames'
    assert source_reason(reader, 'camera').level is Level.ERROR
    assert 'lower its rate' in source_reason(reader, 'camera').sentence
    reader._note_age(is_old=False)
    assert source_reason(reader, 'camera') is None


def test_detection_that_is_always_too_slow_is_told_with_the_cure(monkeypatch):
    scene = Scene(monkeypatch, ParallelSurface(36.0, 320), DEVICE, max_frame_age_s=0.3)
    scene.show(*[table(NEAR)] * 20, age_s=0.2)
    assert scene.reason is None
    scene.show(*[table(NEAR)] * 20, age_s=0.4)
    assert scene.reason.level is Level.WARN
    assert 'detection took too long' in scene.reason.sentence
    assert 'max_frame_age' in scene.reason.sentence


def test_objects_that_no_two_frames_show_alike_are_told_with_the_cure(monkeypatch):
    scene = Scene(monkeypatch, ParallelSurface(36.0, 320), DEVICE)
    places = np.random.default_rng(2).integers((40, 40), (280, 200), (20, 2))
    scene.show(*[table((int(u), int(v))) for u, v in places], age_s=0.0)
    assert scene.reason.level is Level.WARN
    assert 'not confirmed' in scene.reason.sentence and 'threshold' in scene.reason.sentence
    scene.show(*[table(NEAR)] * 2, age_s=0.0)
    assert scene.reason is None


def test_right_size_is_no_problem_any_more_though_nothing_is_on_the_surface(monkeypatch):
    scene = Scene(monkeypatch, ROAD)
    scene.show(cv2.resize(table(), (160, 120)))
    assert scene.reason.kind == 'frame_size'
    scene.show(table(FAR))
    assert scene.reason is None


def test_background_that_cannot_be_taken_is_told_with_the_reason():
    pipeline = CameraPipeline(ParallelSurface(36.0, 320), kind=DEVICE)
    assert pipeline.reason.sentence == (
        'taking the background: keep the surface clear')
    for _ in range(3):
        pipeline.process(np.full((240, 320, 3), 2, np.uint8), time.monotonic())
    assert pipeline.reason.kind == 'background_dark'
    assert pipeline.reason.sentence.startswith('taking the background: the picture is black')
    assert camera_values(None, pipeline)['background'] == 'none'


def test_background_is_told_with_its_age_and_whether_it_is_from_the_file():
    pipeline = CameraPipeline(ParallelSurface(36.0, 320))
    pipeline.restore_background(table(), 75.2)
    assert camera_values(None, pipeline)['background'] == (
        '320 x 240 px, from the file, taken 75 s ago')
    pipeline.capture_background(1)
    pipeline.process(table())
    assert camera_values(None, pipeline)['background'] == '320 x 240 px, taken 0 s ago'
