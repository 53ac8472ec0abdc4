# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What is a thing and what is light, on tables with a texture and without one."""

import math

from camera_to_base.detection import Box, PreciseDifferenceDetector
from camera_to_base.detection.precise.evidence import Detail
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.search import _dropped
import cv2
from lit_table import (
    coded, covered, detect, disc, overlap, painted, ring, shaded, SIZE, TABLE)
import numpy as np
import pytest


def table(texture):
    grain = np.random.default_rng(3).normal(0, 1, SIZE)
    grain = cv2.GaussianBlur(grain, (0, 0), 3, sigmaY=1)
    return TABLE * (1 + texture * grain / grain.std())[..., None].astype(np.float32)


def square(u, v, half):
    return covered((u - half, v - half), (u + half, v - half), (u + half, v + half),
                   (u - half, v + half))


def box_with_a_wall(light, u=150, v=120, colour=(0.5, 0.12, 0.1), depth=0.5, wall=0.35):
    light = shaded(light, covered((u - 20, v - 20), (u + 30, v - 20), (u + 70, v + 45),
                                  (u + 20, v + 45)), depth)
    light = painted(light, square(u, v, 22), np.float32(colour))
    return painted(light, covered((u - 22, v + 22), (u + 22, v + 22), (u + 18, v + 40),
                                  (u - 18, v + 40)), wall * np.float32(colour))


def silhouette(u=150, v=120):
    wall = covered((u - 22, v + 22), (u + 22, v + 22), (u + 18, v + 40), (u - 18, v + 40))
    return (np.maximum(square(u, v, 22), wall) > 0.5)[..., 0]


def shaded_to_the_right(light, depth=0.5):
    return shaded(light, covered((140, 110), (172, 98), (215, 130), (180, 175), (130, 150)), depth)


@pytest.mark.parametrize('colour, width', [
    ((0.05, 0.2, 0.04), 2.5), ((0.06, 0.2, 0.42), 2.5), ((0.06, 0.2, 0.42), 1)])
@pytest.mark.parametrize('radius', [9, 16])
def test_narrow_shade_of_a_flat_coloured_thing_is_no_part_of_it(colour, width, radius):
    # The shade is so narrow that it is seen alone nowhere beside the thing.
    background = np.full((*SIZE, 3), 0.42, np.float32)
    light = shaded(background, disc(150 + width, 120 + 0.8 * width, radius), 0.6)
    coin = disc(150, 120, radius)
    found = detect(painted(light, coin, colour), background)
    moments = cv2.moments(coin)
    true = moments['m10'] / moments['m00'], moments['m01'] / moments['m00']
    assert len(found) == 1 and np.hypot(*np.subtract(found[0].centre, true)) < 0.35
    assert overlap(found[0], np.uint8(coin[..., 0] > 0.5)) > 0.92


def test_dark_wall_ends_where_it_stands_though_the_top_is_far_lighter():
    # In its shade, the wall's red is nearer to the table's than to the top's.
    background = np.full((*SIZE, 3), 0.48, np.float32)
    light = box_with_a_wall(background, colour=(0.03, 0.03, 0.58), depth=0.72, wall=0.27)
    found = detect(light, background)
    true = silhouette()
    assert len(found) == 1 and overlap(found[0], true) > 0.97
    place = np.argwhere(true).mean(axis=0)[::-1]
    assert np.hypot(*np.subtract(found[0].centre, place)) < 0.3


def compression(*pictures):
    reference = Reference(pictures[0], 13.0)
    reference.follow(pictures[1])
    return reference.noise[1].compression


def test_what_neighbours_have_alike_tells_of_compression():
    raw = (np.random.default_rng(seed).normal(120, 1.5, (*SIZE, 3)) for seed in range(2))
    assert compression(*(np.uint8(np.rint(one)) for one in raw)) < 0.1
    assert 0.4 < compression(*(coded(table(0), seed, 85) for seed in range(2))) < 0.8
    assert compression(*(coded(table(0), seed, 85, 0.5) for seed in range(2))) == 1


@pytest.mark.parametrize('depth', [10, 16])
def test_jpeg_does_not_join_a_coloured_wall_and_its_shades(depth):
    background = np.full((*SIZE, 3), 0.45, np.float32)
    light = shaded(background, covered((130, 110), (170, 110), (186, 144), (174, 156 + depth),
                                       (146, 156 + depth)), 0.35)
    light = shaded(light, covered((130, 110), (170, 110), (170, 142 + depth), (126, 152 + depth),
                                  (114, 140)), 0.2)
    wall = covered((128, 142), (172, 142), (171, 142 + depth), (129, 142 + depth))
    orange = np.float32((0.03, 0.2, 0.7))
    light = painted(painted(light, square(150, 120, 22), orange), wall, 0.25 * orange)
    true = (np.maximum(square(150, 120, 22), wall) > 0.5)[..., 0]
    taken = np.mean([coded(background, 100 + number) for number in range(8)], axis=0)
    detector = PreciseDifferenceDetector(np.uint8(np.rint(taken)))
    for seed in range(3):
        found, = detector.detect(coded(light, seed))
        assert overlap(found, true) > 0.97


@pytest.mark.parametrize('colour', [(0.2, 0.33, 0.4), (0.25, 0.3, 0.4)])
def test_shade_is_no_side_of_a_thing_of_another_chroma_however_pale(colour):
    # It is hardly softer than the thing's edge.
    background = np.full((*SIZE, 3), 0.33, np.float32)
    shade = covered((128, 98), (172, 98), (172, 142), (142, 155), (98, 155), (98, 111))
    shade = cv2.GaussianBlur(shade[..., 0], (0, 0), 1)[..., None]
    light = painted(background * (1 - 0.3 * shade), square(150, 120, 22), colour)
    taken = np.mean([coded(background, 100 + number) for number in range(8)], axis=0)
    detector = PreciseDifferenceDetector(np.uint8(np.rint(taken)))
    found = [one for seed in range(8) for one in detector.detect(coded(light, seed))]
    assert len(found) == 8 and not any(one.doubt for one in found)
    for one in found:
        assert np.hypot(*np.subtract(one.centre, (150, 120))) < 1


