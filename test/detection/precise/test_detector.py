# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the precise detector promises."""

from dataclasses import asdict
import math

from camera_to_base.detection.detection import principal_axes
from camera_to_base.detection.locator import object_on_surface
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.errors import FrameSizeError, InvalidValueError
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.disturbances import BoardConditions
import cv2
import numpy as np
import pytest


def table(level=200, size=(240, 320)):
    noise = np.random.default_rng(1).normal(level, 2, (*size, 3))
    return np.clip(np.rint(noise), 0, 255).astype(np.uint8)


def with_ellipse(picture, centre, axes, angle_deg=0.0, level=60):
    picture = picture.copy()
    cv2.ellipse(picture, centre, axes, angle_deg, 0, 360, (level,) * 3, cv2.FILLED)
    return picture


def test_table_without_an_object_gives_nothing():
    assert PreciseDifferenceDetector(table()).detect(table()) == []


@pytest.mark.parametrize('tilt_deg', [0.0, 40.0])
@pytest.mark.parametrize('conditions', [
    BoardConditions(noise=10), BoardConditions(light_drift=-60), BoardConditions(texture=12),
    BoardConditions(table_level=50, contrast=-130), BoardConditions(highlight=True),
    BoardConditions(diameters_cm=(1.24,)), BoardConditions(contrast=70)])
def test_centre_is_right_to_a_tenth_of_a_pixel(conditions, tilt_deg):
    board = SimulatedBoard(**asdict(conditions), tilt_deg=tilt_deg, frame_rate=0.5)
    detector = PreciseDifferenceDetector(board.read())
    for _ in range(15):
        detections = detector.detect(board.read())
        assert len(detections) == 1
        assert math.dist(detections[0].centre, board.true_objects[0].pixel) < 0.1


def test_tilt_is_corrected_on_the_surface():
    board = SimulatedBoard(tilt_deg=40.0, frame_rate=0.5)
    to_surface = board.surface_from_pixel

    def locate(pixels):
        return cv2.perspectiveTransform(pixels[None], to_surface)[0]

    detector = PreciseDifferenceDetector(board.read())
    for _ in range(15):
        detection, = detector.detect(board.read())
        point = object_on_surface(locate, detection).point
        assert math.dist(point, board.true_objects[0].point) < 0.003


def test_object_that_lies_still_stays_an_object():
    detector = PreciseDifferenceDetector(table())
    frame = with_ellipse(table(), (150, 120), (20, 20))
    first = detector.detect(frame)
    for _ in range(50):
        assert detector.detect(frame) == first


def test_darker_lamp_is_no_object():
    frame = cv2.convertScaleAbs(table(), alpha=0.7)
    assert PreciseDifferenceDetector(table()).detect(frame) == []


@pytest.mark.parametrize('step', [6, 15, 60])
def test_object_of_the_first_frame_is_found_once_it_moves(step):
    detector = PreciseDifferenceDetector(with_ellipse(table(), (100, 120), (20, 20)))
    for u in range(100 + step, 220, step):
        detection, = detector.detect(with_ellipse(table(), (u, 120), (20, 20)))
        assert math.dist(detection.centre, (u, 120)) < 0.3


def test_object_of_the_first_frame_that_is_taken_away_leaves_no_ghost():
    detector = PreciseDifferenceDetector(with_ellipse(table(), (100, 120), (20, 20)))
    assert detector.detect(table()) == []


def test_object_that_is_taken_away_is_told_until_it_is_back():
    with_object, empty = with_ellipse(table(), (100, 120), (20, 20)), table()
    detector = PreciseDifferenceDetector(with_object)
    assert detector.detect(with_object) == [] and detector.taken_away == []
    assert detector.detect(empty) == []
    place, = detector.taken_away
    assert math.dist(place.centre, (100, 120)) < 1
    detector.detect(with_object)
    assert detector.taken_away == []


def test_object_that_is_laid_where_another_was_taken_away_is_found_at_once():
    detector = PreciseDifferenceDetector(with_ellipse(table(), (100, 120), (20, 20)))
    detector.detect(table())
    detection, = detector.detect(with_ellipse(table(), (104, 123), (16, 16), level=90))
    assert math.dist(detection.centre, (104, 123)) < 0.3


