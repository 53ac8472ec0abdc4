# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import os
import time

from camera_to_base.errors import CameraToBaseError
from camera_to_base.pipeline.damage import DamageCheck
from camera_to_base.pipeline.own_camera import OwnCamera
from camera_to_base.pipeline.pipeline import CameraPipeline
from camera_to_base.pipeline.sighting import Limits, Sighting
from camera_to_base.sources.kinds import DEVICE, SIMULATED, VIDEO_FILE
from camera_to_base.surface.models import ParallelSurface
from camera_to_base.surface.thumbnail import read_thumbnail, view_thumbnail
import cv2
import numpy as np
import pytest

# ENDURANCE=1000000 makes a longer run.
FRAMES = int(os.environ.get('ENDURANCE', '10000'))
AT_ONCE = Limits(confirm_jump_px=0.0)


def table(move=(0, 0), disc=None, size=(640, 480)):
    random = np.random.default_rng(1)
    field = cv2.GaussianBlur(random.normal(0, 60, (size[1] + 80, size[0] + 80)), (0, 0), 4)
    grey = np.clip(190 + field, 110, 250).astype(np.uint8)
    left, top = 40 - move[0], 40 - move[1]
    frame = cv2.merge([grey[top:top + size[1], left:left + size[0]]] * 3)
    if disc is not None:
        cv2.circle(frame, disc, 22, (30, 30, 30), -1)
    return frame


def pipeline(limits=AT_ONCE, background_frames=1, kind=SIMULATED):
    return CameraPipeline(ParallelSurface(36.0, 640), limits=limits,
                          background_frames=background_frames, kind=kind)


def published(camera, frame, taken_at=None):
    sighting = camera.process(frame, taken_at)
    return sighting.objects if sighting.reason is None else []


def test_first_frame_is_the_background_and_an_object_is_located():
    camera = pipeline()
    assert not published(camera, table())
    located, = camera.process(table(disc=(320, 240))).objects
    assert located.point == pytest.approx((18.0, 13.5), abs=0.12)


def test_background_is_the_median_of_as_many_frames_as_were_asked_for():
    camera = pipeline(background_frames=3)
    for disc in ((100, 100), (300, 300), None):
        assert camera.background is None
        assert not published(camera, table(disc=disc))
    assert (camera.background == table()).all()


def test_no_object_is_believed_while_the_view_has_moved_and_it_is_again_when_it_is_back():
    camera = pipeline()
    camera.process(table())
    assert published(camera, table(disc=(320, 240)))
    assert not published(camera, table(move=(6, 0), disc=(320, 240)))
    assert camera.reason.kind == 'view_moved'
    assert '6.' in camera.reason.sentence or '5.9' in camera.reason.sentence
    assert published(camera, table(disc=(320, 240)))
    assert camera.reason is None


def test_background_taken_anew_makes_a_moved_view_the_right_one():
    camera = pipeline()
    camera.process(table())
    assert not published(camera, table(move=(6, 0), disc=(320, 240)))
    camera.capture_background(1)
    assert not published(camera, table(move=(6, 0)))
    assert published(camera, table(move=(6, 0), disc=(320, 240)))


def test_view_is_compared_with_a_restored_background_from_the_first_frame_on():
    camera = pipeline()
    camera.restore_background(table(), age_s=10.0)
    assert camera.backgrounds.current.age_s == pytest.approx(10.0, abs=1.0)
    assert not published(camera, table(move=(6, 0), disc=(320, 240)))
    camera.restore_background(table(), age_s=10.0)
    assert published(camera, table(disc=(320, 240)))


def test_background_of_a_camera_is_confirmed_and_that_of_a_file_is_its_first_frame():
    camera, recording, lost = pipeline(kind=DEVICE), pipeline(kind=VIDEO_FILE), table()
    lost[240:] = 255
    for frame in (lost, table(), table()):
        camera.process(frame, time.monotonic())
        recording.process(frame)
    assert (camera.background == table()).all()
    assert (recording.background == lost).all()