def test_centre_is_in_no_doubt_where_colours_are_clear():
    found, = detect(box_with_a_wall(table(0.15)), table(0.15))
    assert not found.doubt


@pytest.mark.parametrize('colour', [(0.5, 0.12, 0.1), (0.4, 0.4, 0.42), (0.8, 0.8, 0.8)])
def test_wall_belongs_to_a_box_and_its_shade_does_not(colour):
    found, = detect(box_with_a_wall(table(0.15), colour=colour), table(0.15))
    assert overlap(found, silhouette()) > 0.95


@pytest.mark.parametrize('depth', [20, 8])
def test_wall_that_is_darker_than_any_shade_belongs_to_its_top(depth):
    light = painted(table(0), square(150, 120, 22), 0.2 * TABLE)
    wall = covered((128, 142), (172, 142), (172, 142 + depth), (128, 142 + depth))
    found, = detect(painted(light, wall, 0.11 * TABLE), table(0))
    assert found.centre == pytest.approx((149.5, 119.5 + depth / 2), abs=0.5)


@pytest.mark.parametrize('table_light', [(0.1, 0.095, 0.115), (0.3, 0.27, 0.25)])
@pytest.mark.parametrize('top, wall, depth', [(1.6, 1.3, 6), (1.6, 1.3, 10), (2.2, 1.1, 6)])
def test_wall_of_a_grey_box_has_its_chroma_and_not_that_of_a_hardly_coloured_table(
        table_light, top, wall, depth):
    background = np.full((*SIZE, 3), table_light, np.float32)
    grey = np.full(3, np.mean(table_light), np.float32)
    light = painted(shaded_to_the_right(background, 0.35), square(150, 120, 22), top * grey)
    side = covered((128, 142), (172, 142), (170, 142 + depth), (130, 142 + depth))
    found, = detect(painted(light, side, wall * grey), background, 85)
    assert overlap(found, (np.maximum(square(150, 120, 22), side) > 0.5)[..., 0]) > 0.95


@pytest.mark.parametrize('table_light', [(0.1, 0.095, 0.115), (0.3, 0.27, 0.25)])
@pytest.mark.parametrize('top, wall', [(1.6, 1.2), (2.2, 1.2)])
@pytest.mark.parametrize('slope, height', [(0.2, 12), (0.5, 24)])
def test_round_wall_of_a_grey_cylinder_is_no_shade_though_its_level_is_from_sun_to_shade(
        table_light, top, wall, slope, height):
    background = np.full((*SIZE, 3), table_light, np.float32)
    grey = np.full(3, np.mean(table_light), np.float32)
    ends = np.float32([*ring(150, 120, 20), *ring(150, 120 + height, 18)])
    body = covered(*cv2.convexHull(ends)[:, 0])
    darker = 1 - slope * (np.arange(SIZE[1], dtype=np.float32)[None, :, None] - 150) / 20
    light = painted(shaded_to_the_right(background, 0.35), body, wall * grey * darker)
    found, = detect(painted(light, disc(150, 120, 20), top * grey), background, 85)
    assert overlap(found, (body > 0.5)[..., 0]) > 0.9


@pytest.mark.parametrize('brightness', [0.35, 0.6])
def test_thing_as_dark_as_its_shade_ends_where_its_edges_are_sharp(brightness):
    light = shaded_to_the_right(table(0))
    found, = detect(painted(light, square(150, 120, 22), brightness * TABLE), table(0))
    assert overlap(found, square(150, 120, 22)[..., 0] > 0.5) > 0.93


def test_two_boxes_whose_shades_overlap_are_two():
    light = table(0.15)
    for u in 100, 160:
        light = box_with_a_wall(light, u)
    found = detect(light, table(0.15))
    assert len(found) == 2
    for u in 100, 160:
        assert max(overlap(one, silhouette(u)) for one in found) > 0.93


@pytest.mark.parametrize('depth, tint', [
    (0.5, (1, 1, 1)), (0.3, (1.05, 1, 0.97)), (-0.6, (1, 1, 1))])
def test_shade_and_sun_on_a_texture_are_nothing(depth, tint):
    light = shaded(table(0.15), square(150, 120, 40), depth, tint)
    assert detect(light, table(0.15)) == []


def test_sheet_without_a_texture_that_is_as_dark_as_shade_is_a_thing():
    light = painted(table(0.15), square(150, 120, 40), 0.5 * TABLE)
    found, = detect(light, table(0.15))
    assert found.centre == pytest.approx((149.5, 119.5), abs=0.3)


@pytest.mark.parametrize('gap', [2, 3, 4, 6])
def test_things_with_a_gap_are_two(gap):
    light = table(0.1)
    for u in 100, 140 + gap:
        light = painted(light, square(u, 120, 20), (0.1, 0.5, 0.3))
    found = sorted(detect(light, table(0.1)), key=lambda one: one.centre.u)
    assert [one.centre.u for one in found] == pytest.approx([99.5, 139.5 + gap], abs=0.3)


@pytest.mark.parametrize('gain', [0.7, 0.85, 1.15])
@pytest.mark.parametrize('texture', [0.0, 0.1])
def test_smooth_light_in_the_middle_is_nothing_and_hides_no_coin(gain, texture):
    v, u = np.mgrid[:SIZE[0], :SIZE[1]].astype(np.float32)
    lobe = 1 + (gain - 1) * np.exp(-((u - 150) ** 2 + (v - 120) ** 2) / 2 / 40 ** 2)[..., None]
    light = painted(table(texture), square(180, 130, 12), (0.1, 0.2, 0.6)) * lobe
    found, = detect(light, table(texture))
    assert found.centre == pytest.approx((179.5, 129.5), abs=0.3)


