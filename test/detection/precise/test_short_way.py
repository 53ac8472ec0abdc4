# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.


"""What the detector does quickly: which frames and objects take the short way, and how it ends."""

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.light import Gain, GainMeter
from camera_to_base.detection.precise.plain import find_plain
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.search import parts_of
import cv2
import numpy as np
import pytest


def table(size=(240, 320), level=180, seed=1):
    noise = np.random.default_rng(seed).normal(level, 1.5, (*size, 3))
    return np.clip(np.rint(noise), 0, 255).astype(np.uint8)


def with_disc(picture, centre, radius=15, level=60):
    return cv2.circle(picture.copy(), centre, radius, (level,) * 3, cv2.FILLED, cv2.LINE_AA)


def reference_of(frame, background=None):
    reference = Reference(table(frame.shape[:2]) if background is None else background, 13.0)
    reference.follow(frame)
    return reference


@pytest.mark.parametrize('size', [(240, 320), (241, 323), (50, 61), (9, 7)])
@pytest.mark.parametrize('place', [(0, 0), (0.5, 0.5), (1, 1), (0, 1), (0.97, 0.4)])
def test_parts_contain_all_that_changed(size, place):
    frame = table(size)
    v, u = (round(share * (length - 3)) for share, length in zip(place, size))
    frame[v:v + 3, u:u + 3] = 60
    part, = parts_of(frame, reference_of(frame, table(size)))
    assert part.x <= u and part.y <= v
    assert u + 3 <= part.x + part.width <= size[1] and v + 3 <= part.y + part.height <= size[0]
    assert part.width <= 24 and part.height <= 24


@pytest.mark.parametrize('size', [(400, 1304), (411, 1301)])
def test_part_goes_on_through_all_rows_of_a_large_frame(size):
    frame = table(size)
    frame[:, 700:703] = 60
    part, = parts_of(frame, reference_of(frame, table(size)))
    assert (part.y, part.height) == (0, size[0])
    assert part.x <= 700 and 703 <= part.x + part.width <= 720


def test_calm_frame_has_no_parts():
    frame = table(seed=2)
    assert parts_of(frame, reference_of(frame)) == []


def plain_on(frame, background=None):
    reference = reference_of(frame, background)
    part, = parts_of(frame, reference)
    return find_plain(frame, part, reference, min_area=50)


def test_plain_object_takes_the_short_way():
    assert plain_on(with_disc(table(seed=2), (150, 120))) is not None


@pytest.mark.parametrize('change', [
    lambda frame: with_disc(frame, (152, 122), 6, 150),  # a second level
    lambda frame: with_disc(frame, (148, 118), 3, 255),  # a highlight
    lambda frame: with_disc(frame, (150, 120), 7, 180),  # a hole
    lambda frame: with_disc(frame, (175, 120), 8, 100),  # another object beside it
    lambda frame: with_disc(with_disc(frame, (156, 126), 19, 140), (150, 120)),  # its shadow
    lambda frame: with_disc(frame, (150, 120), 16, 162),  # faint
    lambda frame: with_disc(table(seed=2), (150, 120), 4)])  # small
def test_anything_else_takes_the_long_way(change):
    assert plain_on(change(with_disc(table(seed=2), (150, 120)))) is None


def test_faint_specks_beside_an_object_do_not_matter():
    frame = with_disc(table(seed=2), (150, 120))
    specks = with_disc(with_disc(frame, (175, 120), 5, 168), (150, 146), 5, 168)
    with_specks, alone = plain_on(specks), plain_on(frame)
    assert with_specks.window == alone.window
    np.testing.assert_array_equal(with_specks.placed.outline, alone.placed.outline)


def test_object_on_a_jpeg_takes_the_short_way():
    def sent(frame):
        jpeg = cv2.imencode('.jpg', frame, [cv2.IMWRITE_JPEG_QUALITY, 85])[1]
        return cv2.imdecode(jpeg, cv2.IMREAD_COLOR)
    size = 480, 640
    background = sent(table(size))
    frames = (with_disc(table(size, seed=2), (240 + u, 320), 60) for u in range(8))
    assert all(plain_on(sent(frame), background) is not None for frame in frames)