def test_check_of_the_view_can_be_switched_off():
    camera = pipeline(AT_ONCE._replace(max_shift_px=0.0))
    camera.process(table())
    assert published(camera, table(move=(6, 0), disc=(320, 240)))


def test_frame_of_another_size_is_a_reason_until_the_old_size_is_back():
    camera = pipeline()
    camera.process(table())
    reason = camera.process(table(size=(320, 240))).reason
    assert reason.kind == 'frame_size' and '320 x 240' in reason.sentence
    assert camera.reason == reason
    assert published(camera, table(disc=(320, 240)))
    assert camera.reason is None


def test_position_from_an_old_frame_is_held_back():
    camera = pipeline(AT_ONCE._replace(max_shift_px=0.0), kind=DEVICE)
    for _ in range(2):
        camera.process(table())
    assert not published(camera, table(disc=(320, 240)), time.monotonic() - 0.31)
    assert published(camera, table(disc=(320, 240)), time.monotonic() - 0.1)
    assert camera.counts['frames held back: too_late'] == 1


def test_moved_view_of_a_recording_holds_its_frames_back():
    recording = pipeline(Limits(correct_up_to_px=0.0), kind=VIDEO_FILE)
    recording.process(table(), 0.0)
    assert published(recording, table(disc=(320, 240)), 0.04)
    assert not published(recording, table(move=(6, 0), disc=(320, 240)), 0.08)
    assert recording.reason.kind == 'view_moved'


def test_position_that_jumps_is_confirmed_for_cameras_only():
    camera = pipeline(Limits(), kind=DEVICE)
    for _ in range(3):
        camera.process(table())
    assert not published(camera, table(disc=(320, 240)), time.monotonic())
    assert published(camera, table(disc=(320, 240)), time.monotonic())
    assert pipeline_of_a_file_finds_at_once()


def pipeline_of_a_file_finds_at_once():
    recording = pipeline(Limits(), kind=VIDEO_FILE)
    recording.process(table())
    return published(recording, table(disc=(320, 240)))


def test_empty_surface_is_told_from_one_that_cannot_be_told():
    camera = pipeline(background_frames=2)
    assert camera.process(table()).reason.kind == 'background_missing'
    assert camera.process(table()) == Sighting([])
    sighting = camera.process(table(move=(6, 0), disc=(320, 240)))
    assert sighting.reason.kind == 'view_moved' and not sighting.objects


def test_empty_surface_of_a_camera_is_confirmed_by_a_second_frame():
    camera = pipeline(Limits(), kind=DEVICE)
    now = time.monotonic
    camera.process(table(), now())
    assert camera.process(table(), now()).reason.kind == 'unconfirmed'
    assert camera.process(table(), now()) == Sighting([])


@pytest.mark.parametrize('frame', [
    None, 'text', np.zeros((480, 640), np.uint8), np.zeros((0, 0, 3), np.uint8),
    np.zeros((480, 640, 3), np.float32)])
def test_what_is_no_frame_is_a_reason_and_the_next_frame_is_good(frame):
    camera = pipeline()
    camera.process(table())
    assert camera.process(frame).reason.kind == 'frame_unusable'
    assert 'expected a frame' in camera.reason.sentence
    assert published(camera, table(disc=(320, 240)))


class DefectiveSurface(ParallelSurface):

    def for_image_size(self, image_size):
        return self

    def locate(self, pixels):
        return 1 / 0


def test_defect_in_a_step_is_no_reason():
    camera = CameraPipeline(DefectiveSurface(36.0, 640))
    camera.process(table())
    with pytest.raises(ZeroDivisionError):
        camera.process(table(disc=(320, 240)))