def test_shade_that_reaches_the_edge_is_nothing():
    light = shaded(table(0.15), covered((0, 60), (150, 90), (120, 140), (0, 120)))
    assert detect(light, table(0.15)) == []


def test_what_is_no_object_is_named():
    light = shaded(table(0.15), square(80, 120, 30))
    light = shaded(light, square(220, 120, 40), -0.6)
    light = painted(light, covered((150, 30), (152, 30), (152, 33), (150, 33)), (0.9, 0.1, 0.1))
    detector = PreciseDifferenceDetector(coded(table(0.15), 1))
    assert detector.detect(coded(light, 2)) == []
    found = detector.dropped
    assert [one.kind for one in found] == ['light', 'shade', 'speck']
    assert found[0].position == pytest.approx((219.5, 119.5), abs=3)
    assert found[1].position == pytest.approx((79.5, 119.5), abs=3)
    assert found[1].area == pytest.approx(60 * 60, rel=0.2)


@pytest.mark.parametrize('colour, kind', [
    (0.5 * TABLE, 'shade'), (1.5 * TABLE, 'light'),
    ((0.05, 0.05, 0.4), 'light_or_thing'), ((0.02, 0.02, 0.02), 'light_or_thing')])
def test_what_is_left_over_and_is_no_light_is_not_said_to_be_light(colour, kind):
    lit = coded(table(0), 1)
    frame = coded(painted(table(0), square(150, 120, 20), colour), 2)
    left = np.zeros(SIZE, np.uint8)
    left[96:145, 126:175] = 255
    one, = _dropped(frame, lit, left, Box(100, 70, 120, 120), 30)
    assert one.kind == kind and one.area == 49 * 49
    # A rim that compression has coloured tells nothing.
    left[99:142, 129:172] = 0
    one, = _dropped(frame, lit, left, Box(100, 70, 120, 120), 30)
    assert one.kind != 'light_or_thing'


def test_nothing_is_dropped_from_an_object_without_shade():
    detector = PreciseDifferenceDetector(coded(table(0.15), 1))
    light = painted(table(0.15), square(150, 120, 20), (0.1, 0.5, 0.3))
    assert len(detector.detect(coded(light, 2))) == 1
    assert detector.dropped == []
    detector.detect(coded(table(0.15), 3))
    assert detector.dropped == []


def shade_of_something_that_looks_like_the_table():
    soft = cv2.GaussianBlur(covered((140, 80), (175, 80), (200, 150), (165, 150)), (0, 0), 2.5)
    light = table(0) * (1 - 0.5 * soft)[..., None]
    return painted(light, square(150, 80, 20), TABLE)


def test_shade_beside_what_looks_like_the_table_is_left_out_as_light_or_thing():
    detector = PreciseDifferenceDetector(coded(table(0), 1))
    assert detector.detect(coded(shade_of_something_that_looks_like_the_table(), 2)) == []
    assert 'light_or_thing' in [one.kind for one in detector.dropped]


def test_what_is_light_or_a_thing_is_published_in_doubt_where_that_is_wanted():
    detector = PreciseDifferenceDetector(coded(table(0), 1), light_or_thing='publish')
    found, = detector.detect(coded(shade_of_something_that_looks_like_the_table(), 2))
    assert found.doubt > 20
    assert 'light_or_thing' not in [one.kind for one in detector.dropped]


@pytest.mark.parametrize('gain', [
    (2.2, 2.2, 2.2), (1.5, 1.55, 1.45), (0.6, 0.6, 0.6), (0.42, 0.4, 0.39)])
@pytest.mark.parametrize('colour', [(0.045, 0.2, 0.02), (0.3, 0.08, 0.05)])
def test_sharp_light_on_a_coloured_table_may_be_light(gain, colour):
    felt = np.full((*SIZE, 3), colour, np.float32)
    patch = covered((60, 60), (150, 40), (170, 130), (80, 150))
    light = painted(felt * (1 + (np.float32(gain) - 1) * patch), square(250, 180, 15), 0.15)
    detector = PreciseDifferenceDetector(coded(felt, 1))
    found, = detector.detect(coded(light, 2))
    assert found.centre == pytest.approx((249.6, 179.6), abs=0.2)
    assert [one.kind for one in detector.dropped if one.area > 100] == ['light_or_thing']


@pytest.mark.parametrize('colour', [(0.045, 0.2, 0.02), (0.3, 0.08, 0.05), (0.28, 0.42, 0.55)])
@pytest.mark.parametrize('strength, lamp', [(0.08, (1, 1, 1)), (0.25, (0.97, 1, 1.03))])
def test_lamp_that_is_mirrored_by_a_coloured_table_is_no_object(colour, strength, lamp):
    felt = np.full((*SIZE, 3), colour, np.float32)
    image = cv2.GaussianBlur(covered((60, 60), (150, 40), (170, 130), (80, 150)), (0, 0), 5)
    light = painted(felt, square(250, 180, 15), 0.02) + (
        strength * np.float32(lamp) * image[..., None])
    detector = PreciseDifferenceDetector(coded(felt, 1))
    found, = detector.detect(coded(light, 2))
    assert found.centre == pytest.approx((249.6, 179.6), abs=0.2)
    assert max(detector.dropped, key=lambda one: one.area).kind in ('light', 'light_or_thing')


@pytest.mark.parametrize('thing', [
    (0.02, 0.02, 0.02), (0.3, 0.3, 0.3), (0.045, 0.2, 0.08), (0.8, 0.8, 0.8)])
