# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Objects that touch."""

import math

from camera_to_base.detection import PreciseDifferenceDetector
from camera_to_base.detection.touching import cut_at_light, without_necks
import cv2
from lit_table import coded, covered
import numpy as np
import pytest


def table():
    noise = np.random.default_rng(3).normal(200, 2, (240, 320, 3))
    return np.clip(np.rint(noise), 0, 255).astype(np.uint8)


def drawn(*shapes):
    """Draw filled polygons, smooth at their rims; lines of corners in px."""
    large = cv2.resize(table(), None, fx=8, fy=8, interpolation=cv2.INTER_NEAREST)
    for corners in shapes:
        cv2.fillPoly(large, [np.int32(np.rint((np.asarray(corners) + 0.5) * 8 - 0.5))], (60,) * 3)
    return cv2.resize(large, (320, 240), interpolation=cv2.INTER_AREA)


def polygon(centre, radius, count=90, turn=0.0):
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False) + turn
    return np.array(centre) + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def bar(centre, length, width, angle=0.0):
    a, b = length / 2, width / 2
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.array([[-a, -b], [a, -b], [a, b], [-a, b]]) @ turn.T + centre


def detect(frame, split=True):
    return PreciseDifferenceDetector(table(), split_touching=split).detect(frame)


@pytest.mark.parametrize('gap', [-1.0, 0.0, 1.0])
@pytest.mark.parametrize('count', [6, 90])
def test_two_that_touch_come_as_one_each(count, gap):
    centres = (100.3, 120.6), (100.3 + 2 * 22 + gap, 120.6)
    found = detect(drawn(*(polygon(centre, 22, count) for centre in centres)))
    assert len(found) == 2
    for centre in centres:
        assert min(math.dist(one.centre, centre) for one in found) < 0.5


def test_three_coins_in_a_row_and_of_different_sizes_come_as_one_each():
    centres = {(80, 120): 20, (114, 120): 14, (146, 120): 18}
    found = detect(drawn(*(polygon(centre, radius) for centre, radius in centres.items())))
    assert len(found) == 3
    for centre in centres:
        assert min(math.dist(one.centre, centre) for one in found) < 0.5


SCREW = [bar((150, 120), 60, 10), bar((116, 120), 10, 22)]
L_SHAPE = [bar((150, 120), 70, 16), bar((123, 140), 16, 50)]
BONE = [bar((150, 120), 40, 14), polygon((128, 120), 11), polygon((172, 120), 11)]
BLOB = [polygon((150, 120), 20), polygon((165, 128), 17), polygon((150, 135), 15)]


@pytest.mark.parametrize('shapes', [SCREW, L_SHAPE, BONE, BLOB])
def test_one_object_is_not_split(shapes):
    assert len(detect(drawn(*shapes))) == 1


def test_ring_is_not_split():
    frame = drawn(polygon((150, 120), 25))
    inside = np.zeros(frame.shape[:2], np.uint8)
    cv2.circle(inside, (150, 120), 14, 1, -1)
    frame[inside > 0] = table()[inside > 0]
    assert len(detect(frame)) == 1


def test_nothing_is_split_by_default():
    frame = drawn(polygon((100, 120), 22), polygon((144, 120), 22))
    assert len(PreciseDifferenceDetector(table()).detect(frame)) == 1


def on_a_grey_table(coins, shade, seed, quality):
    """Draw coins as (centre, radius, B, G and R), each with a shade, and compress the picture."""
    light = np.full((240, 320, 3), 0.4, np.float32)
    for centre, radius, _ in coins:
        light = light * (1 - 0.5 * covered(*(polygon(centre, radius) + shade), blur=0.8))
    for centre, radius, colour in coins:
        share = covered(*polygon(centre, radius), blur=0.8)
        light = light * (1 - share) + share * np.float32(colour)
    return coded(light, seed, quality, noise=1.2)


RED, YELLOW, PALE = (0.05, 0.1, 0.4), (0.12, 0.3, 0.5), (0.5, 0.5, 0.5)


