# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Faces of the table's level and chroma: nothing but its texture is gone there."""

from camera_to_base.detection.precise.evidence import evidence
from camera_to_base.detection.precise.faces import hidden_beside
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.shade import Shade
import cv2
from lit_table import (
    coded, covered, detect, disc, felt, overlap, painted, shaded, SIZE, TABLE)
import numpy as np
import pytest


def off(detection, true):
    return float(np.hypot(*np.subtract(detection.centre, np.argwhere(true).mean(axis=0)[::-1])))


def silhouette(*shares):
    return np.uint8(np.maximum.reduce(shares)[..., 0] > 0.5)


TEXTURES = pytest.mark.parametrize('texture', [0.06, 0.1, 0.2, 0.3])
SEEDS = pytest.mark.parametrize('seed', [1, 2])


@TEXTURES
@SEEDS
def test_plain_disc_of_the_mean_colour_of_a_textured_table_is_found(texture, seed):
    background = felt(texture, seed)
    coin = disc(150, 120, 18)
    light = painted(shaded(background, disc(155, 125, 18)), coin, background.mean((0, 1)))
    found = detect(light, background)
    assert len(found) == 1 and overlap(found[0], silhouette(coin)) > 0.9
    assert off(found[0], silhouette(coin)) < 1 < found[0].doubt < 3


@TEXTURES
@SEEDS
def test_box_whose_top_looks_like_the_table_is_no_more_than_its_wall(texture, seed):
    background = felt(texture, seed)
    colour = background.mean((0, 1))
    top = covered((128, 98), (172, 98), (172, 142), (128, 142))
    wall = covered((128, 142), (172, 142), (168, 160), (132, 160))
    light = shaded(background, covered((130, 100), (180, 100), (220, 165), (170, 165)))
    found = detect(painted(painted(light, top, colour), wall, 0.35 * colour), background)
    assert len(found) == 1 and overlap(found[0], silhouette(top, wall)) > 0.95
    assert off(found[0], silhouette(top, wall)) < 0.6


@pytest.mark.parametrize('texture', [0.2, 0.3])
@SEEDS
def test_top_that_looks_like_the_table_may_be_far_larger_than_what_is_seen_of_it(texture, seed):
    background = felt(texture, seed)
    colour = background.mean((0, 1))
    top = covered((120, 40), (180, 40), (180, 142), (120, 142))
    wall = covered((120, 142), (180, 142), (176, 156), (124, 156))
    light = painted(painted(background, top, colour), wall, 0.35 * colour)
    found = detect(light, background)
    assert len(found) == 1 and overlap(found[0], silhouette(top, wall)) > 0.93
    assert off(found[0], silhouette(top, wall)) < 3 * found[0].doubt


@pytest.mark.parametrize('quality', [80, 95])
@pytest.mark.parametrize('texture', [0.06, 0.1])
@SEEDS
def test_wall_without_shade_on_a_faint_texture_is_not_all_of_its_box(texture, seed, quality):
    background = felt(texture, seed)
    colour = background.mean((0, 1))
    top = covered((120, 70), (180, 70), (180, 130), (120, 130))
    wall = covered((120, 130), (180, 130), (178, 144), (122, 144))
    light = painted(painted(background, top, colour), wall, 0.35 * colour)
    found = detect(light, background, quality)
    assert len(found) == 1 and overlap(found[0], silhouette(top, wall)) > 0.9
    assert off(found[0], silhouette(top, wall)) < 1 < found[0].doubt < 3


@pytest.mark.parametrize('texture', [0.06, 0.1, 0.2])
@SEEDS
def test_disc_that_looks_like_the_table_between_two_shades_is_one(texture, seed):
    background = felt(texture, seed)
    coin = disc(150, 120, 24)
    shade = np.maximum(disc(155, 120, 22), disc(145, 120, 22))
    light = painted(shaded(background, shade), coin, background.mean((0, 1)))
    found = detect(light, background)
    assert len(found) == 1 and overlap(found[0], silhouette(coin)) > 0.85
    assert off(found[0], silhouette(coin)) < 3 * found[0].doubt


