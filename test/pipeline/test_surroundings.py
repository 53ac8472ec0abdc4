# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What lies around an object, and on a large one, has a word where no position can be told."""

import time

from camera_to_base.pipeline import CameraPipeline
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
import cv2
import numpy as np
import pytest

WIDTH, HEIGHT, CM_PER_PX, FRAMES_PER_S = 400, 300, 0.05, 12
PAPER, COIN_ON_IT, COIN_BESIDE = ((220, 160), (190, 140), 15), (230, 150), (50, 60)


class Desk:
    """A wooden table under a light that can be too strong; its coins and its sheets of paper."""

    def __init__(self, brown=(60, 90, 120)):
        self._random = np.random.default_rng(8)
        grain = self._random.normal(0, 60, (HEIGHT, WIDTH)).astype(np.float32)
        grain = cv2.GaussianBlur(grain, (0, 0), sigmaX=20, sigmaY=1.5)
        self._table = np.uint8(np.clip(np.array(brown) + grain[..., None], 5, 250))
        self.pipeline = CameraPipeline(ParallelSurface(WIDTH * CM_PER_PX, WIDTH), kind=DEVICE)
        self._count, self._begin = 0, time.monotonic() + 3600
        self.see(0.5)

    def see(self, seconds, coins=(), papers=(), light=1.0, coin_colour=(40, 30, 25)):
        """Show some frames; give their sightings. Papers lie on the coins, but for the first."""
        sightings = []
        for _ in range(max(1, round(seconds * FRAMES_PER_S))):
            frame = self._table.copy()
            for number, coin in enumerate(coins):
                for paper in papers[number:number + 1]:
                    cv2.fillPoly(frame, [np.int32(cv2.boxPoints(paper).round())], (240,) * 3)
                cv2.circle(frame, coin, 12, coin_colour, cv2.FILLED, cv2.LINE_AA)
            for paper in papers[len(coins):]:
                cv2.fillPoly(frame, [np.int32(cv2.boxPoints(paper).round())], (240,) * 3)
            frame = light * frame + self._random.normal(0, 1.5, frame.shape)
            self._count += 1
            sightings.append(self.pipeline.process(
                np.uint8(np.clip(frame, 0, 255).round()),
                self._begin + self._count / FRAMES_PER_S))
        return sightings


def words(sighting, near, reach_px=20):
    """Give the words of what was left out around a pixel."""
    return {one.reason.kind for one in sighting.left_out
            if np.abs(np.subtract(one.detection.centre, near)).max() < reach_px}


def test_coin_on_a_sheet_of_paper_is_named():
    desk = Desk()
    seen = desk.see(0.5, [COIN_ON_IT, COIN_BESIDE], [PAPER])[-1]
    assert words(seen, COIN_ON_IT) == {'on_sheet'}
    place = next(one for one in seen.left_out if one.reason.kind == 'on_sheet').point
    assert np.abs(np.array(place) / CM_PER_PX - COIN_ON_IT).max() < 1
    # The paper and the coin beside it are objects.
    assert len(seen.objects) == 2


def test_coin_below_a_sheet_of_paper_is_named_until_it_is_seen_again():
    desk = Desk()
    assert len(desk.see(1, [COIN_ON_IT, COIN_BESIDE])[-1].objects) == 2
    seen = desk.see(3, [COIN_ON_IT, COIN_BESIDE], [(PAPER[0], (1, 1), 0)] * 2 + [PAPER])
    assert all(words(one, COIN_ON_IT) == {'joined'} for one in seen[2:])
    assert not words(desk.see(0.3, [COIN_ON_IT, COIN_BESIDE])[-1], COIN_ON_IT)


def test_coins_that_are_pushed_together_are_named():
    desk, coins = Desk(), [(150, 150), (200, 150)]
    assert len(desk.see(1, coins)[-1].objects) == 2
    seen = desk.see(0.5, [(150, 150), (172, 150)])[-1]
    (pair,) = seen.objects
    assert 'joined' in words(seen, (150, 150))


@pytest.mark.parametrize('strongest', [2.5, 3.5, 6.0])
def test_light_that_is_too_strong_for_a_moment_leaves_nothing_behind(strongest):
    desk, coins = Desk(), [(120, 100), (280, 200)]
    white = {'coin_colour': (150, 190, 210)}
    desk.see(1, coins, **white)
    for light in (*np.linspace(1, strongest, 15), *[strongest] * 5):
        for one in desk.see(0.01, coins, light=light, **white):
            assert all(np.abs(np.array(found.point) / CM_PER_PX - coins).max(axis=1).min() < 3
                       for found in one.objects or () if one.reason is None)
    after = desk.see(1, coins, **white)
    assert all(len(one.objects) == 2 and one.reason is None for one in after[2:])
    assert desk.pipeline.doubt is None


def test_still_coin_that_a_frame_does_not_show_needs_no_second_frame_again():
    desk = Desk()
    assert desk.see(0.5, [COIN_BESIDE, COIN_ON_IT])[-1].objects
    for _ in range(4):
        desk.see(0.01, [COIN_BESIDE])
        seen = desk.see(0.01, [COIN_BESIDE, COIN_ON_IT])[-1]
        assert seen.reason is None and len(seen.objects) == 2


def test_surface_that_is_overexposed_is_told_until_the_background_is_taken_at_less_light():
    desk = Desk()
    assert desk.pipeline.doubt is None
    desk.see(0.5, light=3.5)
    desk.pipeline.capture_background(1)
    desk.see(0.5, light=3.5)
    doubt = desk.pipeline.doubt
    assert doubt.kind == 'background_overexposed' and not doubt.is_passing
    assert 'the surface is overexposed on 100% of' in doubt.sentence
    desk.see(0.5)
    desk.pipeline.capture_background(1)
    desk.see(0.5)
    assert desk.pipeline.doubt is None
