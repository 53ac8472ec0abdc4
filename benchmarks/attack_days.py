# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Days of the attack: what a camera that is bumped, and hands that reach in, make of the positions.

Each day is a short sequence of frames whose truth is known, and gives one row of counts. A point
is wrong where it is more than 3 mm from the coin. 0.5625 mm are 1 px.
"""

import time

import attack_scenes as scenes
from camera_to_base.pipeline import CameraPipeline, Limits
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
import cv2
import numpy as np

MM_PER_PX, WRONG_MM, FRAMES_PER_S = 0.5625, 3.0, 12
REST = 0, 0, 0, 0
VIEW_KINDS = 'view_moved', 'view_changed', 'view_unknown'
# Px a frame: at rest, slow, and 400 mm/s.
SPEEDS = 0, 3, 59
HAND_MODES = 'no coin', 'beside a coin', 'over a coin', 'shading a coin'
# Where a shadow falls beside what throws it, in px.
SHADOW = np.array([18, 14])


class Watcher:
    """A pipeline with a clock of its own."""

    def __init__(self, table):
        self._pipeline = CameraPipeline(
            ParallelSurface(36.0, scenes.WIDTH), limits=Limits(), kind=DEVICE)
        self._now = time.monotonic() + 3600
        for _ in range(2):
            self.see(table.shoot())

    def see(self, frame):
        """
        Give the positions that are published of a frame, and the reason why none is.

        They are in px of the camera before it was bumped.
        """
        self._now += 1 / FRAMES_PER_S
        sighting = self._pipeline.process(frame, self._now)
        places = [] if sighting.reason else [
            np.multiply(one.point, 10 / MM_PER_PX) for one in sighting.objects]
        return places, sighting.reason


def bump(random):
    """Choose how far the camera is bumped."""
    kind, angle = random.integers(5), random.uniform(0, 2 * np.pi)
    length = random.choice([5, 10, 20, 40])
    if kind < 3:
        return np.array([length * np.cos(angle), length * np.sin(angle), 0, 0])
    sign = random.choice([-1, 1])
    return np.array([0, 0, sign * random.uniform(0.5, 2), 0] if kind == 3
                    else [0, 0, 0, sign * random.uniform(0.01, 0.03)])


def course(random, count):
    """Give for each frame which share of the bump has happened."""
    kind, frames = random.integers(4), np.arange(count)
    if kind == 0:
        return 'no bump', np.zeros(count)
    if kind == 1:
        return 'step', (frames >= count // 3).astype(float)
    if kind == 2:
        return 'slide', np.clip((frames - count // 4) / FRAMES_PER_S, 0, 1)
    return 'wobble', ((frames % 18 < 5) & (frames > 6)).astype(float)


def wrong_count(places, truth):
    """Count the positions that are too far from the true one; all where there is none."""
    if not places:
        return 0
    off = np.hypot(*np.subtract(places, (np.inf, np.inf) if truth is None else truth).T)
    return int((off > WRONG_MM / MM_PER_PX).sum())


def random_arm(table, random, tip, levels=None):
    """
    Choose an arm.

    :param levels: By how much it differs from the table, at most; None for skin, or 8 to 150.
    :returns: Where it begins, its width, how its fingers are spread, and its colour.
    """
    edge = np.array(scenes.beyond(scenes.EDGES[random.integers(4)], random))
    spread = random.uniform(-1, 1, 4) if random.random() < 0.7 else None
    if levels is not None:
        colour = table.colour + random.uniform(-levels, levels, 3)
    elif random.random() < 0.4:
        colour = np.array(scenes.SKINS[random.integers(6)]) * random.uniform(0.8, 1.1)
    else:
        colour = (table.colour + random.choice([-1, 1]) * random.uniform(8, 150)
                  + random.uniform(-3, 3, 3))
    return edge, random.uniform(35, 95), spread, np.clip(colour, 3, 252)


def day_with_bumps(table, random, count=48):
    """Play a day; count frames, wrong points, frames stopped, and how the camera moved."""
    watcher, most, (kind, share) = Watcher(table), bump(random), course(random, count)
    way = _way(random, count)
    light = random.choice([1, random.uniform(0.3, 1.5)])
    tip, coin_colour = random.uniform((150, 120), (490, 360)), table.unlike(random)
    edge, width, spread, colour = random_arm(table, random, tip)
    has_arm = random.random() < 0.4
    row = {'frames': 0, 'wrong': 0, 'at rest': 0, 'stopped': 0}
    for number, at in enumerate(way):
        draw = [scenes.coin(at, colour=coin_colour)]
        if has_arm and 10 < number < 34:
            reach = min(1, (number - 10) / 6, (34 - number) / 6)
            cover = scenes.arm_cover(edge, edge + reach * (tip - edge), width, spread)
            draw.append(scenes.arm(cover, colour))
        frame = table.shoot(most * share[number], draw, light if number > count // 2 else 1.0)
        places, reason = watcher.see(frame)
        row['frames'] += 1
        row['wrong'] += wrong_count(places, at)
        if not share[number]:
            row['at rest'] += 1
            row['stopped'] += reason is not None and reason.kind in VIEW_KINDS
    return {'surface': table.name, 'what': kind, **row}


def _way(random, count):
    # Back and forth between two places, the corners included.
    begin, end = random.uniform((25, 25), (615, 455), (2, 2))
    length = max(float(np.hypot(*(end - begin))), 1.0)
    steps = random.choice(SPEEDS) * np.arange(count) / length
    return begin + np.abs((steps + 1) % 2 - 1)[:, None] * (end - begin)


def day_with_hand(table, random, mode=None, levels=None, count=48):
    """
    Let one to three hands come and go.

    :param mode: One of HAND_MODES; None for any.
    :param levels: See `random_arm`.
    :returns: Counts of frames, wrong points, and how often a free or a shaded coin is published.
    """
    mode = HAND_MODES[random.integers(4)] if mode is None else mode
    watcher, at = Watcher(table), random.uniform((90, 90), (550, 390))
    has_shadow, radius = mode[0] == 's' or random.random() < 0.5, random.uniform(14, 28)
    arms = [random_arm(table, random, None, levels) for _ in range(
        1 if mode[0] == 's' else random.choice([1, 1, 2, 3]))]
    tips = [_tip(random, mode, at, arm, radius) for arm in arms]
    coin_colour = table.unlike(random)
    near = cv2.circle(np.zeros(scenes.SHAPE, np.uint8), tuple(
        int(x + scenes.MARGIN) for x in at), int(radius) + 4, 1, -1) > 0
    row = {'frames': 0, 'wrong': 0, 'free': 0, 'free seen': 0, 'shaded': 0, 'shaded seen': 0}
    for number in range(count):
        draw = [] if mode == 'no coin' else [scenes.coin(at, radius, coin_colour)]
        covers = []
        for index, ((edge, width, spread, colour), tip) in enumerate(zip(arms, tips)):
            reach = float(np.clip(min((number - 6 - 4 * index) / 10, (34 - number) / 10), 0, 1))
            cover = scenes.arm_cover(edge, edge + reach * (tip - edge), width, spread)
            draw += [scenes.shadow(cover)] if has_shadow else []
            draw.append(scenes.arm(cover, colour))
            covers.append(cover)
        places, _ = watcher.see(table.shoot(REST, draw))
        row['frames'] += 1
        row['wrong'] += wrong_count(places, None if mode == 'no coin' else at)
        if mode != 'no coin' and number > 2:
            _count_seen(row, np.maximum.reduce(covers), near, has_shadow, bool(places))
    return {'surface': table.name, 'what': f'hand {mode}', **row}


def _tip(random, mode, at, arm, radius):
    if mode[0] == 'o':
        return at + random.normal(0, 10, 2)
    if mode[0] == 's':
        # The palm's shadow falls on the coin, the palm stays off it.
        away = -SHADOW / np.hypot(*SHADOW)
        return at + away * (radius + 0.75 * arm[1] + 8)
    return random.uniform((120, 90), (520, 390))


def _count_seen(row, cover, near, has_shadow, is_seen):
    if cover[near].max() > 0.01:
        return
    beside = np.roll(cover, tuple(SHADOW[::-1]), axis=(0, 1))
    kind = 'shaded' if has_shadow and beside[near].max() > 0.01 else 'free'
    row[kind] += 1
    row[f'{kind} seen'] += is_seen