def test_thing_of_another_colour_on_a_coloured_table_is_found(thing):
    felt = np.full((*SIZE, 3), (0.045, 0.2, 0.02), np.float32)
    detector = PreciseDifferenceDetector(coded(felt, 1))
    found, = detector.detect(coded(painted(felt, square(150, 120, 25), thing), 2))
    assert found.centre == pytest.approx((149.6, 119.6), abs=0.2)


BOXES = (60, 60), (210, 150)


def boxes(*places):
    light = table(0.15)
    for place in places:
        light = box_with_a_wall(light, *place)
    return light


def test_what_the_budget_does_not_reach_is_named_and_looked_at_on_one_of_the_next_frames():
    detector = PreciseDifferenceDetector(coded(table(0.15), 1), budget_px=10000)
    for seed in range(2, 5):
        assert len(detector.detect(coded(boxes(*BOXES), seed))) == 1
        assert [one.kind for one in detector.dropped].count('too_much') == 1
    # What lies still costs nothing then.
    assert len(detector.detect(coded(boxes(*BOXES), 5))) == 2
    assert 'too_much' not in [one.kind for one in detector.dropped]


@pytest.mark.parametrize('place, other', [BOXES, BOXES[::-1]])
def test_objects_of_the_last_frame_come_first(place, other):
    detector = PreciseDifferenceDetector(coded(table(0.15), 1), budget_px=10000)
    detector.detect(coded(boxes(place), 3))
    for step in 3, 6, 9:
        # It moves, so that it must be looked at again.
        moved = place[0] + step, place[1]
        found, = detector.detect(coded(boxes(moved, other), 4 + step))
        assert overlap(found, silhouette(*moved)) > 0.9


@pytest.mark.parametrize('u, v', [(144, 96), (110, 120), (125, 140)])
def test_thing_on_printed_squares_is_no_light(u, v):
    rows, columns = np.mgrid[:SIZE[0], :SIZE[1]] // 48 % 2
    printed = np.where(rows == columns, 0.16, 1.5)[..., None] * np.float32([0.45, 0.48, 0.5])
    found, = detect(painted(printed, square(u, v, 18), (0.04, 0.15, 0.6)), printed)
    assert found.centre == pytest.approx((u - 0.5, v - 0.5), abs=1)


