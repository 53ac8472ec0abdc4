# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from dataclasses import replace
import time

from camera_to_base.commands.positions import SightingCounter
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.pipeline import DamageCheck
from camera_to_base.settings import read_node_settings
from camera_to_base.sources.kinds import DEVICE, VIDEO_FILE
from camera_to_base.sources.recording import TimedFrame
from camera_to_base.surface.models import HomographySurface
from camera_to_base.surface.thumbnail import view_thumbnail
import cv2
import numpy as np
import pytest
from recordings import disc_frame

SETTINGS = read_node_settings(None).camera
AT_ONCE = replace(SETTINGS, limits=SETTINGS.limits._replace(confirm_jump_px=0.0))


def damaged():
    raise InvalidValueError('the picture is damaged')


def seen(counter, *decoders):
    return [counter.see(TimedFrame(number, 0, decode)) for number, decode in enumerate(decoders)]


def kind_of(sighting):
    return None if sighting.reason is None else sighting.reason.kind


def test_frames_are_counted_by_what_they_show():
    counter = SightingCounter(SETTINGS)
    seen(counter, lambda: disc_frame(None), lambda: disc_frame((60, 60)), damaged,
         lambda: disc_frame([(60, 60), (200, 100)]), lambda: disc_frame(None),
         lambda: disc_frame(None, (64, 48)), damaged)
    counter.check_any_used()
    summary = counter.summary()
    assert summary[0] == '7 frames: 2 with an object (1 with one, 1 with more)'
    assert summary[1] == (
        'frames held back: 2 (damaged, the first: the picture is damaged)')
    assert summary[2].startswith(
        'frames held back: 1 (frame_size, the first: the frame is 64 x 48 px')


def test_reason_is_told_with_the_frame():
    first, second = seen(SightingCounter(SETTINGS), lambda: disc_frame(None), damaged)
    assert first.reason is None and second.reason.sentence == 'the picture is damaged'


def test_frames_for_the_background_are_held_back():
    counter = SightingCounter(replace(SETTINGS, background_frames=3))
    seen(counter, *[lambda: disc_frame(None)] * 3, lambda: disc_frame((60, 60)))
    assert counter.summary()[1:] == [
        'frames held back: 2 (background_missing, the first: taking the background: keep the '
        'surface clear)']
    counter.check_any_used()


@pytest.mark.parametrize('decoders, reason', [
    ([damaged] * 3, 'damaged'),
    ([lambda: disc_frame(None), *[lambda: disc_frame(None, (64, 48))] * 3], '64 x 48 px')])
def test_not_a_single_frame_that_can_be_used_is_an_error(decoders, reason):
    counter = SightingCounter(SETTINGS)
    seen(counter, *decoders)
    with pytest.raises(CameraToBaseError, match=f'no frame could be used: .*{reason}'):
        counter.check_any_used()


def test_recording_of_objects_beyond_the_horizon_only_is_an_error():
    road = HomographySurface(np.array([[1, 0, -160], [0, 0, 128], [0, 1, -112]]), (320, 240))
    counter = SightingCounter(replace(SETTINGS, surface=road))
    seen(counter, lambda: disc_frame(None), *[lambda: disc_frame((60, 40))] * 3)
    with pytest.raises(CameraToBaseError, match='no frame could be used: .*horizon'):
        counter.check_any_used()


def test_what_comes_too_late_holds_back_a_camera_and_not_a_recording():
    for source, kind in ((DEVICE, 'too_late'), (VIDEO_FILE, None)):
        counter = SightingCounter(AT_ONCE, source)
        sightings = [counter.see(TimedFrame(0, 0, lambda: disc_frame(scene), live_at=-100.0))
                     for scene in (None, (60, 60))]
        assert kind_of(sightings[1]) == kind and len(sightings[1].objects) == 1


def test_moved_view_holds_back_a_camera_and_a_recording():
    table = np.random.default_rng(1).integers(100, 200, (60, 80, 3)).astype(np.uint8)
    table = cv2.resize(table, (640, 480), interpolation=cv2.INTER_CUBIC)
    for source in DEVICE, VIDEO_FILE:
        counter = SightingCounter(SETTINGS, source)
        seen(counter, *[lambda: table] * 2)
        end = time.monotonic() + 0.05
        while time.monotonic() < end:
            sighting, = seen(counter, lambda: np.roll(table, 20, axis=1))
        assert kind_of(sighting) == 'view_moved'


def test_calibration_of_another_view_holds_frames_back_where_it_is_strict():
    other = view_thumbnail(cv2.flip(wood(), -1))
    for is_strict, with_any in (False, 1), (True, 0):
        calibrated_for = SETTINGS.calibrated_for._replace(thumbnail=other, is_strict=is_strict)
        counter = SightingCounter(replace(SETTINGS, calibrated_for=calibrated_for))
        seen(counter, wood, lambda: cv2.circle(wood(), (150, 100), 20, (20, 20, 20), -1))
        assert f': {with_any} with an object' in counter.summary()[0]
        assert ('the picture shares nothing with the surface that was calibrated'
                in '\n'.join(counter.summary()))


def test_frame_that_a_camera_repeats_is_held_back_and_one_of_a_recording_is_not():
    for source, damage, with_any in (DEVICE, DamageCheck(), 2), (VIDEO_FILE, None, 3):
        counter, coin = SightingCounter(AT_ONCE, source, damage=damage), noisy((60, 60))
        for number, frame in enumerate((noisy(), noisy(), coin, coin.copy(), noisy((60, 60)))):
            counter.see(TimedFrame(number, 0, lambda it=frame: it, time.monotonic()))
        assert f': {with_any} with an object' in counter.summary()[0]
        assert any('repeated' in line for line in counter.summary()) == source.is_live


def wood():
    noise = np.random.default_rng(1).normal(0, 1, (240, 320))
    blurred = cv2.GaussianBlur(noise, (0, 0), 9)
    return cv2.merge([(150 + 25 * blurred / blurred.std()).clip(0, 255).astype(np.uint8)] * 3)


def noisy(disc=None, random=np.random.default_rng(2)):
    frame = disc_frame(disc)
    return (frame + random.normal(0, 2, frame.shape)).clip(0, 255).astype(np.uint8)
