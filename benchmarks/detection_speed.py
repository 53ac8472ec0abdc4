# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures the time of each method relative to the tutorial's OpenCV calls on the same frames.

    scripts/benchmark detection_speed [--quick] [--json FILE]

One thread, CPU time; each method takes turns with the tutorial; the ratio is that of the medians.
The frames of a scene take up more memory than a core's cache holds, as a camera's do; with --warm,
each is read just before. The second table is for frames that take the default detector's long way.
"""

import argparse
import json
import sys
import time
from typing import List

import cv2
from detection_accuracy import versions
from methods import METHODS
import numpy as np
from photometric import Conditions, Lamp, Photographer
from speed_scenes import make_frames, SCENES, TABLES

SIZES = (640, 480), (1920, 1080)
LONG_WAY = {
    'own shadow, small lamp': Conditions(thickness=12, lamp=Lamp(radius=5)),
    'own shadow, wide lamp': Conditions(thickness=12, lamp=Lamp(radius=250)),
    'light object and shadow': Conditions(colour=(0.8,), thickness=12, lamp=Lamp(radius=20)),
    'highlight': Conditions(gloss=1.5),
    'faint': Conditions(colour=(0.34, 0.37, 0.4)),
    'two colours': Conditions(second_colour=(0.6,)),
    'ring': Conditions(shape='ring'),
    'lamp flickers': Conditions(flicker=0.15),
    'light from outside': Conditions(shade=0.5),
}
_FRAMES_BYTES = 64e6
_SETTLED = 20  # frames until light and noise are known


def measure(scene: str, names: dict, methods: List[str], turns: int, warm: bool,
            background: np.ndarray, frames: List[np.ndarray]) -> List[dict]:
    """Time each method on a scene's frames, in turns with the tutorial."""
    rows = []
    for name in methods:
        reference, method = time_in_turns(
            [METHODS['tutorial'](background), METHODS[name](background)], frames, turns, warm)
        rows.append({'method': name, 'scene': scene, **names, 'width': background.shape[1],
                     'height': background.shape[0], 'ratio': reference / method,
                     'ms': 1e3 * method})
    return rows


def time_in_turns(
    detectors: list, frames: List[np.ndarray], turns: int, warm: bool
) -> List[float]:
    """
    Time detectors, one after the other on every frame.

    Two at a time, and not all at once: a background model goes through tens of megabytes, and the
    next one in turn would be timed with an empty cache.

    :returns: The median of each, in s.
    """
    for index in range(min(_SETTLED, turns)):
        for detector in detectors:
            detector.detect(frames[index % len(frames)])
    times: List[List[float]] = [[] for _ in detectors]
    for turn in range(turns):
        for index, detector in enumerate(detectors):
            # Not the frame that the one before has just read, unless it shall be in the cache.
            frame = frames[(turn + (not warm) * index * (len(frames) // 2)) % len(frames)]
            if warm:
                frame.max()
            start = time.process_time()
            detector.detect(frame)
            times[index].append(time.process_time() - start)
    return [float(np.median(values)) for values in times]


def measure_tables(methods: List[str], quick: bool, warm: bool) -> List[dict]:
    """Print and return the table of all scenes on all tables, size by size."""
    rows = []
    for size in SIZES[:1] if quick else SIZES:
        turns = 4 if quick else max(24, int(150 * 640 * 480 / (size[0] * size[1])))
        count = 2 if warm or quick else int(
            min(max(_FRAMES_BYTES / (size[0] * size[1] * 3), 2), 40))
        for table in TABLES:
            print(f'\n{f"{size[0]} x {size[1]}, {table}":26}'
                  + ''.join(f'{name:>20}' for name in methods))
            for scene in SCENES:
                background, frames = make_frames(table, scene, size, count)
                results = measure(
                    scene, {'table': table}, methods, turns, warm, background, frames)
                rows += results
                print(f'{scene:26}' + ''.join(
                    f'{row["ratio"]:9.2f} ({row["ms"]:5.2f} ms)' for row in results), flush=True)
    return rows


def measure_long_way(quick: bool) -> List[dict]:
    """Print and return the times for one object that is not plain, and for light's field."""
    rows = []
    print(f'\n{"640 x 480, photometric":26}{"tutorial ÷ precise":>20}{"precise, ms":>14}')
    for scene, conditions in list(LONG_WAY.items())[:1 if quick else None]:
        camera = Photographer(conditions, 1)
        background = camera.background()
        frames = [camera.frame()[0] for _ in range(2 if quick else 8)]
        row, = measure(scene, {'table': 'photometric'}, ['precise'], 4 if quick else 80, False,
                       background, frames)
        rows.append(row)
        print(f'{scene:26}{row["ratio"]:20.2f}{row["ms"]:14.2f}', flush=True)
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='few turns, for its exit code')
    parser.add_argument('--warm', action='store_true', help='frames that are in the cache')
    parser.add_argument('--method', action='append', choices=METHODS, help='only this one')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    methods = ['tutorial', *(arguments.method or [name for name in METHODS if name != 'tutorial'])]
    print(versions(), 'one thread, CPU time; tutorial ÷ method (time of the method)')
    rows = measure_tables(methods, arguments.quick, arguments.warm)
    if 'precise' in methods:
        rows += measure_long_way(arguments.quick)
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump(rows, file, indent=1)


if __name__ == '__main__':
    sys.exit(main())
