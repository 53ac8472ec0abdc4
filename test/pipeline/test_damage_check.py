# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.errors import Reason
from camera_to_base.pipeline.damage import DamageCheck
import cv2
import numpy as np
import pytest
import scenes


@pytest.fixture
def camera():
    """Give a check that has seen some good frames, and a function that takes the next one."""
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    for _ in range(5):
        assert check.reason(take_frame()) is None
    return check, take_frame


@pytest.mark.parametrize('quality', [50, 90])
@pytest.mark.parametrize('noise', [0.5, 2.0, 8.0])
def test_good_frames_are_never_refused(noise, quality):
    take_frame, check = scenes.still_coin(empty_s=0.0, noise=noise), DamageCheck()
    for _ in range(60):
        _, jpeg = cv2.imencode('.jpg', take_frame(), [cv2.IMWRITE_JPEG_QUALITY, quality])
        assert check.reason(cv2.imdecode(jpeg, cv2.IMREAD_COLOR)) is None


def test_frame_that_repeats_the_last_one_is_refused(camera):
    check, take_frame = camera
    frame = take_frame()
    assert check.reason(frame) is None
    assert 'repeats' in check.reason(frame.copy()).sentence


@pytest.mark.parametrize('back', [1, 3])
@pytest.mark.parametrize('row', [0, 240, 460])
def test_frame_whose_lower_end_is_an_earlier_ones_is_refused(camera, row, back):
    check, take_frame = camera
    earlier = [take_frame() for _ in range(3)]
    for frame in earlier:
        check.reason(frame)
    frame = take_frame()
    frame[row:] = earlier[-back][row:]
    assert check.reason(frame).kind in ('old_end', 'repeated')
    assert check.reason(take_frame()) is None


def test_frame_whose_lower_end_has_one_colour_is_refused_each_time(camera):
    check, take_frame = camera
    for _ in range(5):
        frame = take_frame()
        frame[300:] = 128
        assert 'one colour' in check.reason(frame).sentence


def test_first_frame_that_is_grey_is_refused():
    assert 'one colour' in DamageCheck().reason(np.full((480, 640, 3), 128, np.uint8)).sentence


def with_lower_end(frame, colour):
    frame[400:] = colour
    return frame


def test_surface_that_is_overexposed_is_believed_after_some_frames():
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    reasons = [check.reason(with_lower_end(take_frame(), 255)) for _ in range(15)]
    assert all('one colour' in reason.sentence for reason in reasons[:4])
    assert reasons[4:] == [None] * 11


def overexposed(take_frame):
    frame = take_frame()
    frame[-40:] = 255
    return frame


def with_hand(take_frame):
    frame = overexposed(take_frame)
    frame[-80:, 200:300] = take_frame()[:80, 200:300] // 2
    return frame


def test_overexposed_edge_is_believed_again_once_a_hand_has_crossed_it():
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    for _ in range(10):
        check.reason(overexposed(take_frame))
    for _ in range(3):
        check.reason(with_hand(take_frame))
        assert check.reason(overexposed(take_frame)) is None
    assert [check.reason(overexposed(take_frame)) for _ in range(300)] == [None] * 300


def test_edge_that_becomes_overexposed_is_believed_after_a_second():
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    check.reason(with_hand(take_frame))
    kinds = [getattr(check.reason(overexposed(take_frame)), 'kind', None) for _ in range(50)]
    assert kinds == ['flat_end'] * 24 + [None] * 26


def test_lower_end_of_another_colour_than_the_usual_one_is_refused():
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    for _ in range(10):
        check.reason(overexposed(take_frame))
    assert check.reason(with_lower_end(take_frame(), 0)).kind == 'flat_end'


@pytest.mark.parametrize('colour', [128, (0, 135, 0)])
def test_lower_end_that_a_decoder_filled_is_never_believed(colour):
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    for _ in range(15):
        assert 'one colour' in check.reason(with_lower_end(take_frame(), colour)).sentence


def test_frame_of_one_colour_is_refused_even_where_no_two_are_the_same():
    check = DamageCheck()
    for level in range(50, 150, 10):
        assert 'one colour' in check.reason(np.full((480, 640, 3), level, np.uint8)).sentence


def test_black_frame_is_refused_and_a_dim_one_is_not():
    take_frame, check = scenes.still_coin(empty_s=0.0), DamageCheck()
    for _ in range(3):
        assert 'black' in check.reason(cv2.convertScaleAbs(take_frame(), alpha=0.01)).sentence
    assert check.reason(cv2.convertScaleAbs(take_frame(), alpha=0.06)) is None


def test_large_change_is_believed_when_the_next_frame_shares_it(camera):
    check, take_frame = camera

    def brighter():
        return np.clip(take_frame().astype(int) + 30, 0, 255).astype(np.uint8)

    assert 'changed at once' in check.reason(brighter()).sentence
    assert check.reason(brighter()) is None
    assert check.reason(brighter()) is None


def test_large_change_that_no_other_frame_shares_is_refused_each_time(camera):
    check, take_frame = camera
    for shift in (40, -60, 30):
        frame = take_frame()
        frame[200:] = np.clip(frame[200:].astype(int) + shift, 0, 255)
        assert 'changed at once' in check.reason(frame).sentence
        assert check.reason(take_frame()) is None


def test_other_picture_size_begins_anew(camera):
    check, take_frame = camera
    small = [cv2.resize(take_frame(), (320, 240)) for _ in range(3)]
    assert [check.reason(frame) for frame in small] == [None] * 3


@pytest.mark.parametrize('shape', [(1, 1, 3), (8, 8, 3), (7, 1000, 3), (1000, 7, 3)])
def test_odd_sizes_are_judged(shape):
    check, random = DamageCheck(), np.random.default_rng(0)
    for _ in range(3):
        reason = check.reason(random.integers(0, 255, shape).astype(np.uint8))
        assert reason is None or isinstance(reason, Reason)


def copying(take_frame, share=0.9, seed=1):
    """Give frames as a codec shows them: of each, a share of the blocks is that of the last."""
    rng, shown = np.random.default_rng(seed), take_frame()
    while True:
        yield shown
        kept = np.kron(rng.random((30, 40)) < share, np.ones((16, 16))).astype(bool)
        # A quiet lower end, which is copied as a whole now and then.
        kept[-32:] |= rng.random() < 0.5
        shown = np.where(kept[:, :, None], shown, take_frame())


def test_blocks_that_a_codec_copied_are_no_damage():
    frames, check = copying(scenes.still_coin(empty_s=0.0)), DamageCheck()
    assert [check.reason(next(frames)) for _ in range(60)] == [None] * 60


def test_picture_of_a_codec_that_lost_its_lower_half_is_refused():
    frames, check = copying(scenes.still_coin(empty_s=0.0), share=0.4), DamageCheck()
    for _ in range(20):
        last = next(frames)
        check.reason(last)
    torn = next(frames).copy()
    torn[240:] = last[240:]
    assert check.reason(torn).kind == 'old_end'


def test_codec_may_repeat_a_picture_now_and_then_but_not_stand_still():
    frames, check = copying(scenes.still_coin(empty_s=0.0)), DamageCheck()
    for _ in range(20):
        last = next(frames)
        check.reason(last)
    assert [check.reason(last.copy()) for _ in range(5)] == [None] * 5
    assert check.reason(last.copy()).kind == 'repeated'
    assert check.reason(next(frames)) is None
