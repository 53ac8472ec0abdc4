# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Glossy things: a lamp's highlight on them is no light of the table, and hides no colour."""

import math

from camera_to_base.detection import PreciseDifferenceDetector
from camera_to_base.detection.precise.evidence import evidence
from camera_to_base.detection.precise.noise import Noise
from camera_to_base.detection.precise.shade import Shade
import cv2
from lit_table import coded, covered, SIZE, TABLE
import numpy as np
import pytest

ROWS, COLUMNS = np.mgrid[:SIZE[0], :SIZE[1]]
WOOD = np.ones((*SIZE, 3), np.float32) * TABLE


def around(u, v, radius, count=48, turn=0.0):
    angles = 2 * np.pi * np.arange(count) / count + turn
    return np.column_stack([u + radius * np.cos(angles), v + radius * np.sin(angles)])


def lying(table, corners, colour, shade, depth=0.5, blur=1.5):
    """Lay a flat thing on a table, with a shade that is as long as told."""
    hull = cv2.convexHull(np.float32(np.vstack([corners, corners + shade])))[:, 0]
    table = table * (1 - depth * covered(*hull, blur=blur))
    share = covered(*corners)
    return table * (1 - share) + share * np.float32(colour)


def with_highlight(colour, place, width):
    away = (COLUMNS - place[0]) ** 2 + (ROWS - place[1]) ** 2
    return np.float32(colour) + 1.5 * np.exp(-away / (2 * width ** 2))[..., None]


def detect(light, background):
    return PreciseDifferenceDetector(coded(background, 1)).detect(coded(light, 2))


@pytest.mark.parametrize('colour, spot, width', [
    *((colour, spot, 4) for spot in ((-3, -3), (6, -4)) for colour in (
        (0.5, 0.15, 0.05), (0.03, 0.03, 0.03), (0.1, 0.4, 0.08), (0.3, 0.3, 0.3))),
    ((0.5, 0.15, 0.05), (5, 5), 6), ((0.1, 0.4, 0.08), (5, 5), 6)])
def test_glossy_ball_is_placed_without_its_shade(colour, spot, width):
    ball = with_highlight(colour, (150 + spot[0], 100 + spot[1]), width)
    found, = detect(lying(WOOD, around(150, 100, 15), ball, (40, 30)), WOOD)
    assert math.dist(found.centre, (149.5, 99.5)) < 1.6
    assert 600 < found.area < 780


def test_place_is_in_doubt_where_a_highlight_alone_tells_a_grey_thing_from_its_shade():
    grey = np.full((*SIZE, 3), 0.35, np.float32)
    for width in 3, 5:
        box = with_highlight(0.12 * np.ones(3), (146, 98), width)
        for found in detect(lying(grey, around(150, 100, 19, 4, 0.4), box, (45, 10), 0.7), grey):
            off = math.dist(found.centre, (149.5, 99.5))
            assert off < 3 * max(found.doubt, 0.7), (width, off, found.doubt)


def test_coloured_box_whose_soft_shade_shows_the_table_is_not_taken_for_shade():
    grain = cv2.GaussianBlur(np.random.default_rng(3).normal(0, 1, SIZE), (0, 0), 1)
    for contrast in 0.04, 0.06:
        cloth = np.ones(3, np.float32) * np.float32(
            0.25 * (1 + contrast * grain / grain.std()))[..., None]
        for turn in 0.0, 0.3, 0.6, 0.9:
            corners = around(150, 90, 14, 4, turn)
            for colour in (0.3, 0.35, 0.08), (0.02, 0.2, 0.25):
                found, = detect(lying(cloth, corners, colour, (15, 52), 0.63, 4), cloth)
                assert math.dist(found.centre, (149.5, 89.5)) < 1.5


def test_what_the_sensor_has_cut_off_hides_no_colour_beside_it():
    background = np.full((40, 40, 3), (150, 160, 165), np.uint8)
    frame = background.copy()
    frame[8:32, 8:32] = 215, 150, 60
    cut_off = np.arange(8, 32) % 5 < 3
    frame[8:32, 8:32][:, cut_off] = 255
    found = evidence(frame, background, Noise(np.ones((256, 3), np.float32), 10.0), Shade())
    assert found.nats[14:26, 14:26][:, ~cut_off[6:18]].min() > 100
