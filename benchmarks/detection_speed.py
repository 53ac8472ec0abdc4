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
Measures the time of each method relative to the tutorial's OpenCV calls on the same frames.

    scripts/benchmark detection_speed [--quick] [--json FILE]

One thread; each method takes turns with the tutorial; the ratio is that of the medians. The
frames of a scene take up more memory than a core's cache holds, as a camera's do; with --warm,
each is read just before.
"""

import argparse
import json
import sys
import time
from typing import List, Tuple

import cv2
from detection_accuracy import versions
from methods import METHODS
import numpy as np

SIZES = (640, 480), (1280, 720), (3840, 2160)
_TABLE, _COIN, _NOISE = 200, 60, 1.5
# Total size of the frames in bytes: larger than the cache of one core.
_FRAMES_BYTES = 64e6
# In parts of the picture's width and height.
_FAR_APART = (0.12, 0.15), (0.88, 0.14), (0.5, 0.5), (0.13, 0.86), (0.87, 0.85)


def make_frames(scene: str, size: Tuple[int, int], count: int) -> List[np.ndarray]:
    """Render frames of a scene: a noisy table, with coins where the scene has some."""
    width, height = size
    rng = np.random.default_rng(1)
    frames = []
    for number in range(count):
        picture = np.full((height, width, 3), _TABLE, np.uint8)
        if scene == 'everything changed':
            cells = rng.integers(0, 100, (12, 16, 1), dtype=np.uint8)
            picture[:] = cv2.resize(cells, size, interpolation=cv2.INTER_NEAREST)[:, :, None]
        for u, v in {'one coin': [(0.4 + 0.01 * number, 0.55)],
                     'several far apart': _FAR_APART}.get(scene, []):
            centre = int(u % 1 * width), int(v * height)
            cv2.circle(picture, centre, round(0.0336 * width), (_COIN,) * 3, -1, cv2.LINE_AA)
        noise = rng.standard_normal(picture.shape, dtype=np.float32) * np.float32(_NOISE)
        frames.append(np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8))
    return frames


def measure(
    scene: str, size: Tuple[int, int], methods: List[str], turns: int, warm: bool
) -> List[dict]:
    """Time each method on a scene, in turns with the tutorial."""
    count = 2 if warm else int(min(max(_FRAMES_BYTES / (size[0] * size[1] * 3), 2), 40))
    background, *_ = make_frames('nothing there', size, 1)
    frames = make_frames(scene, size, count)
    rows = []
    for name in methods:
        reference, method = time_in_turns(
            [METHODS['tutorial'](background), METHODS[name](background)], frames, turns, warm)
        rows.append({'method': name, 'scene': scene, 'width': size[0], 'height': size[1],
                     'ratio': reference / method, 'ms': 1e3 * method})
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
    times: List[List[float]] = [[] for _ in detectors]
    for turn in range(turns):
        for index, detector in enumerate(detectors):
            # Not the frame that the one before has just read, unless it shall be in the cache.
            frame = frames[(turn + (not warm) * index * (len(frames) // 2)) % len(frames)]
            if warm:
                frame.max()
            start = time.perf_counter()
            detector.detect(frame)
            times[index].append(time.perf_counter() - start)
    return [float(np.median(values[1:])) for values in times]


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
    print(versions(), 'one thread; tutorial ÷ method')
    rows = []
    for size in SIZES[:1] if arguments.quick else SIZES:
        turns = 4 if arguments.quick else max(16, int(150 * 640 * 480 / (size[0] * size[1])))
        print(f'\n{f"{size[0]} x {size[1]}":22}' + ''.join(f'{name:>22}' for name in methods))
        for scene in ('nothing there', 'one coin', 'several far apart', 'everything changed'):
            results = measure(scene, size, methods, turns, arguments.warm)
            rows += results
            print(f'{scene:22}' + ''.join(
                f'{row["ratio"]:10.2f} ({row["ms"]:6.2f} ms)' for row in results), flush=True)
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump(rows, file, indent=1)


if __name__ == '__main__':
    sys.exit(main())
