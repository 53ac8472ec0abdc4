# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
What a camera that is bumped, and a hand that reaches in, make the pipeline publish.

Bumps: short days on each surface, on which the camera is bumped or not, with a coin that rests or
moves, with hands, and with steps of the light. Hands: they come, hover and go, beside a coin, over
it or without one; the table's colour differs from theirs by 8 to 150 levels. A point is wrong
where it is more than 3 mm from the coin; a frame is stopped where the view holds it back though
the camera did not move. 0.5625 mm are 1 px. The renderer is attack_scenes.py.
"""

import argparse
import json
import time

import attack_scenes as scenes
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
from camera_to_base.trust import CameraPipeline, Limits
from camera_to_base.trust.quick_look import QuickLook
from camera_to_base.trust.reaching_in import ReachingIn
import cv2
import numpy as np

MM_PER_PX, WRONG_MM, FRAMES_PER_S = 0.5625, 3.0, 12
REST = 0, 0, 0, 0
VIEW_KINDS = 'view_moved', 'view_changed', 'view_unknown'


class Watcher:
    """A pipeline with a clock of its own."""

    def __init__(self, table):
        self._pipeline = CameraPipeline(
            ParallelSurface(36.0, scenes.WIDTH), limits=Limits(), kind=DEVICE)
        self._now = time.monotonic() + 3600
        for _ in range(2):
            self.see(table.shoot())

    def see(self, frame):
        """Give the pixels that are published of a frame, and the reason why none is."""
        self._now += 1 / FRAMES_PER_S
        sighting = self._pipeline.process(frame, self._now)
        pixels = [] if sighting.reason else [one.detection.centre for one in sighting.objects]
        return pixels, sighting.reason


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


def far_px(pixels, truth):
    """Tell how far the pixels are from the true one, the farthest of them; 0 for none."""
    if not pixels:
        return 0.0
    return np.inf if truth is None else max(np.hypot(*np.subtract(pixels, truth).T))


def random_arm(table, random, tip):
    """Choose an arm; give where it begins, its width, fingers and colour."""
    edge = np.array(scenes.beyond(scenes.EDGES[random.integers(4)], random))
    spread = random.uniform(-1, 1, 4) if random.random() < 0.7 else None
    colour = (np.array(scenes.SKINS[random.integers(6)]) * random.uniform(0.8, 1.1)
              if random.random() < 0.4 else table.colour
              + random.choice([-1, 1]) * random.uniform(8, 150) + random.uniform(-3, 3, 3))
    return edge, random.uniform(35, 95), spread, np.clip(colour, 3, 252)


def day_with_bumps(name, random, count=48):
    """Play a day; count frames, wrong points, frames stopped, and how the camera moved."""
    table = scenes.Table(name, random)
    watcher, most, (kind, share) = Watcher(table), bump(random), course(random, count)
    begin = random.uniform((60, 60), (580, 420))
    speed = random.choice([0, 3]) * random.uniform(-1, 1, 2)
    light = random.choice([1, random.uniform(0.3, 1.5)])
    tip, dark = random.uniform((150, 120), (490, 360)), np.maximum(table.colour - 75, 5)
    edge, width, spread, colour = random_arm(table, random, tip)
    has_arm = random.random() < 0.4
    row = {'frames': 0, 'wrong': 0, 'at rest': 0, 'stopped': 0}
    for number in range(count):
        at, draw = begin + speed * number, []
        draw.append(scenes.coin(at, colour=dark))
        if has_arm and 10 < number < 34:
            reach = min(1, (number - 10) / 6, (34 - number) / 6)
            cover = scenes.arm_cover(edge, edge + reach * (tip - edge), width, spread)
            draw.append(scenes.arm(cover, colour))
        frame = table.shoot(most * share[number], draw, light if number > count // 2 else 1.0)
        pixels, reason = watcher.see(frame)
        row['frames'] += 1
        row['wrong'] += far_px(pixels, at) > WRONG_MM / MM_PER_PX
        if not share[number]:
            row['at rest'] += 1
            row['stopped'] += reason is not None and reason.kind in VIEW_KINDS
    return {'surface': name, 'what': kind, **row}


def day_with_hand(random, count=48):
    """Let a hand come and go; count frames, wrong points, and how often a free coin comes."""
    name = random.choice(['plain', *scenes.SURFACES])
    table = scenes.Table(name, random)
    watcher, mode = Watcher(table), random.choice(['no coin', 'beside a coin', 'over a coin'])
    at = random.uniform((90, 90), (550, 390))
    tip = at + random.normal(0, 10, 2) if mode[0] == 'o' else random.uniform((120, 90), (520, 390))
    edge, width, spread, colour = random_arm(table, random, tip)
    has_shadow, radius = random.random() < 0.5, random.uniform(14, 28)
    dark = np.minimum(table.colour - 70, random.uniform(10, 60))
    near = cv2.circle(np.zeros(scenes.SHAPE, np.uint8), tuple(
        int(x + scenes.MARGIN) for x in at), int(radius) + 8, 1, -1) > 0
    row = {'frames': 0, 'wrong': 0, 'free': 0, 'free seen': 0, 'shaded': 0, 'shaded seen': 0}
    for number in range(count):
        reach = float(np.clip(min((number - 6) / 10, (34 - number) / 10), 0, 1))
        cover = scenes.arm_cover(edge, edge + reach * (tip - edge), width, spread)
        draw = [] if mode == 'no coin' else [scenes.coin(at, radius, np.maximum(dark, 5))]
        draw += [scenes.shadow(cover)] if has_shadow else []
        pixels, _ = watcher.see(table.shoot(REST, [*draw, scenes.arm(cover, colour)]))
        row['frames'] += 1
        row['wrong'] += far_px(pixels, None if mode == 'no coin' else at) > WRONG_MM / MM_PER_PX
        if mode != 'no coin' and number > 2 and not cover[near].max() > 0.01:
            is_shaded = has_shadow and np.roll(cover, (14, 18), axis=(0, 1))[near].max() > 0.01
            kind = 'shaded' if is_shaded else 'free'
            row[kind] += 1
            row[f'{kind} seen'] += bool(pixels)
    return {'surface': name, 'what': f'hand {mode}', **row}


def sums(rows, key):
    """Add the rows up by one of their columns."""
    total = {}
    for row in rows:
        part = total.setdefault(row[key], {})
        for name, value in row.items():
            if not isinstance(value, str):
                part[name] = part.get(name, 0) + value
    return total


def cost_ms(size, rounds=30):
    """Measure the look and the search for what reaches in, in ms, the medians."""
    table = scenes.Table('wood', np.random.default_rng(1))
    frames = [cv2.resize(table.shoot(), size) for _ in range(2)]
    look, reaching = QuickLook(frames[0], frames[1]), ReachingIn(frames[0])
    costs = []
    for work in (lambda: look.look(frames[1]), lambda: reaching.find(frames[1], 0.0)):
        times = []
        for _ in range(rounds):
            begin = time.perf_counter()
            work()
            times.append(time.perf_counter() - begin)
        costs.append(float(np.median(times)) * 1e3)
    return costs


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--days', type=int, default=10, help='of each surface, and ten of hands')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--quick', action='store_true', help='few days, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the days as a list of objects')
    arguments = parser.parse_args()
    days = 1 if arguments.quick else arguments.days
    rows = [day_with_bumps(name, np.random.default_rng([arguments.seed, day, number]))
            for number, name in enumerate(scenes.SURFACES) for day in range(days)]
    for key in ('surface', 'what'):
        for name, total in sums(rows, key).items():
            print(f'{name:16} ' + ', '.join(f'{key} {value}' for key, value in total.items()))
    hands = [day_with_hand(np.random.default_rng([arguments.seed, 99, day]))
             for day in range(2 if arguments.quick else 10 * days)]
    for name, total in sums(hands, 'what').items():
        print(f'{name:20} ' + ', '.join(f'{key} {value}' for key, value in total.items()))
    for size in ((640, 480), (1920, 1080)):
        look, reaching = cost_ms(size)
        print(f'{size[0]} x {size[1]} px: look {look:.2f} ms, what reaches in {reaching:.2f} ms')
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(rows + hands, file, indent=1, default=int)


if __name__ == '__main__':
    main()
