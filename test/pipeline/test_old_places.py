# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where an object of the background has left, nothing is published until the next capture."""

import time

from camera_to_base.detection import Box, Detection, Pixel
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.pipeline.old_places import OldPlaces
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
import cv2
from lit_table import coded, disc, felt, painted, shaded
import numpy as np
import pytest

WIDTH, HEIGHT, CM_PER_PX, FRAMES_PER_S = 400, 300, 0.05, 12
BOOK, COIN_ON_IT, COIN_BESIDE = ((200, 150), (110, 70), 25), (212, 140), (60, 220)


def box_at(x, y, size):
    outline = np.int32([[x, y], [x + size, y], [x + size, y + size], [x, y + size]])
    return Detection(Box(x, y, size, size), Pixel(x + size / 2, y + size / 2), float(size ** 2),
                     outline, False)


def told(*ends_at):
    """Places that a square of 20 px at (100, 100) px was told of from 5 s on."""
    places = OldPlaces()
    for at in (5.0, *ends_at):
        places.note([box_at(100, 100, 20).outline], at)
    return places


@pytest.mark.parametrize('thing, is_held', [
    (box_at(110, 110, 10), True),  # a smaller part
    (box_at(122, 110, 10), True),  # it touches it
    (box_at(130, 110, 10), False),  # beside it
    (box_at(95, 95, 40), False)])  # a larger object that was laid there
def test_part_of_an_old_place_is_held(thing, is_held):
    assert told().hold(thing, is_known=False) is is_held


def test_object_that_was_seen_before_is_held_by_a_certain_place_alone():
    part = box_at(110, 110, 10)
    assert not told().hold(part, is_known=True) and told().reason is None
    certain = told(6.0)
    assert certain.hold(part, is_known=True) and certain.reason.kind == 'taken_away'


@pytest.mark.parametrize('last_at, later_s, is_held', [
    (5.5, 0.9, True), (5.5, 1.1, False), (6.0, 100.0, True)])
def test_place_that_was_told_for_a_second_stays(last_at, later_s, is_held):
    places = told(last_at)
    places.note([], last_at + later_s)
    assert places.hold(box_at(110, 110, 10), is_known=False) is is_held


def test_corners_of_a_turned_box_are_one_place():
    places = OldPlaces()
    places.note([box_at(x, y, 20).outline for x in (100, 150) for y in (100, 140)], 5.0)
    assert len(places.outlines) == 1 and places.hold(box_at(130, 120, 5), is_known=False)


class Desk:
    """A table with text on it, or without, and a book that lies there for the background."""

    def __init__(self, has_text):
        self._random = np.random.default_rng(4)
        grain = self._random.normal(0, 5, (HEIGHT, WIDTH)).astype(np.float32)
        self._table = np.uint8(190 + cv2.GaussianBlur(grain, (0, 0), 1.5))[..., None].repeat(3, 2)
        for row in range(12, HEIGHT, 20) if has_text else ():
            text = ''.join(self._random.choice(list('abcdefg hijklmnop RSTUV'), 40))
            cv2.putText(self._table, text, (3, row), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (60, 50, 50),
                        1, cv2.LINE_AA)
        self.pipeline = CameraPipeline(
            ParallelSurface(WIDTH * CM_PER_PX, WIDTH), kind=DEVICE)
        self._count, self._begin = 0, time.monotonic() + 3600
        self.see(1.0, [BOOK])

    def see(self, seconds, books=(), coins=()):
        """Show some frames; give their sightings."""
        sightings = []
        for _ in range(int(seconds * FRAMES_PER_S)):
            frame = self._table.copy()
            for book in books:
                cv2.fillPoly(frame, [np.int32(cv2.boxPoints(book).round())], (90, 60, 130))
            for coin in coins:
                cv2.circle(frame, coin, 12, (40, 70, 40), cv2.FILLED, cv2.LINE_AA)
            frame = frame + self._random.normal(0, 1.5, frame.shape)
            self._count += 1
            sightings.append(self.pipeline.process(
                np.uint8(frame.round()), self._begin + self._count / FRAMES_PER_S))
        return sightings


@pytest.mark.parametrize('has_text', [True, False], ids=['print', 'plain'])
def test_nothing_is_published_where_an_object_of_the_background_has_left(has_text):
    desk = Desk(has_text)
    assert not any(one.objects for one in desk.see(1.5))
    seen = desk.see(2, coins=[COIN_ON_IT])
    assert not any(one.objects for one in seen)
    assert all('taken_away' in {left.reason.kind for left in one.left_out} for one in seen)
    (beside,) = desk.see(1, coins=[COIN_ON_IT, COIN_BESIDE])[-1].objects
    assert np.abs(np.array(beside.point) / CM_PER_PX - COIN_BESIDE).max() < 0.5
    assert desk.pipeline.doubt.kind == 'taken_away'
    desk.see(0.5, [BOOK])
    assert desk.pipeline.doubt is None


@pytest.mark.parametrize('turn', [15, 60])
def test_book_of_the_background_that_was_turned_gives_no_position(turn):
    centre, size, angle = BOOK
    seen = Desk(has_text=True).see(2, [(centre, size, angle + turn)])
    assert not any(one.objects for one in seen)
    assert all('taken_away' in {left.reason.kind for left in one.left_out} for one in seen)


def test_capture_makes_the_place_known_again():
    desk = Desk(has_text=True)
    desk.see(1.5)
    desk.pipeline.capture_background(1)
    desk.see(1)
    assert desk.pipeline.doubt is None
    (coin,) = desk.see(0.5, coins=[COIN_ON_IT])[-1].objects
    assert np.abs(np.array(coin.point) / CM_PER_PX - COIN_ON_IT).max() < 0.5


@pytest.mark.parametrize('texture', [0.06, 0.2])
def test_disc_that_looks_like_the_table_but_for_its_texture_is_no_place_that_was_left(texture):
    table = felt(texture, 1)
    with_it = painted(shaded(table, disc(155, 125, 18)), disc(150, 120, 18), table.mean((0, 1)))
    pipeline = CameraPipeline(ParallelSurface(WIDTH * CM_PER_PX, WIDTH), kind=DEVICE)
    begin = time.monotonic() + 3600
    for count in range(30):
        light = table if count < 15 else with_it
        seen = pipeline.process(coded(light, 100 + count, 90), begin + count / FRAMES_PER_S)
    (found,) = seen.objects
    assert np.hypot(*np.subtract(found.detection.centre, (150, 120))) < 1.5
    assert pipeline.doubt is None