def test_object_that_jumps_in_beside_a_steady_one_is_left_out_until_a_second_frame_shows_it():
    camera, both = pipeline(Limits(), kind=DEVICE), table(disc=(320, 240))
    cv2.circle(both, (100, 100), 15, (30, 30, 30), -1)
    for frame in (table(), table(), *[table(disc=(320, 240))] * 3):
        camera.process(frame, time.monotonic())
    sighting = camera.process(both, time.monotonic())
    assert len(sighting.objects) == 1
    left_out, = sighting.left_out
    assert left_out.detection.centre == pytest.approx((100, 100), abs=2)
    assert left_out.reason.kind == 'unconfirmed'
    assert len(camera.process(both, time.monotonic()).objects) == 2


@pytest.mark.slow
def test_memory_does_not_grow_with_the_frames(tell):
    camera = pipeline(Limits(), kind=DEVICE)
    frames = [table(size=(64, 48)), table(disc=(30, 20), size=(64, 48))]

    def process(count):
        for number in range(count):
            camera.process(frames[number % 2], time.monotonic())
        with open('/proc/self/statm') as file:
            return int(file.read().split()[1]) * 4096

    before = process(3000)
    growth = process(FRAMES) - before
    tell(f'{FRAMES} frames through the pipeline: it grew by {growth} bytes after the first 3000')
    assert growth < (5_000_000 if FRAMES > 100_000 else 1_000_000)


def test_background_stays_where_no_new_one_could_be_taken():
    camera = CameraPipeline(ParallelSurface(36.0, 640))
    camera.process(table())
    assert camera.process(table(disc=(320, 240))).objects
    camera.capture_background(5)
    assert not camera.process(table(disc=(320, 240))).objects and camera.background is None
    assert camera.backgrounds.keep_before() is not None
    assert camera.process(table(disc=(320, 240))).objects


def test_first_background_cannot_be_given_up():
    camera = CameraPipeline(ParallelSurface(36.0, 640), background_frames=2)
    camera.process(table())
    assert camera.backgrounds.keep_before() is None
    assert not camera.process(table()).objects and camera.background is not None


@pytest.mark.parametrize('is_strict', [False, True])
def test_another_camera_is_a_doubt_and_strict_holds_its_frames_back(is_strict):
    other = cv2.flip(table(size=(640, 480)), -1)
    camera = CameraPipeline(ParallelSurface(36.0, 640), own_camera=OwnCamera(
        calibrated='', thumbnail=read_thumbnail(view_thumbnail(other)), is_strict=is_strict))
    camera.process(table())
    sighting = camera.process(table(disc=(320, 240)))
    why, nothing = (camera.reason, camera.doubt)[::1 if is_strict else -1]
    assert why.kind == 'other_view' and nothing is None
    assert len(sighting.objects) == (0 if is_strict else 1)
    assert camera.counts['frames held back: other_view'] == (2 if is_strict else 0)


def test_damaged_frame_is_a_reason_where_no_reader_has_looked_for_damage():
    camera = CameraPipeline(ParallelSurface(36.0, 640), damage=DamageCheck())
    noise = np.random.default_rng(1).integers(0, 5, (2, 480, 640, 3), np.uint8)
    first, second = cv2.add(table(), noise[0]), cv2.add(table(disc=(320, 240)), noise[1])
    camera.process(first)
    assert camera.process(second).objects
    reason = camera.process(second.copy()).reason
    assert reason.kind == 'repeated' and reason.sentence.startswith('the frame cannot be used: ')


def test_background_is_the_median_of_the_frames_that_are_given():
    camera = pipeline(Limits(), kind=DEVICE)
    camera.use_background(*(table(disc=disc) for disc in ((100, 100), None, (300, 300))))
    assert (camera.background == table()).all()
    for _ in range(2):
        seen = published(camera, table(disc=(320, 240)), time.monotonic())
    assert len(seen) == 1
    for frames, said in (((), 'at least one'), ((table(), None), 'expected a frame'),
                         ((table(), table(size=(64, 48))), 'use one picture size')):
        with pytest.raises(CameraToBaseError, match=said):
            camera.use_background(*frames)