@pytest.mark.parametrize('first, second, gap, shade, quality', [
    (PALE, PALE, 5, (1, 3), 75), (RED, YELLOW, 5, (0, -3), 90), (YELLOW, YELLOW, 5, (1, 3), 90),
    (RED, YELLOW, 7, (0, -3), 75), (YELLOW, YELLOW, 7, (3, 1), 60), (PALE, PALE, 3, (-2, 2), 75)])
def test_two_whose_shade_or_compression_fills_the_gap_are_two(first, second, gap, shade, quality):
    centres = (160, 100), (157, 125 + gap)
    found = PreciseDifferenceDetector(on_a_grey_table([], shade, 1, quality)).detect(
        on_a_grey_table([(centres[0], 14, first), (centres[1], 11, second)], shade, 2, quality))
    assert len(found) == 2
    for centre in centres:
        assert min(math.dist(one.centre, centre) for one in found) < 2


@pytest.mark.parametrize('right, parts', [((0.8,) * 3, 2), ((0.0,) * 3, 1)])
def test_neck_that_is_a_mixture_of_its_sides_is_a_thing_of_two_colours(right, parts):
    mask = np.zeros((60, 100), np.uint8)
    cv2.circle(mask, (30, 30), 14, 1, cv2.FILLED)
    cv2.circle(mask, (66, 30), 14, 1, cv2.FILLED)
    mask[28:33, 40:56] = 1
    light = np.full((60, 100, 3), 0.4, np.float32)
    light[:, :44], light[:, 52:] = 0.8, right
    apart = without_necks(mask, light, np.full_like(light, 0.4), 30)
    assert cv2.connectedComponents(apart)[0] - 1 == parts


# What joins two dark things, whether light explains it, and the radius of the smaller one.
@pytest.mark.parametrize('joint, is_light, radius, parts', [
    (110, True, 14, 2), (110, True, 7, 2), (110, False, 14, 1),
    # The table had its own edges there; what lies on them is as dark as the things.
    (40, True, 14, 1),
])
def test_shade_joins_no_two_things(joint, is_light, radius, parts):
    things, light = np.zeros((2, 60, 100), np.uint8)
    cv2.circle(things, (39 - radius, 30), radius, 1, cv2.FILLED)
    cv2.circle(things, (71, 30), 16, 1, cv2.FILLED)
    table = np.full((60, 100, 3), 180, np.uint8)
    frame = np.where(things[..., None] > 0, np.uint8(40), table)
    frame[18:42, 40:56] = joint
    things[18:42, 38:58] = 1
    light[:, 40:56] = is_light
    apart = cut_at_light(things, light, frame, table, 30)
    assert cv2.connectedComponents(apart)[0] - 1 == parts


@pytest.mark.parametrize('half, seed', [(14, 2), (15, 3), (16, 4)])
def test_two_in_a_large_shade_whose_own_shades_join_them_are_two(half, seed):
    # All of the large shade is seen reduced, and then a window is wider than the gap.
    centres = {(120 - half, 120): (0.1, 0.1, 0.5), (120 + half, 120): (0.5, 0.1, 0.1),
               (220, 90): (0.5, 0.2, 0.1), (200, 170): (0.1, 0.5, 0.1)}
    empty = np.full((240, 320, 3), 0.5, np.float32)
    light = empty * (1 - 0.35 * covered(*polygon((160, 120), 105), blur=3))
    for u, v in centres:
        light = light * (1 - 0.5 * covered(*polygon((u + 3, v + 2), 11), blur=2))
    for centre, colour in centres.items():
        share = covered(*polygon(centre, 11), blur=1.5)
        light = light * (1 - share) + share * np.float32(colour)
    detector = PreciseDifferenceDetector(coded(empty, 1, 85, noise=1.2))
    found = detector.detect(coded(light, seed, 85, noise=1.2))
    assert len(found) == 4
    for centre in centres:
        assert min(math.dist(one.centre, centre) for one in found) < 2