def printed_board(size=(240, 320)):
    rows, columns = np.mgrid[:size[0], :size[1]] // 48
    board = np.where((rows + columns) % 2 == 0, 60, 220)[:, :, None]
    return np.clip(board + np.random.default_rng(2).normal(0, 2, (*size, 3)), 0, 255).astype(
        np.uint8)


@pytest.mark.parametrize('level', [240, 20, 140])
def test_printed_board_is_no_ghost_and_stays_as_it_is(level):
    board = printed_board()
    detector = PreciseDifferenceDetector(board)
    for centre in [(72, 120), (96, 96), (120, 110), (168, 140)]:
        detector.detect(with_ellipse(board, centre, (20, 20), level=level))
        assert detector.taken_away == []
        assert detector.detect(board) == []


@pytest.mark.parametrize('centre', [(96, 120), (100, 100), (144, 72), (192, 100)])
def test_place_is_in_doubt_where_an_object_goes_on_over_a_print_of_its_colour(centre):
    board = printed_board()
    found = PreciseDifferenceDetector(board).detect(
        with_ellipse(board, centre, (20, 20), level=220))
    assert found
    for one in found:
        off = math.dist(one.centre, centre)
        assert one.doubt > 0.5 and off < 2.5 * one.doubt


@pytest.mark.parametrize('centre', [(96, 120), (144, 72), (192, 100)])
def test_place_is_in_no_doubt_where_a_rim_is_seen_over_a_print(centre):
    board = printed_board()
    found, = PreciseDifferenceDetector(board).detect(
        with_ellipse(board, centre, (20, 20), level=140))
    assert math.dist(found.centre, centre) < 0.5 and found.doubt < 0.5


def test_object_on_a_printed_square_stays_an_object():
    printed = table()
    printed[90:150, 70:130] = 120
    detector = PreciseDifferenceDetector(printed)
    for centre in (100, 120), (75, 120), (130, 95):
        for _ in range(3):
            detection, = detector.detect(with_ellipse(printed, centre, (20, 20), level=30))
            assert math.dist(detection.centre, centre) < 0.5


def test_object_at_the_edge_is_marked_as_cut_off():
    detector = PreciseDifferenceDetector(table())
    assert detector.detect(with_ellipse(table(), (5, 120), (20, 20)))[0].cut_off
    assert not detector.detect(with_ellipse(table(), (60, 120), (20, 20)))[0].cut_off


@pytest.mark.parametrize('angle_deg', [-60.0, 0.0, 35.0, 90.0])
def test_orientation_is_that_of_the_object(angle_deg):
    frame = with_ellipse(table(), (150, 120), (40, 20), angle_deg)
    detection, = PreciseDifferenceDetector(table()).detect(frame)
    turn = math.degrees(detection.orientation) - angle_deg
    assert abs((turn + 90) % 180 - 90) < 1
    assert principal_axes(detection.spread).elongation == pytest.approx(2.0, abs=0.1)


def test_largest_comes_first():
    frame = with_ellipse(with_ellipse(table(), (60, 60), (8, 8)), (200, 120), (20, 20))
    areas = [detection.area for detection in PreciseDifferenceDetector(table()).detect(frame)]
    assert len(areas) == 2 and areas[0] > areas[1]


def test_shadow_alone_comes_after_a_smaller_object():
    # Without a texture: else that tells.
    background = np.full((240, 320, 3), 150, np.uint8)
    crescent, cover = np.zeros((2, *background.shape[:2]), np.uint8)
    cv2.circle(crescent, (108, 96), 40, 1, cv2.FILLED)
    cv2.circle(cover, (90, 84), 40, 1, cv2.FILLED)
    frame = np.where((crescent & (1 - cover))[..., None], 0.7 * background, background)
    frame = with_ellipse(np.uint8(frame), (260, 150), (10, 10))
    found = PreciseDifferenceDetector(background, light_or_thing='publish').detect(frame)
    assert len(found) == 2 and found[0].area < found[1].area
    assert math.dist(found[0].centre, (260, 150)) < 0.5
    assert found[0].doubt == 0 and found[1].doubt > 10


