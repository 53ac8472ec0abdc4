# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A room's shade, measured beside things: tints below lamps of two colours, and dark umbras."""

import math

from camera_to_base.detection import Box, PreciseDifferenceDetector
from camera_to_base.detection.precise.piece import outlines_in
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import Region
from camera_to_base.detection.precise.shade import DARKEST, measure_shade
import cv2
from lit_table import coded, covered, SIZE
import numpy as np
import pytest

TABLE = np.float32([0.5, 0.5, 0.5])
WARM, COLD = np.float32([0.7, 0.76, 0.82]), np.float32([0.76, 0.7, 0.64])
RED, GREY = (0.05, 0.05, 0.5), (0.24, 0.24, 0.24)


def table(texture=0.0, colour=TABLE):
    grain = cv2.GaussianBlur(np.random.default_rng(5).normal(0, 1, SIZE), (0, 0), 2)
    return np.float32(colour) * (1 + texture * grain / grain.std())[..., None].astype(np.float32)


def thing_in_two_lamps(light, u, v, colour, gains=(WARM, COLD), soft=2):
    """Lay a square down with a shade to each side, in the other lamp's colour."""
    for gain, side in zip(gains, (1, -1)):
        near, far = u + side * 16, u + side * 50
        shares = covered((near, v - 14), (far, v - 8), (far, v + 22), (near, v + 18))
        shares = cv2.GaussianBlur(shares, (0, 0), soft)[..., None]
        light = light * (1 - shares * (1 - np.float32(gain)))
    shares = covered((u - 18, v - 18), (u + 18, v - 18), (u + 18, v + 18), (u - 18, v + 18))
    return light * (1 - shares) + shares * np.float32(colour)


@pytest.mark.parametrize('texture', [0.0, 0.1])
@pytest.mark.parametrize('colour', [RED, GREY])
def test_shades_of_two_colours_are_no_part_of_their_thing(texture, colour):
    places = [(80, 70), (230, 150)]
    frame = table(texture)
    for place, one in zip(places, (RED, colour)):
        frame = thing_in_two_lamps(frame, *place, one)
    detector = PreciseDifferenceDetector(coded(table(texture), 1))
    found = detector.detect(coded(frame, 2))
    assert len(found) == 2
    for place in places:
        # The middle of pixel 0 is at 0.
        assert min(math.dist(one.centre, np.subtract(place, 0.5)) for one in found) < 0.3


@pytest.mark.parametrize('colour', [(0.38, 0.5, 0.5), (0.5, 0.45, 0.4), (0.42, 0.5, 0.46)])
@pytest.mark.parametrize('light, dark', [(0.2, 0.06), (0.15, 0.04), (0.25, 0.08)])
def test_grey_thing_on_a_coloured_table_keeps_its_dark_face(colour, light, dark):
    empty = table(colour=colour)
    frame = thing_in_two_lamps(empty, 80, 70, RED)
    frame = thing_in_two_lamps(frame, 230, 150, (light,) * 3)
    face = covered((248, 132), (262, 136), (262, 160), (248, 168))
    frame = frame * (1 - face) + face * np.float32([dark] * 3)
    found = PreciseDifferenceDetector(coded(empty, 1)).detect(coded(frame, 2))
    assert [round(one.area, -2) for one in found] == [1700, 1300]
    assert math.dist(found[0].centre, (235, 149.5)) < 1


@pytest.mark.parametrize('excess, red, gains, soft', [
    (1.1, 1.1, (0.6, 0.62, 0.64), 2), (1.25, 1.1, (0.6, 0.62, 0.64), 5),
    (1.25, 1.1, (0.6, 0.62, 0.64), 8), (1.1, 1.2, (0.5, 0.5, 0.5), 8),
    (1.1, 1.2, (0.62, 0.6, 0.57), 5), (1.25, 1.2, (0.5, 0.5, 0.5), 5),
    (1.25, 1.2, (0.5, 0.5, 0.5), 8), (1.25, 1.2, (0.62, 0.6, 0.57), 5)])
def test_shade_of_an_overexposed_table_has_the_tint_that_the_table_has_lost(
        excess, red, gains, soft):
    # The lamps are brighter than what is cut off, and not white.
    light = table(0.01, 0.84 * excess * np.float32([1.0, (1 + red) / 2, red]))
    frame, places = light, [(80, 70), (230, 150)]
    for place in places:
        frame = thing_in_two_lamps(frame, *place, RED, (gains, np.sqrt(gains)), soft)
    empty, frame = (coded(np.minimum(one, 0.84), seed) for seed, one in enumerate((light, frame)))
    found = PreciseDifferenceDetector(empty).detect(frame)
    assert len(found) == 2
    for place in places:
        assert min(math.dist(one.centre, np.subtract(place, 0.5)) for one in found) < 0.3