def video(light, seed):
    # What a video leaves of noise: hardly any from pixel to pixel, more from block to block.
    drift = np.random.default_rng(seed).normal(0, 1.5, (SIZE[0] // 8, SIZE[1] // 8, 3))
    grey = 255 * np.clip(light, 0, 1) ** (1 / 2.2) + cv2.resize(np.float32(drift), SIZE[::-1])
    jpeg = cv2.imencode('.jpg', np.uint8(np.clip(np.rint(grey), 0, 255)))[1]
    return cv2.imdecode(jpeg, cv2.IMREAD_COLOR)


def ball(light, u, v, colour):
    y, x = np.mgrid[:SIZE[0], :SIZE[1]]
    far = np.hypot(x - u, y - v)
    light = light * (1 - 0.5 * np.exp(-(far / 26) ** 2))[..., None].astype(np.float32)
    return painted(light, np.clip(16.5 - far, 0, 1)[..., None].astype(np.float32), colour)


@pytest.mark.parametrize('colours', [
    ([0.1, 0.08, 0.6], [0.5, 0.2, 0.05]), ([1.2, 1.2, 1.2], [0.1, 0.08, 0.6]),
    ([1.2, 1.2, 1.2], [0.01, 0.01, 0.01])])
def test_balls_whose_soft_shades_are_one_are_two_also_in_a_video(colours):
    background = np.full((*SIZE, 3), 0.16, np.float32)
    light = background
    for u, colour in zip((130, 190), colours):
        light = ball(light, u, 120, colour)
    found = PreciseDifferenceDetector(video(background, 1)).detect(video(light, 2))
    assert sorted(round(one.centre.u / 10) for one in found) == [13, 19]
    assert all(abs(one.centre.v - 120) < 2 for one in found)


def test_thing_in_the_shade_of_an_arm_is_found_apart_from_the_arm():
    background = np.full((*SIZE, 3), 0.16, np.float32)
    arm = covered((0, 60), (150, 90), (150, 120), (0, 130))
    light = background * (1 - 0.5 * cv2.GaussianBlur(arm, (0, 0), 20))[..., None]
    light = ball(painted(light, arm, [0.5, 0.3, 0.15]), 120, 160, [0.1, 0.08, 0.6])
    found = PreciseDifferenceDetector(video(background, 1)).detect(video(light, 2))
    assert [one.cut_off for one in found].count(True) == 1
    apart, = [one for one in found if not one.cut_off]
    assert abs(apart.centre.u - 120) < 2 and abs(apart.centre.v - 160) < 2


@pytest.mark.parametrize('place', [(160, 120), (157, 113), (70, 128)])
@pytest.mark.parametrize('width', [2, 3])
def test_stone_that_is_as_black_as_the_lines_below_it_is_one(place, width):
    black, lines = np.float32([0.02, 0.02, 0.02]), np.zeros(SIZE, np.uint8)
    for at in range(10, 320, 30):
        cv2.line(lines, (at, 0), (at, SIZE[0]), 255, width)
        cv2.line(lines, (0, at), (SIZE[1], at), 255, width)
    board = painted(table(0.05), lines[..., None] / np.float32(255), black)
    stone = np.zeros(SIZE, np.uint8)
    cv2.circle(stone, place, 20, 255, cv2.FILLED, cv2.LINE_AA)
    frame = coded(painted(board, stone[..., None] / np.float32(255), black), 2)
    found, = PreciseDifferenceDetector(coded(board, 1)).detect(frame)
    # Where a line leads away from its rim, the rim is not seen.
    assert tuple(found.centre) == pytest.approx(place, abs=2)


@pytest.mark.parametrize('gain', [0.4, 0.65, 1.4, 1.7])
@pytest.mark.parametrize('texture', [0.02, 0.05])
def test_sharp_sun_or_shade_on_a_table_with_the_faintest_texture_is_no_object(gain, texture):
    background = table(texture)
    patch = covered((90, 60), (230, 90), (200, 190), (80, 160))
    assert detect(background * (1 + (gain - 1) * patch), background) == []


@pytest.mark.parametrize('gain', [0.5, 0.7])
def test_shade_that_ends_at_a_print_is_no_object(gain):
    background = np.float32(TABLE * np.ones((*SIZE, 3)))
    for u in range(20, 320, 60):
        for v in range(20, 240, 60):
            background = painted(background, square(u, v, 15), [0.03, 0.03, 0.03])
    patch = covered((63, 20), (197, 20), (197, 200), (63, 200))
    assert detect(background * (1 + (gain - 1) * patch), background) == []


@pytest.mark.parametrize('stripe', [(0.05, 0.04, 0.2), (0.45, 0.2, 0.08), (0.1, 0.3, 0.1)])
@pytest.mark.parametrize('grey', [0.16, 0.3])
@pytest.mark.parametrize('photograph', [coded, video])
def test_ball_with_a_stripe_is_one(stripe, grey, photograph):
    background = np.full((*SIZE, 3), grey, np.float32)
    y, x = np.mgrid[:SIZE[0], :SIZE[1]]
    for light in (ball(background, 150, 120, [1.0, 1.0, 1.0]),
                  painted(background, (np.hypot(x - 150, y - 120) < 16)[..., None], 1.0)):
        light[(np.hypot(x - 150, y - 120) < 16) & (np.abs(y - x + 30) < 5)] = stripe
        found, = PreciseDifferenceDetector(photograph(background, 1)).detect(
            photograph(cv2.GaussianBlur(light, (0, 0), 0.7), 2))
        assert found.centre == pytest.approx((150, 120), abs=1)


def test_fleck_with_a_faint_halo_may_be_light():
    rows, columns = np.mgrid[:240, :320]
    halo = 9.0 * (np.hypot(rows - 120, columns - 150) < 13)[..., None] * np.float32([1, 0.2, 1])
    fleck = 20.0 * (np.abs(rows - 120) + np.abs(columns - 150) < 5)[..., None]
    background = np.full((240, 320, 3), (60, 140, 100), np.uint8)
    detector = PreciseDifferenceDetector(background)
    assert detector.detect(np.uint8(background + halo + fleck)) == []
    assert detector.dropped[0].kind == 'light_or_thing'


@pytest.mark.parametrize('pushed', [(3, 0), (2, -3)])
def test_print_that_was_pushed_is_no_object_and_hides_none(pushed):
    lines = np.zeros(SIZE, np.uint8)
    for at in range(10, 140, 30):
        cv2.line(lines, (at, 0), (at, SIZE[0]), 255, 2)
        cv2.line(lines, (0, at), (150, at), 255, 2)
    dark = np.float32([0.04, 0.04, 0.05])
    background = np.where(lines[..., None] > 0, dark, np.float32(TABLE))
    moved = cv2.warpAffine(
        background, np.float32([[1, 0, pushed[0]], [0, 1, pushed[1]]]), SIZE[::-1],
        borderMode=cv2.BORDER_REPLICATE)
    assert detect(moved, background) == []
    found, = detect(painted(moved, square(100, 105, 12), (0.1, 0.2, 0.7)), background)
    assert found.centre == pytest.approx((99.5, 104.5), abs=1.5)


def test_edge_of_a_print_that_a_camera_sharpens_more_is_no_object():
    background = np.full((*SIZE, 3), 100, np.uint8)
    background[:, 160:] = 200
    on_edge, beside = background.copy(), background.copy()
    on_edge[60:180, 160:161] = beside[60:180, 220:221] = 226
    detector = PreciseDifferenceDetector(background)
    assert detector.detect(on_edge) == [] and detector.dropped == []
    assert detector.detect(beside) or detector.dropped


def test_square_of_a_board_in_a_little_other_light_is_no_thing_that_has_left():
    squares = np.kron(np.indices((6, 8)).sum(axis=0) % 2, np.ones((40, 40)))[..., None]
    green = np.full((*SIZE, 3), (0.06, 0.25, 0.1), np.float32)
    board = painted(green, squares, (0.03, 0.05, 0.5))
    light = board * (1 - 0.15 * square(140, 100, 19)) * (1 + 0.25 * square(140, 100, 3))
    detector = PreciseDifferenceDetector(coded(board, 1))
    assert detector.detect(coded(light, 2)) == []
    assert detector.taken_away == []


def hard_lamp_cell(background, colours, depth=0.27, wall=10):
    # A lamp at the upper left; a wall, so many px high, lies in its own shade.
    light = background
    for index, colour in enumerate(colours):
        u, v = 70 + 90 * (index % 3), 60 + 100 * (index // 3)
        shade = covered((u - 15, v + 17), (u + 15, v - 15), (u + 42, v + 12), (u + 42, v + 42),
                        (u + 12, v + 42))
        light = light * (1 - (1 - depth) * shade)
        light = painted(light, foot(u, v, wall), 0.25 * np.float32(colour))
        light = painted(light, square(u, v, 15), colour)
    return light


def foot(u, v, wall):
    return covered((u - 15, v + 15), (u + 15, v + 15), (u + 15 + wall / 3, v + 15 + wall),
                   (u - 15 + wall / 3, v + 15 + wall))


def off(found, u, v, wall):
    true = np.maximum(square(u, v, 15), foot(u, v, wall))[..., 0] > 0.5
    return np.hypot(*np.subtract(found.centre, np.argwhere(true).mean(axis=0)[::-1]))


@pytest.mark.parametrize('grey', [0.2, 0.25, 0.3])
def test_shade_of_coloured_things_tells_a_grey_one_from_its_own(grey):
    background = np.full((*SIZE, 3), 0.45, np.float32)
    colours = [(0.05, 0.08, 0.5), (0.06, 0.3, 0.05), (grey,) * 3, (0.5, 0.1, 0.06)]
    found = detect(hard_lamp_cell(background, colours), background)
    assert len(found) == 4
    grey_one, = [one for one in found if one.centre[0] > 230 and one.centre[1] < 110]
    true = np.maximum(square(250, 60, 15), foot(250, 60, 10))
    assert overlap(grey_one, (true > 0.5)[..., 0]) > 0.93


def test_centre_is_in_doubt_where_either_face_of_a_grey_thing_may_be_a_hard_shade():
    background = np.full((*SIZE, 3), 0.45, np.float32)
    found, = detect(hard_lamp_cell(background, [(0.2,) * 3]), background)
    assert off(found, 70, 60, 10) < 2.5 * found.doubt


@pytest.mark.parametrize('table_light, other, grey, wall', [
    (0.45, (0.02,) * 3, 0.15, 10), (0.45, (0.02,) * 3, 0.2, 10), (0.45, (0.02,) * 3, 0.25, 10),
    (0.6, (0.05, 0.08, 0.5), 0.2, 6)])
def test_hard_shade_is_no_side_of_a_grey_thing(table_light, other, grey, wall):
    background = np.full((*SIZE, 3), table_light, np.float32)
    found = detect(hard_lamp_cell(background, [other, (grey,) * 3], wall=wall), background)
    assert min(off(one, 160, 60, wall) for one in found) < 1


@pytest.mark.parametrize('other', [(0.02,) * 3, (0.05, 0.08, 0.5)])
def test_centre_is_in_doubt_where_a_grey_face_is_just_as_dark_as_a_hard_shade(other):
    background = np.full((*SIZE, 3), 0.45, np.float32)
    found = detect(hard_lamp_cell(background, [other, (0.2,) * 3], depth=0.4), background)
    grey, = [one for one in found if one.centre[0] > 115]
    assert off(grey, 160, 60, 10) < 2.5 * grey.doubt


def steel_bolt(seed):
    # Its sides are far darker than its highlight, and as grey as the table is dark.
    rng = np.random.default_rng(seed)
    grain = cv2.GaussianBlur(rng.normal(0, 1, SIZE), (0, 0), 6, sigmaY=1.5)
    wood = 10 ** rng.uniform(-2.3, -1.3) * np.exp(rng.uniform(0.2, 0.6) * grain / grain.std())
    wood = np.float32(wood)[..., None] * np.float32([0.8, 0.9, 1.1])
    turn, half, length = rng.uniform(0, np.pi), rng.uniform(5, 8), rng.uniform(30, 50)
    along, across = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])

    def part(middle, length, half):
        u, v = length * along, half * across
        return covered(*(np.array([160, 120]) + middle * along + corner for corner in (
            -u - v, u - v, u + v, v - u)))

    rows, columns = np.mgrid[:SIZE[0], :SIZE[1]]
    away = (columns - 160) * across[0] + (rows - 120) * across[1]
    steel = rng.uniform(0.08, 0.25) + rng.uniform(0.1, 0.6) * np.exp(
        -((away - rng.uniform(-0.5, 0.5) * half) / (half * rng.uniform(0.25, 0.5))) ** 2)
    shares = np.maximum(part(0, length, half), part(-length, 7, half + 5))
    return wood, painted(wood, shares, np.float32(steel)[..., None]), shares[..., 0] > 0.5


@pytest.mark.parametrize(
    'seed', [50, 90, 97, 120, 155, 162, 221, 228, 291, 622, *range(400, 405), 682, 721, 1266])
def test_shiny_bolt_on_a_dark_table_is_more_than_its_highlight(seed):
    wood, light, true = steel_bolt(seed)
    found, = detect(light, wood, 85)
    place = np.argwhere(true).mean(axis=0)[::-1]
    assert np.hypot(*np.subtract(found.centre, place)) < 1.5


def pale_box_on_wood(seed, texture):
    # Its side lies in its own shade, and is about as dark as that of a hard lamp.
    rng, grain = np.random.default_rng(seed), np.random.default_rng(3).normal(0, 1, SIZE)
    grain = cv2.GaussianBlur(grain, (0, 0), 8, sigmaY=1.5)
    wood = 0.3 * (1 + texture * grain / grain.std())[..., None] * np.ones(3)
    top, side, depth, wall = (
        rng.uniform(*ends) for ends in ((0.5, 0.9), (0.05, 0.2), (0.25, 0.45), (10, 25)))
    shade = covered((135, 137), (165, 105), (200, 135), (200, 170), (170, 172))
    light = painted(wood * (1 - (1 - depth) * shade), foot(150, 120, wall), (side,) * 3)
    true = np.maximum(square(150, 120, 15), foot(150, 120, wall))[..., 0] > 0.5
    return wood, painted(light, square(150, 120, 15), (top,) * 3), true


@pytest.mark.parametrize('texture', [0.15, 0.3])
@pytest.mark.parametrize('seed', [2, 6, 22, 24, 30, 54])
def test_texture_tells_a_side_from_a_shade_that_is_as_dark(seed, texture):
    wood, light, true = pale_box_on_wood(seed, texture)
    found, = detect(light, wood, 85)
    place = np.argwhere(true).mean(axis=0)[::-1]
    assert overlap(found, true) > 0.85
    assert np.hypot(*np.subtract(found.centre, place)) < 1.5


@pytest.mark.parametrize('texture', [0, 0.03])
@pytest.mark.parametrize('seed', range(300, 306))
def test_centre_is_in_doubt_where_a_side_may_be_shade_and_no_texture_tells(seed, texture):
    wood, light, true = pale_box_on_wood(seed, texture)
    found, = detect(light, wood, 85)
    place = np.argwhere(true).mean(axis=0)[::-1]
    assert np.hypot(*np.subtract(found.centre, place)) < 2.5 * found.doubt + 1


def small_box_below_two_lamps(seed):
    # Coloured on white, or grey on wood; its shades are as narrow as JPEG's blocks.
    rng = np.random.default_rng(seed)
    half, turn = rng.uniform(8, 14), rng.uniform(0, np.pi)
    along, across = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) * half
    box = (160, 120) + np.array([-along - 0.6 * across, along - 0.6 * across,
                                 along + 0.6 * across, 0.6 * across - along])
    background = np.full((*SIZE, 3), 0.8, np.float32)
    background *= np.float32((1, 1, 1) if seed % 2 else (0.12, 0.35, 0.75))
    light = background
    for _ in range(2):
        angle, far, depth = (rng.uniform(*ends) for ends in (
            (0, 2 * np.pi), (5, 9), (0.1, 0.3)))
        way = far * np.array([np.cos(angle), np.sin(angle)])
        shade = sum(np.maximum(covered(*(box + part * way)), covered(*(box + part / 2 * way)))
                    for part in (0.6, 0.8, 1, 1.2, 1.4)) / 5
        light = light * (1 - depth * shade)
    colours = (0.05, 0.25, 0.8), (0.5, 0.08, 0.03), (0.05, 0.4, 0.1)
    colour = colours[rng.integers(3)] if seed % 2 else (0.35,) * 3
    return background, painted(light, covered(*box), colour), covered(*box)[..., 0] > 0.5


