# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures the default detector on a busy table: print, grain, ten objects with soft shade, a hand.

    scripts/benchmark busy_table [--quick] [--json FILE]

Of each frame, the CPU time in ms and relative to the tutorial's calls on the same frames (medians,
one thread, they take turns): while the objects are new, while they lie still, while a hand reaches
in, and while all of them move. Frames have noise and went through JPEG. `found` counts the objects
that are found, beside those that the hand touches or shades.
"""

import argparse
import time
from typing import Any, Dict, Iterator, List, Tuple

from camera_to_base.detection import PreciseDifferenceDetector
import cv2
from methods import METHODS
import numpy as np
from rows import print_rows

SIZES = (640, 480), (1280, 720), (1920, 1080)
# Middles, as a part of the picture's size, and reflectances, B, G and R.
_PLACES = [(u, v) for v in (0.2, 0.5, 0.8) for u in (0.15, 0.35, 0.55, 0.75)][:10]
_COLOURS = ((20, 30, 150), (150, 60, 20), (40, 120, 30), (20, 150, 190), (35, 35, 35))
_RADIUS, _SHADE, _DEPTH, _NOISE, _QUALITY = 0.03, 0.6, 0.45, 1.5, 90
_NEW, _STILL, _HAND, _MOVING = 3, 30, 20, 20


def table(size: Tuple[int, int]) -> np.ndarray:
    """Draw a table with a grain and a printed grid; shape (h, w, 3), float32."""
    width, height = size
    random = np.random.default_rng(3)
    grain = random.standard_normal((height, width), dtype=np.float32)
    grain = cv2.GaussianBlur(grain, (0, 0), width / 200, sigmaY=width / 900)
    picture = np.float32([120, 150, 170]) * (1 + 0.05 * grain / grain.std())[..., None]
    for line in range(width // 20, width, width // 10):
        cv2.line(picture, (line, 0), (line, height), (90, 90, 90), 2, cv2.LINE_AA)
    return picture


def scene(background: np.ndarray, shift: float = 0.0, hand: float = 0.0) -> np.ndarray:
    """
    Lay the objects on a table, each with its soft shade.

    :param shift: How far they have moved to the right, in px.
    :param hand: How far a hand reaches in from the left, as a part of the width.
    """
    height, width = background.shape[:2]
    radius = _RADIUS * width
    discs = [(u * width + shift, v * height) for u, v in _PLACES]
    shade = np.zeros((height, width), np.float32)
    for u, v in discs:
        _disc(shade, (u + _SHADE * radius, v + _SHADE * radius / 2), radius, 1.0)
    picture = background * (1 - _DEPTH * cv2.GaussianBlur(shade, (0, 0), radius / 5))[..., None]
    for index, centre in enumerate(discs):
        _disc(picture, centre, radius, _COLOURS[index % len(_COLOURS)])
    if hand:
        end = int(hand * width), int(0.35 * height)
        cv2.line(picture, (-width, end[1]), end, (110, 140, 205), int(2.5 * radius), cv2.LINE_AA)
    return picture


def _disc(picture: np.ndarray, centre: Tuple[float, float], radius: float, colour: Any) -> None:
    place = tuple(int(round(16 * length)) for length in centre)
    cv2.circle(picture, place, int(16 * radius), colour, -1, cv2.LINE_8, 4)


def seen(picture: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Take a picture: a slight blur, noise and JPEG."""
    picture = cv2.GaussianBlur(picture, (0, 0), 0.7)
    noise = random.standard_normal(picture.shape, dtype=np.float32) * np.float32(_NOISE)
    frame = np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)
    coded = cv2.imencode('.jpg', frame, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1]
    return cv2.imdecode(coded, cv2.IMREAD_COLOR)


def measure(size: Tuple[int, int], share: float) -> Iterator[Dict[str, Any]]:
    """Measure a size: a row for each part of the scene."""
    random, background = np.random.default_rng(1), table(size)
    empty = seen(background, random)
    detector, tutorial = PreciseDifferenceDetector(empty), METHODS['tutorial'](empty)
    detector.detect(seen(background, random))
    parts: Dict[str, List[np.ndarray]] = {
        'new': [scene(background)] * _NEW,
        'still': [scene(background)] * int(share * _STILL),
        'hand': [scene(background, hand=0.05 + 0.005 * number)
                 for number in range(int(share * _HAND))],
        'moving': [scene(background, 0.4 * number + 1)
                   for number in range(int(share * _MOVING))]}
    for part, pictures in parts.items():
        times, usual, found = [], [], []
        for picture in pictures:
            frame = seen(picture, random)
            begin = time.thread_time()
            tutorial.detect(frame)
            middle = time.thread_time()
            objects = detector.detect(frame)
            times.append(1e3 * (time.thread_time() - middle))
            usual.append(1e3 * (middle - begin))
            found.append(sum(not one.cut_off for one in objects))
        reference = float(np.median(usual))
        yield {'width': size[0], 'part': part, 'found': round(float(np.mean(found)), 2),
               'tutorial_ms': round(reference, 2), 'p50_ms': round(float(np.median(times)), 1),
               'max_ms': round(max(times), 1),
               'p50_ratio': round(float(np.median(times)) / reference, 1)}


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='few frames, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    sizes = SIZES[:1] if arguments.quick else SIZES
    print_rows((row for size in sizes
                for row in measure(size, 0.2 if arguments.quick else 1.0)), arguments.json)


if __name__ == '__main__':
    main()