@pytest.mark.parametrize('colour, gains, has_tint', [
    ((0.28, 0.26, 0.24), (0.6, 0.6, 0.6), False), ((0.24, 0.26, 0.28), (0.7, 0.7, 0.7), False),
    ((0.26, 0.26, 0.26), (0.6, 0.55, 0.5), True)])
def test_colour_of_a_grey_thing_is_no_tint_of_its_shade(colour, gains, has_tint):
    shares = cv2.GaussianBlur(covered((120, 90), (222, 90), (222, 172), (120, 172)), (0, 0), 2)
    frame = table() * (1 - shares[..., None] * (1 - np.float32(gains)))
    if not has_tint:
        shares = covered((110, 80), (200, 80), (200, 150), (110, 150))
        frame = frame * (1 - shares) + shares * np.float32(colour)
    frame, reference = coded(frame, 2), Reference(coded(table(), 1), 13.0)
    reference.follow(frame)
    box = Box(108, 78, 117, 97)
    corners = [(108, 78), (202, 78), (224, 88), (224, 174), (118, 174), (108, 152)]
    region = Region(np.int32(corners)[:, None], box, 6000, box)
    assert bool(measure_shade(frame, [region], reference).tints) == has_tint


BLUE, GREEN, PLACES = (0.5, 0.15, 0.05), (0.05, 0.4, 0.1), [(70, 60), (230, 70), (90, 170)]


def in_a_dark_room(light, place, colour, soft, umbra=0.1):
    """Lay a square down below one lamp, and hardly any other light."""
    return thing_in_two_lamps(light, *place, colour, gains=[(umbra,) * 3], soft=soft)


@pytest.mark.parametrize('texture', [0.0, 0.06])
@pytest.mark.parametrize('umbra', [0.07, 0.12])
@pytest.mark.parametrize('soft', [1.5, 3.0])
def test_umbra_in_a_dark_room_is_no_part_of_its_thing(texture, umbra, soft):
    light = empty = table(texture)
    for place, colour in zip(PLACES, (RED, BLUE, GREEN)):
        light = in_a_dark_room(light, place, colour, soft, umbra)
    found = PreciseDifferenceDetector(coded(empty, 1)).detect(coded(light, 2))
    assert len(found) == 3
    for one in found:
        away = min(math.dist(one.centre, np.subtract(place, 0.5)) for place in PLACES)
        assert away < max(0.6, 1.5 * one.doubt)


def with_handles(light, shade=1.0):
    """Lay three tools down: coloured ones with black handles, without or with usual shade."""
    for (u, v), colour in zip(PLACES, (RED, BLUE, GREEN)):
        shares = covered((u - 30, v - 4), (u + 36, v - 4), (u + 36, v + 18), (u - 30, v + 18),
                         blur=3)
        light = light * (1 - shares * (1 - shade))
        for left, right, tone in ((u - 30, u, colour), (u, u + 30, (0.045,) * 3)):
            part = covered((left, v - 9), (right, v - 9), (right, v + 9), (left, v + 9))
            light = light * (1 - part) + part * np.float32(tone)
    return light


def test_black_handles_are_a_part_of_their_tools_in_any_room():
    for shade in (1.0, 0.5):
        found = PreciseDifferenceDetector(coded(table(), 1)).detect(
            coded(with_handles(table(), shade), 2))
        assert len(found) == 3
        for place in PLACES:
            assert min(math.dist(one.centre, np.subtract(place, 0.5)) for one in found) < 1


def darkest_of(light):
    frame, empty = coded(light, 2), coded(table(), 1)
    reference = Reference(empty, 13.0)
    reference.follow(frame)
    changed = cv2.absdiff(frame, empty).max(axis=2) > 12
    outlines = outlines_in(changed.astype(np.uint8))
    boxes = [Box(*cv2.boundingRect(one)) for one in outlines]
    return measure_shade(frame, [Region(one, box, 0, box) for one, box in zip(outlines, boxes)
                                 if box.height > 10], reference).darkest


def test_darkest_shade_is_measured_beside_two_things_or_more_where_lighter_shade_is_rare():
    light = table()
    for place, colour in zip(PLACES, (RED, BLUE, GREEN)):
        light = in_a_dark_room(light, place, colour, soft=3)
    assert -3 < darkest_of(light) < -2.3
    assert darkest_of(in_a_dark_room(table(), PLACES[0], RED, soft=3)) == DARKEST
    assert darkest_of(with_handles(table(), 0.5)) == DARKEST
