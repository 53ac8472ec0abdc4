# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
What a camera that is bumped, and hands that reach in, make the pipeline publish.

Bumps: short days on each surface, on which the camera is bumped or not, with a coin that rests or
moves, with hands, and with steps of the light. Hands: one to three come, hover and go, beside a
coin, over it, shading it, or without one; the table's colour differs from theirs by 8 to 150
levels. Sleeves: the same with arms of the table's own colour, to 5 levels. A frame is stopped
where the view holds it back though the camera did not move. `attack_days` plays the days,
`attack_scenes` draws them.
"""

import argparse
import json
from pathlib import Path
import time

from attack_days import day_with_bumps, day_with_hand
import attack_scenes as scenes
from camera_to_base.pipeline.reaching_in import ReachingIn
from camera_to_base.pipeline.view.quick_look import QuickLook
import cv2
import numpy as np


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


def report(rows, *keys):
    """Print the sums of some rows by each of their columns."""
    for key in keys:
        for name, total in sums(rows, key).items():
            print(f'{name:24} ' + ', '.join(f'{name} {count}' for name, count in total.items()),
                  flush=True)


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--days', type=int, default=10, help='of each surface, and ten of hands')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--pictures', nargs='+', metavar='FILE', default=[],
                        help='pictures or videos to take the surfaces from, for drawn ones')
    parser.add_argument('--quick', action='store_true', help='few days, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the days as a list of objects')
    arguments = parser.parse_args()
    days = 1 if arguments.quick else arguments.days
    surfaces = {**scenes.SURFACES, **{
        Path(name).name: scenes.picture(name) for name in arguments.pictures}}
    names = [Path(name).name for name in arguments.pictures] or list(scenes.SURFACES)
    names = names[:2] if arguments.quick else names

    def table(random, name=None):
        name = name or str(random.choice(['plain', *names]))
        return scenes.Table(name, random, surfaces[name])

    def randoms(kind, count):
        return (np.random.default_rng([arguments.seed, kind, day]) for day in range(count))

    rows = [day_with_bumps(table(random, name), random) for number, name in enumerate(names)
            for random in randoms(number, days)]
    report(rows, 'surface', 'what')
    count = 1 if arguments.quick else 10 * days
    hands = [day_with_hand(table(random), random) for random in randoms(1000, count)]
    report(hands, 'what')
    sleeves = [day_with_hand(table(random), random, levels=5) for random in randoms(1001, count)]
    sleeves = [{**row, 'what': 'sleeve of the table'} for row in sleeves]
    report(sleeves, 'what')
    for size in ((640, 480), (1920, 1080))[:1 if arguments.quick else None]:
        look, reaching = cost_ms(size)
        print(f'{size[0]} x {size[1]} px: look {look:.2f} ms, what reaches in {reaching:.2f} ms')
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(rows + hands + sleeves, file, indent=1, default=int)


if __name__ == '__main__':
    main()