@pytest.mark.parametrize('seed, quality, noise', [
    *((seed, 75, 1.2) for seed in (9, 37, 45, 50, 84, 97, 101, 114)), (273, 85, 1.5)])
def test_jpeg_joins_no_narrow_shade_to_a_thing(seed, quality, noise):
    background, light, true = small_box_below_two_lamps(seed)
    detector = PreciseDifferenceDetector(coded(background, 1, quality, noise))
    found, = detector.detect(coded(light, 2, quality, noise))
    place = np.argwhere(true).mean(axis=0)[::-1]
    assert np.hypot(*np.subtract(found.centre, place)) < 1


@pytest.mark.parametrize('seed', range(3))
def test_dark_coin_without_a_flat_part_of_its_own_is_found_beside_a_light_one(seed):
    turn = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    way = 15 * np.array([np.cos(turn), np.sin(turn)])
    light, places = table(0.1), [(160, 120) + way, (160, 120) - way]
    for place, colour in zip(places, (0.85, 0.04)):
        light = painted(light, disc(*place, 12), (colour,) * 3)
    found = detect(light, table(0.1), 70)
    assert len(found) == 2
    for place in places:
        assert min(np.hypot(*np.subtract(one.centre, place)) for one in found) < 1


@pytest.mark.parametrize('grey, cap', [(0.28, 0.05), (0.28, 0.1), (0.34, 0.1)])
def test_centre_is_in_doubt_where_edges_may_tell_a_grey_rod_from_its_shade(grey, cap):
    # Its dark end is too narrow for a segment of its own, so that pixels decide.
    background = np.full((*SIZE, 3), 0.82, np.float32)
    light = shaded(background, covered((100, 122), (170, 122), (170, 136), (100, 136)), 0.6)
    rows = np.arange(SIZE[0], dtype=np.float32)[:, None, None]
    round_ = grey * (1 + 0.3 * np.cos((rows - 120) / 8 * np.pi / 2)) * np.ones(3, np.float32)
    light = painted(light, covered((96, 112), (166, 112), (166, 128), (96, 128)), round_)
    end = covered((162, 110), (166, 110), (166, 130), (162, 130))
    (found,) = detect(painted(light, end, (cap,) * 3), background)
    assert np.hypot(*np.subtract(found.centre, (131, 120))) < 2.5 * found.doubt