def test_object_before_two_surfaces_is_found_whole():
    background = table(210)
    background[120:] = table(40)[120:]
    frame = background.copy()
    rng = np.random.default_rng(5)
    cv2.circle(frame, (160, 120), 30, (110, 190, 180), cv2.FILLED)
    light = 1.6 - 1.2 * np.arange(240) / 240
    inside = cv2.circle(np.zeros(frame.shape[:2], np.uint8), (160, 120), 30, 1, cv2.FILLED)
    frame[inside > 0] = np.clip((frame * light[:, None, None] + rng.normal(
        0, 2, frame.shape))[inside > 0], 0, 255)
    found, = PreciseDifferenceDetector(background).detect(frame)
    assert math.dist(found.centre, (160, 120)) < 1.5


def test_frame_of_another_size_is_refused():
    with pytest.raises(FrameSizeError, match='320 x 240'):
        PreciseDifferenceDetector(table()).detect(table(size=(120, 160)))


@pytest.mark.parametrize('settings', [{'faintest': -1}, {'faintest': 256}, {'min_area': 0}])
def test_value_out_of_its_range_is_refused(settings):
    with pytest.raises(InvalidValueError):
        PreciseDifferenceDetector(table(), **settings)


def test_plain_object_beside_a_cut_off_one_is_found_once():
    background = np.full((480, 640, 3), 150, np.uint8)
    frame = background.copy()
    cv2.circle(frame, (300, 200), 16, (40, 40, 40), cv2.FILLED)
    frame[:3] = 60
    frame[:215, :6] = 60
    found = PreciseDifferenceDetector(background).detect(frame)
    assert [one.cut_off for one in found] == [True, False]


def test_large_object_whose_shadow_reaches_the_edge_is_found_whole():
    frame = table(size=(480, 640))
    shade = with_ellipse(np.zeros_like(frame), (352, 375), (100, 100), level=255) > 0
    frame[shade] = np.rint(0.65 * frame[shade])
    frame = with_ellipse(frame, (320, 350), (100, 100))
    found = PreciseDifferenceDetector(table(size=(480, 640))).detect(frame)
    assert [one.cut_off for one in found] == [False]
    assert math.dist(found[0].centre, (320, 350)) < 1


def test_parts_of_several_colours_belong_to_their_object():
    frame = table(size=(480, 640))
    for part, colour in ((np.s_[200:260, 250:310], (150, 60, 20)),
                         (np.s_[200:260, 310:350], (165, 185, 205)),
                         (np.s_[260:300, 250:350], (60, 70, 180))):
        frame[part] = colour
    found, = PreciseDifferenceDetector(table(size=(480, 640))).detect(frame)
    assert found.box[2:] == (100, 100) and found.area == pytest.approx(10000, rel=0.12)


def test_large_object_with_a_highlight_near_its_rim_is_placed():
    frame = with_ellipse(table(217, (480, 640)), (320, 240), (60, 60), level=104)
    rows, columns = np.mgrid[:480, :640]
    spot = 1.68 * np.exp(-((rows - 219) ** 2 + (columns - 299) ** 2) / (2 * 13.2 ** 2))
    inside = (rows - 240) ** 2 + (columns - 320) ** 2 < 60.5 ** 2
    light = (frame / 255) ** 2.2 + (spot * inside)[..., None]
    light = cv2.GaussianBlur(light, (0, 0), 0.9)
    frame = np.uint8(np.clip(255 * light ** (1 / 2.2), 0, 255))
    found, = PreciseDifferenceDetector(table(217, (480, 640))).detect(frame)
    assert math.dist(found.centre, (320, 240)) < 0.5


def test_object_that_appears_beside_one_that_rests_is_found_at_once():
    detector, one = PreciseDifferenceDetector(table()), with_ellipse(table(), (60, 120), (20, 20))
    for _ in range(3):
        assert len(detector.detect(one)) == 1
    for centre in (160, 120), (300, 125):
        assert len(detector.detect(with_ellipse(one, centre, (15, 15)))) == 2
        assert len(detector.detect(one)) == 1