@pytest.mark.parametrize('width, white, quality', [
    (5, (1.15, 1, 0.9), 75), (6, (1, 1, 1), 95)])
def test_narrow_walls_in_the_chroma_of_their_top_are_no_shade(width, white, quality):
    background = np.full((*SIZE, 3), (0.4, 0.44, 0.47), np.float32)
    white = np.float32(white)
    top = covered((128, 98), (172, 92), (178, 136), (134, 142))
    right = covered((172, 92), (172 + width, 94), (178 + width, 138), (178, 136))
    near = covered((134, 142), (178, 136), (178 + width, 138), (134 + width, 147))
    shade = covered((140, 100), (182 + width, 104), (188 + width, 152), (140, 157))
    light = painted(shaded(background, shade, 0.4), top, 0.8 * white)
    light = painted(painted(light, right, 0.34 * white), near, 0.27 * white)
    found = detect(light, background, quality)
    assert len(found) == 1 and overlap(found[0], silhouette(top + right + near)) > 0.88


def hidden(light, background, thing):
    """Give what is hidden beside a thing that is all of its region."""
    frame, usual = coded(light, 2, 95), coded(background, 1, 95)
    reference = Reference(usual, 13.0)
    reference.follow(frame)
    changed = cv2.dilate(silhouette(thing), np.ones((5, 5), np.uint8))
    return hidden_beside(changed, 1 - changed, evidence(
        frame, reference.lit, reference.noise[1], Shade()))


def hook(u, v):
    gap = covered((u, v - 6), (u + 30, v - 6), (u + 30, v + 6), (u, v + 6))
    return np.clip(disc(u, v, 30) - disc(u, v, 20) - gap, 0, 1)


RED = 0.6, 0.05, 0.03


@SEEDS
def test_what_lies_in_a_hook_is_hidden_where_it_is_plain_and_not_where_it_is_the_table(seed):
    background = felt(0.1, seed)
    plain = painted(background, disc(150, 120, 16), background.mean((0, 1)))
    for light, is_hidden in (background, False), (plain, True):
        found = hidden(painted(light, hook(150, 120), RED), background, hook(150, 120))
        assert found[112:129, 142:159].any() == is_hidden and found.any() == is_hidden


@SEEDS
def test_other_texture_in_a_hook_is_the_cloth_that_was_moved(seed):
    background = felt(0.1, seed)
    moved = painted(background, disc(150, 120, 18), np.roll(background, 6, 1))
    light = painted(moved, hook(150, 120), RED)
    assert not hidden(light, background, hook(150, 120)).any()


@SEEDS
def test_print_that_was_taken_away_is_not_hidden_by_what_lies_beside_it(seed):
    background = painted(np.broadcast_to(TABLE, (*SIZE, 3)), covered(
        (175, 108), (215, 108), (215, 132), (175, 132)), 0)
    background = background + (background == 0) * felt(0.2, seed)
    light = painted(np.broadcast_to(TABLE, (*SIZE, 3)), disc(150, 120, 20), RED)
    assert not hidden(light, background, disc(150, 120, 20)).any()


def turned(*points):
    turn = np.array([[np.cos(1.9), -np.sin(1.9)], [np.sin(1.9), np.cos(1.9)]])
    return covered(*(np.float32(points) @ turn.T + (150, 120)))


@pytest.mark.parametrize('dark, pale', [(0.55, 1.0), (0.5, 1.1)])
@SEEDS
def test_bolt_of_which_half_looks_like_shade_on_felt_is_in_doubt(dark, pale, seed):
    background = felt(0.3, seed)
    colour = background.mean((0, 1))
    bolt = np.maximum(turned((-36, -6), (36, -6), (36, 6), (-36, 6)),
                      turned((36, -11), (48, -11), (48, 11), (36, 11)))
    light = shaded(background, np.roll(bolt, (5, 4), (0, 1)))
    light = painted(light, bolt, dark * colour)
    light = painted(light, turned((-36, -6), (36, -6), (36, -1), (-36, -1)), pale * colour)
    for one in detect(light, background):
        assert off(one, silhouette(bolt)) < 3 * one.doubt
