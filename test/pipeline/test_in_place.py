# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A clock that the camera writes into its pictures is named, and not published."""

import time

from camera_to_base.detection import DetectorSettings, read_areas
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
import cv2
import numpy as np
import pytest

WIDTH, HEIGHT, CM_PER_PX, FRAMES_PER_S = 480, 360, 0.05, 10
COIN = (300, 200)


class Camera:
    """A camera that writes the time into its pictures."""

    def __init__(self, place=(300, 30), ignored_areas='', begin_s=45296):
        self._random, self._place, self._begin_s = np.random.default_rng(3), place, begin_s
        grain = self._random.normal(0, 8, (HEIGHT, WIDTH)).astype(np.float32)
        self._table = np.uint8(140 + cv2.GaussianBlur(grain, (0, 0), 2))[..., None].repeat(3, 2)
        self.pipeline = CameraPipeline(
            ParallelSurface(WIDTH * CM_PER_PX, WIDTH),
            DetectorSettings(areas=read_areas([], ignored_areas)), kind=DEVICE)
        self._count, self._epoch = 0, time.monotonic() + 3600

    def see(self, seconds, draw=lambda frame, at: None, every=1):
        """
        Show some frames, what `draw` draws on them included; give their sightings.

        Only every third one, for example, is seen.
        """
        sightings = []
        for _ in range(round(seconds * FRAMES_PER_S / every)):
            frame, at = self._table.copy(), self._count / FRAMES_PER_S
            draw(frame, at)
            frame = np.uint8((frame + self._random.normal(0, 1.5, frame.shape)).round())
            now = int(self._begin_s + at)
            text = f'{now // 3600:02}:{now // 60 % 60:02}:{now % 60:02}'
            cv2.putText(frame, text, self._place, cv2.FONT_HERSHEY_SIMPLEX, 0.8, (255,) * 3, 2)
            sightings.append(self.pipeline.process(frame, self._epoch + at))
            self._count += every
        return sightings


def coin(frame, at):
    cv2.circle(frame, COIN, 14, (40, 50, 60), cv2.FILLED, cv2.LINE_AA)


def moving_coin(frame, at):
    cv2.circle(frame, (int(16 * (100 + 4 * at)), 200 * 16), 14 * 16, (40, 50, 60), cv2.FILLED,
               cv2.LINE_AA, 4)


def published(sightings):
    return [tuple(np.round(np.array(one.point) / CM_PER_PX).astype(int))
            for sighting in sightings if sighting.reason is None for one in sighting.objects]


@pytest.mark.parametrize('place, begin_s', [((300, 30), 45296), ((20, 345), 3541)])
def test_clock_is_named_after_some_seconds_and_the_coin_is_still_published(place, begin_s):
    camera = Camera(place, begin_s=begin_s)
    camera.see(8)
    seen = camera.see(14, coin)
    assert set(published(seen)) == {COIN} and len(published(seen)) > 0.95 * len(seen)
    assert camera.pipeline.doubt.kind == 'changes_in_place'
    words = {left.reason.kind for one in seen for left in one.left_out}
    assert 'changes_in_place' in words


def test_hint_is_a_polygon_that_ignores_the_clock():
    camera = Camera()
    camera.see(8)
    polygon = camera.pipeline.doubt.sentence.split("'")[1]
    other = Camera(ignored_areas=polygon)
    assert not published(other.see(15)) and other.pipeline.doubt is None


@pytest.mark.parametrize('draw', [coin, moving_coin])
def test_coin_that_lies_still_or_moves_is_no_clock(draw):
    camera = Camera(place=(-400, -400))
    camera.see(1)
    seen = camera.see(8, draw)
    assert len(published(seen)) > 0.9 * len(seen) and camera.pipeline.doubt is None


def test_coin_that_moves_slowly_before_a_slow_camera_is_no_clock():
    def slow_coin(frame, at):
        # A third of a second between frames, 1.7 px each: twice the same shape, then another.
        step = int(at * 10 / 3)
        cv2.circle(frame, (int(16 * (100 + 1.7 * step)), 200 * 16), 14 * 16, (40, 50, 60),
                   cv2.FILLED, cv2.LINE_AA, 4)

    camera = Camera(place=(-400, -400))
    camera.see(1)
    seen = camera.see(8, slow_coin, every=3)
    assert len(published(seen)) > 0.9 * len(seen) and camera.pipeline.doubt is None


def others_that_come_and_go(frame, at):
    if at % 2 < 1:
        cv2.circle(frame, COIN, 9 + 3 * (int(at) // 2 % 2), (40, 50, 60), cv2.FILLED, cv2.LINE_AA)


def test_things_that_are_put_at_one_place_in_turn_are_no_clock():
    camera = Camera(place=(-400, -400))
    camera.see(1)
    seen = camera.see(12, others_that_come_and_go)
    assert len(published(seen)) > 0.4 * len(seen) and camera.pipeline.doubt is None