def test_object_at_the_edge_takes_the_long_way():
    assert plain_on(with_disc(table(seed=2), (8, 120))) is None


def test_place_of_an_object_that_was_taken_away_takes_the_long_way():
    assert plain_on(table(seed=2), with_disc(table(), (150, 120))) is None


@pytest.mark.parametrize('size', [(240, 320), (243, 317)])
def test_frame_without_any_background_is_one_object_that_is_cut_off(size):
    rng = np.random.default_rng(3)
    cells = rng.integers(0, 100, (6, 8, 1), dtype=np.uint8)
    frame = cv2.resize(cells, size[::-1], interpolation=cv2.INTER_NEAREST)
    frame = np.ascontiguousarray(np.repeat(frame[:, :, None], 3, axis=2))
    found, = PreciseDifferenceDetector(table(size)).detect(frame)
    assert found.cut_off and found.box == Box(0, 0, size[1], size[0])
    assert found.area == (size[0] - 1) * (size[1] - 1)


def test_covered_lens_is_one_object_that_is_cut_off():
    found, = PreciseDifferenceDetector(table()).detect(np.full((240, 320, 3), 3, np.uint8))
    assert found.cut_off and found.box == Box(0, 0, 320, 240)


def scenes():
    empty = np.full((240, 320, 3), 180, np.uint8)
    mostly_dark = np.full((240, 320, 3), 30, np.uint8)
    mostly_dark[:20] = 180
    return [empty, with_disc(empty, (60, 20), 12), with_disc(empty, (150, 200)),
            with_disc(with_disc(empty, (150, 200)), (260, 90)),
            np.full((240, 320, 3), 30, np.uint8), mostly_dark]


@pytest.mark.parametrize('before', range(6))
@pytest.mark.parametrize('number', range(6))
def test_what_is_found_does_not_depend_on_the_frame_before(before, number):
    empty, frame = scenes()[0], scenes()[number]
    detector = PreciseDifferenceDetector(empty)
    detector.detect(scenes()[before])
    assert detector.detect(frame) == PreciseDifferenceDetector(empty).detect(frame)


def test_hand_over_half_of_the_table_leaves_the_objects_beside_it():
    frame = with_disc(table(seed=2), (260, 120))
    frame[:, :130] = 40
    found = PreciseDifferenceDetector(table()).detect(frame)
    assert sorted(one.cut_off for one in found) == [False, True]


def test_gain_is_between_two_halves_of_which_one_is_lighter_and_one_is_darker():
    frame = np.float32(table(level=150))
    frame[:120] *= 1.06
    frame[120:] *= 0.94
    gain = GainMeter(table(level=150)).follow(np.uint8(frame))
    assert all(abs(steps) < 10 for steps in gain)


def test_gain_holds_within_a_level_and_follows_a_change():
    background = table()
    meter = GainMeter(background)
    assert meter.follow(background) == Gain(0, 0, 0)
    assert meter.follow(table(seed=2)) == Gain(0, 0, 0)
    darker = cv2.convertScaleAbs(background, alpha=0.9)
    blue, green, red = meter.follow(darker)
    assert blue == green == red == pytest.approx(220 * np.log(0.9), abs=2)
    assert meter.follow(background) == Gain(0, 0, 0)


@pytest.mark.parametrize('gain', [Gain(20, 10, -10), Gain(-60, -60, -60), Gain(3, -2, 1)])
def test_picture_at_another_light_follows_the_camera_s_curve(gain):
    ramp = np.repeat(np.arange(256, dtype=np.uint8)[:, None, None], 3, axis=2)
    error = np.abs(gain.lit(ramp)[:, 0].astype(float) - gain.coded_levels)
    assert error.max() < 4 and error[15:].max() < 1
