# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.detection.background import BackgroundTaker
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.simulation.board import SimulatedBoard
import cv2
import numpy as np
import pytest
import scenes


def frame(level, shape=(6, 8, 3)):
    return np.full(shape, level, np.uint8)


def test_background_of_one_frame_is_that_frame():
    assert (BackgroundTaker(1).add(frame(7)) == 7).all()


def test_background_is_the_median_so_that_what_passes_is_not_in_it():
    taker = BackgroundTaker(5)
    assert [taker.add(frame(level)) for level in (100, 101, 20, 99)] == [None] * 4
    background = taker.add(frame(102))
    assert (background == 100).all()
    assert background.shape == (6, 8, 3) and background.dtype == np.uint8


def test_frame_of_another_size_begins_anew():
    taker = BackgroundTaker(2)
    assert taker.add(frame(1)) is None
    assert taker.add(frame(50, (3, 4, 3))) is None
    assert (taker.add(frame(50, (3, 4, 3))) == 50).all()


def taken_by(taker, frames):
    """Tell after how many frames of a camera there is a background, and give it."""
    for count, given in enumerate(frames, start=1):
        background = taker.add(given, confirm=True)
        if background is not None:
            return count, background
    return None, None


def test_frame_of_a_camera_counts_when_the_next_one_agrees():
    assert taken_by(BackgroundTaker(1), [frame(100), frame(104)]) == (2, pytest.approx(frame(100)))
    count, background = taken_by(BackgroundTaker(2), map(frame, (100, 30, 101, 103, 104)))
    assert count == 5 and (background == 102).all()


def test_damaged_frames_are_left_out():
    good = [scenes.still_coin(empty_s=60.0)() for _ in range(4)]
    cut = good[0].copy()
    cut[400:] = 128
    count, background = taken_by(BackgroundTaker(1), [cut, good[1], cut, good[2], good[3]])
    assert count == 5 and (background == good[2]).all()


def test_frames_of_an_exposure_that_settles_do_not_agree():
    count, background = taken_by(BackgroundTaker(1), map(frame, range(10, 200, 8)))
    assert background.mean() > 140


def test_frames_that_never_agree_are_the_problem_and_one_that_does_ends_it():
    taker = BackgroundTaker(1)
    assert taken_by(taker, map(frame, (100, 130, 160, 190))) == (None, None)
    assert 'the pictures differ' in taker.reason.sentence
    assert taken_by(taker, [frame(191)])[0] == 1
    assert taker.reason.kind == 'background_missing'


def test_black_frames_are_the_problem_however_well_they_agree():
    taker = BackgroundTaker(1)
    assert taken_by(taker, map(frame, (3, 3, 4, 4))) == (None, None)
    assert 'the picture is black' in taker.reason.sentence


def test_bright_pixels_on_a_black_picture_do_not_make_it_light():
    dark = frame(3, shape=(48, 64, 3))
    dark[:, 0] = 255
    taker = BackgroundTaker(1)
    assert taken_by(taker, [dark, dark + np.uint8(0)]) == (None, None)
    assert 'the picture is black' in taker.reason.sentence


@pytest.mark.parametrize('frame_count', [10, 40, 160])
def test_background_of_a_camera_that_warms_up_finds_the_coin_at_full_light(frame_count):
    take_frame = scenes.still_coin(empty_s=60.0)
    brightening = (cv2.convertScaleAbs(take_frame(), alpha=min(1.0, number / frame_count))
                   for number in range(frame_count + 2))
    _, background = taken_by(BackgroundTaker(1), brightening)
    found, = PreciseDifferenceDetector(background).detect(scenes.still_coin(empty_s=0.0)())
    assert found.centre == pytest.approx((400, 300), abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize('count', [1, 5, pytest.param(30, marks=pytest.mark.slow)])
def test_hands_that_pass_do_not_keep_a_background_from_being_taken_within_10_s(count):
    board = SimulatedBoard(hands=6, noise=2.0)
    for _ in range(20):
        assert taken_by(BackgroundTaker(count), (board.read() for _ in range(100)))[0]


@pytest.mark.slow
def test_gathered_frames_take_no_more_than_200_mb():
    frame, taker, count = np.full((2160, 3840, 3), 150, np.uint8), BackgroundTaker(1000), 0
    background = None
    while background is None:
        count += 1
        background = taker.add(frame)
        assert count < 20
    assert taker.taken_count == count == 9