@pytest.mark.parametrize('pale', [0.5, 0.8, 1.1])
def test_centre_of_a_hook_is_in_doubt_where_stripes_that_nothing_explains_may_be_its(pale):
    background = np.full((*SIZE, 3), 0.5, np.float32)
    hook = covered((100, 90), (170, 90), (170, 110), (120, 110), (120, 150), (100, 150))
    light = painted(background, hook, (0.05, 0.06, 0.5))
    stripes = np.where(np.arange(SIZE[0]) // 3 % 2, pale, 0.55)[:, None, None]
    inside = covered((121, 111), (169, 111), (169, 149), (121, 149))
    found, = detect(painted(light, inside, background * stripes), background)
    assert math.dist(found.centre, (134.5, 119.5)) < 3 * found.doubt


def test_white_thing_on_a_white_table_is_no_trace_of_light():
    background = np.full((*SIZE, 3), 0.8, np.float32)
    colours = [(0.05, 0.08, 0.5), (0.06, 0.3, 0.05), (0.74, 0.74, 0.74), (0.5, 0.1, 0.06)]
    found = detect(hard_lamp_cell(background, colours), background)
    assert len(found) == 4


def patch(half=40, blur=1.0, u=160, v=120):
    return cv2.GaussianBlur(square(u, v, half)[..., 0], (0, 0), blur)[..., None]


def under(kind, light):
    """Give a table's light with no more than a patch of sun, a moved shade, or a reflection."""
    if kind == 'sun':
        return light * (1 + 0.8 * patch())
    if kind == 'shade':
        return light * (1 - 0.5 * patch())
    return light + 0.12 * cv2.GaussianBlur(patch(), (0, 0), 10)[..., None]


@pytest.mark.parametrize('kind', ['sun', 'shade', 'reflection'])
@pytest.mark.parametrize('texture', [0.03, 0.06])
@pytest.mark.parametrize('seed', range(3))
def test_texture_however_faint_tells_of_light(kind, texture, seed):
    surface = table(texture)
    detector = PreciseDifferenceDetector(coded(surface, 1))
    assert detector.detect(coded(under(kind, surface), 2 + seed)) == []
    assert max(detector.dropped, key=lambda one: one.area).kind in ('light', 'shade')


def test_thing_that_lies_in_a_patch_of_sun_is_found():
    surface = table(0.06)
    lit = painted(under('sun', surface), square(160, 120, 12), (0.1, 0.12, 0.5))
    found, = PreciseDifferenceDetector(coded(surface, 1)).detect(coded(lit, 2))
    assert found.centre == pytest.approx((159.5, 119.5), abs=1)


@pytest.mark.parametrize('gain', [0.6, 1.6])
def test_what_fades_all_around_on_a_plain_table_is_light_or_thing(gain):
    detector = PreciseDifferenceDetector(coded(table(0), 1))
    assert detector.detect(coded(table(0) * (1 + (gain - 1) * patch(blur=5.0)), 2)) == []
    assert 'light_or_thing' in [one.kind for one in detector.dropped]


def test_object_whose_shade_reaches_the_border_comes_once_beside_foreign_shade():
    bright = 0.9 * table(0)
    foreign = np.zeros(SIZE, np.float32)
    foreign[:, :90] = 1
    own = covered((180, 197), (200, 197), (225, 245), (195, 245))
    light = shaded(shaded(bright, foreign, 0.4), own[..., 0][..., None])
    found, = detect(painted(light, square(190, 200, 12), (0.05, 0.1, 0.5)), bright)
    assert found.centre == pytest.approx((189.5, 199.5), abs=1) and not found.cut_off


@pytest.mark.parametrize('texture', [0.0, 0.1])
@pytest.mark.parametrize('grey, part', [(0.1, 0.5), (0.15, 0.5), (0.1, 0.65), (0.15, 0.35)])
def test_grey_part_of_a_coloured_thing_is_no_shade(texture, grey, part):
    """A screwdriver lies in soft light: a red handle, and a blade of the table's chroma."""
    background = table(texture)
    light = shaded(background, covered((145, 110), (190, 115), (195, 150), (150, 148)))
    light = painted(light, covered((120, 105), (180, 105), (180, 140), (120, 140)),
                    (0.05, 0.05, 0.5))
    middle = 120 + 60 * part
    light = painted(light, covered((middle, 105), (180, 105), (180, 140), (middle, 140)),
                    grey * TABLE / TABLE.mean())
    found, = detect(light, background, 90)
    assert np.hypot(found.centre.u - 149.5, found.centre.v - 122) < 3 * max(found.doubt, 0.4)


def rod(light, level, turn):
    """Lay a round rod down, with its shade: light, and which part of each pixel it covers."""
    along, across = (np.float32([np.cos(angle), np.sin(angle)])
                     for angle in (turn, turn + np.pi / 2))
    corners = np.float32([150, 120]) + [
        40 * x * along + 9 * y * across for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    v, u = np.mgrid[:SIZE[0], :SIZE[1]]
    away = np.clip(np.abs((u - 150) * across[0] + (v - 120) * across[1] + 2) / 9, 0, 1)
    shares = covered(*corners)
    return painted(shaded(light, covered(*corners + (6, 9)), 0.35), shares,
                   level * (1 - 0.5 * away[..., None] ** 2)), shares


@pytest.mark.parametrize('level', [0.15, 0.25, 0.35])
@pytest.mark.parametrize('turn', [0.0, 0.4])
def test_grey_rod_that_is_lighter_in_its_middle_is_no_shade(level, turn):
    background = np.full((*SIZE, 3), 0.8, np.float32)
    light, shares = rod(background, level, turn)
    found = detect(light, background)
    assert len(found) == 1 and overlap(found[0], np.uint8(shares[..., 0] > 0.5)) > 0.95
    assert math.dist(found[0].centre, (150, 120)) < 1 and found[0].doubt < 1


@pytest.mark.parametrize('depth', [0.35, 0.45])
@pytest.mark.parametrize('chroma', [0.2, 0.3])
def test_pale_rod_ends_where_its_chroma_does_though_its_lower_side_is_as_dark_as_its_shade(
        depth, chroma):
    background = np.full((*SIZE, 3), (0.40, 0.46, 0.49), np.float32)
    light = shaded(background, covered((116, 122), (196, 122), (196, 136), (116, 136)), depth)
    down = np.arange(SIZE[0], dtype=np.float32)[:, None, None] - 112
    level = np.clip(0.95 - (depth - 0.05) * down / 10, 1 - depth, 1)
    body = covered((110, 112), (190, 112), (190, 128), (110, 128))
    other = background * np.exp(np.float32((chroma, 0, -chroma / 2)))
    found, = detect(painted(light, body, level * other), background, 85)
    assert overlap(found, (body > 0.5)[..., 0]) > 0.9
    assert math.dist(found.centre, (149.5, 119.5)) < 1


@pytest.mark.parametrize('faint', [0.05, 0.08])
def test_dark_shade_of_a_coloured_thing_is_none_of_its_sides_beside_a_faint_one(faint):
    background = np.full((*SIZE, 3), 0.7, np.float32)
    soft = cv2.GaussianBlur(covered(
        (110, 95), (185, 95), (200, 170), (110, 165)), (0, 0), 1.5)[..., None]
    shade = covered((128, 142), (176, 138), (178, 156), (130, 160))
    light = painted(background * (1 - faint * soft), shade, 0.63 * background)
    found, = detect(painted(light, square(150, 120, 22), (0.05, 0.05, 0.5)), background, 85)
    assert overlap(found, square(150, 120, 22)[..., 0] > 0.5) > 0.95


def test_table_is_not_seen_in_what_is_sixty_times_as_light():
    assert not Detail(8.6, slope=0.056, left=0.5, nats=-17.5, added=0.0154).is_table
    assert Detail(8.6, slope=0.4, left=0.5, nats=-17.5, added=0.4).is_table
