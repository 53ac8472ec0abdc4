# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures whether the default detector publishes light as an object, with coins beside it.

    scripts/benchmark light_patches [--folder FOLDER] [--count 8] [--seed 1] [--quick] [-v]

Patches of sun, moved shadows, reflections and smooth lobes are laid over rendered tables in linear
light, and over the backgrounds of the scenes of `real_pictures` that FOLDER has clones of. Frame
and background each have their own noise and go through JPEG. The detector is new for each picture.
`published` counts the pictures with a report that is no coin and not cut off, `unsaid` those on
which one of these is not marked as what may be light, `said` those on which light is named as left
out; a coin is `found` within 1 px, and `lost` without a report on it.
`p50_ms` is CPU time of one thread. A picture depends on seed, table, kind and number alone.
"""

import argparse
from pathlib import Path
import time
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple
import zlib

from camera_to_base.detection import PreciseDifferenceDetector
import cv2
import numpy as np
from real_pictures import LABELS, read_background, read_scene
from rows import print_rows

# B, G, R of the rendered tables, and by which part their grain changes them.
TABLES = {'white': ((200, 200, 200), 0.0), 'grey': ((120, 120, 120), 0.0),
          'felt': ((60, 120, 40), 0.0), 'wood': ((110, 145, 170), 0.03)}
_SIZE, _NOISE, _QUALITY = (640, 480), 1.5, 90
_LEAST_PX, _MOST_PX, _MOST_SHARE = 40, 200, 0.4  # of a patch; the share is of the picture
_COINS, _RADII, _UNLIKE, _CANDIDATES = 2, (8, 22), 60, 30
# Coins stay so far from light that changes the picture by more than that part.
_GAP_PX, _TOUCHED = 20, 0.05
_FOUND_PX = 1.0
_LIGHT_KINDS = {'light_or_thing', 'light', 'shade'}


class Light(NamedTuple):
    """
    What light changes on a picture: light * gain + added, in linear light, 1 is white.

    :param gain: Shape (h, w, 3), B, G and R, or (h, w, 1) for all of them.
    :param added: Shape (h, w, 1).
    """

    gain: np.ndarray
    added: np.ndarray


class Coin(NamedTuple):
    """A disc: its middle u, v and its radius, in px."""

    place: Tuple[float, float]
    radius: float


class Outcome(NamedTuple):
    """What the detector does on one picture, see the module."""

    number: int
    published: List[Tuple[float, float]]
    unsaid: bool
    said: bool
    coins: int
    found: int
    lost: int
    ms: float


def _sun(random: np.random.Generator, size: Tuple[int, int]) -> Light:
    tint = 1 + random.uniform(-0.025, 0.025, 3)
    return _covered(random, size, random.uniform(1.3, 2.5) * tint)


def _shade(random: np.random.Generator, size: Tuple[int, int]) -> Light:
    tint = 1 + random.uniform(0, 0.025) * np.array([1, 0, -1])  # the sky's light is left: bluish
    return _covered(random, size, random.uniform(0.3, 0.75) * tint)


def _reflection(random: np.random.Generator, size: Tuple[int, int]) -> Light:
    patch = _patch(random, size, random.uniform(4, 10))
    return Light(np.ones_like(patch), random.uniform(0.05, 0.3) * patch)


def _lobe(random: np.random.Generator, size: Tuple[int, int]) -> Light:
    v, u = np.mgrid[:size[1], :size[0]].astype(np.float32)
    gain = np.ones_like(u)
    for _ in range(random.integers(1, 4)):
        x, y = random.uniform((0, 0), size)
        squared = ((u - x) ** 2 + (v - y) ** 2) / random.uniform(20, 90) ** 2
        gain *= 1 + random.uniform(-0.3, 0.3) * np.exp(-squared / 2)
    return Light(gain[..., None], np.zeros((*gain.shape, 1)))


KINDS: Dict[str, Callable[[np.random.Generator, Tuple[int, int]], Light]] = {
    'sun': _sun, 'shade': _shade, 'reflection': _reflection, 'lobe': _lobe}


def _covered(random: np.random.Generator, size: Tuple[int, int], gain: np.ndarray) -> Light:
    patch = _patch(random, size, random.uniform(0.7, 2.5))
    return Light(1 + patch * (gain - 1), np.zeros_like(patch))


def _patch(random: np.random.Generator, size: Tuple[int, int], blur: float) -> np.ndarray:
    """Draw a patch that lies inside of the picture: shape (h, w, 1), float32, 0 to 1."""
    most = min(_MOST_PX, _MOST_SHARE * min(size))
    corners = _corners(random)
    corners *= random.uniform(_LEAST_PX, most, 2) / np.ptp(corners, axis=0)
    angle = random.uniform(0, 2 * np.pi)
    corners = corners @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    margin = np.abs(corners).max(axis=0) + 3 * blur + 2
    corners += margin + random.uniform(0, 1, 2) * (size - 2 * margin)
    patch = np.zeros(size[::-1], np.uint8)
    cv2.fillPoly(patch, [np.rint(corners * 16).astype(np.int32)], 255, cv2.LINE_AA, 4)
    return cv2.GaussianBlur(np.float32(patch) / 255, (0, 0), blur)[..., None]


def _corners(random: np.random.Generator) -> np.ndarray:
    """Draw a polygon, an ellipse or a parallelogram around 0, of any size."""
    shape = random.integers(3)
    if shape == 0:
        slant = random.uniform(-0.4, 0.4)
        return np.array([(slant - .5, -.5), (slant + .5, -.5), (.5 - slant, .5),
                         (-.5 - slant, .5)])
    count = 64 if shape == 1 else random.integers(3, 9)
    uneven = 0.0 if shape == 1 else 0.35
    turns = 2 * np.pi * (np.arange(count) + random.uniform(-uneven, uneven, count)) / count
    radii = 0.5 - uneven * random.uniform(0, 0.6, count)
    return np.column_stack([np.cos(turns), np.sin(turns)]) * radii[:, None]


def _with_coins(
    random: np.random.Generator, table: np.ndarray, light: Light
) -> Tuple[np.ndarray, List[Coin]]:
    """Lay coins on a table, away from the light, as far as there is room for them."""
    touched = (np.abs(light.gain - 1).max(axis=2) > _TOUCHED) | (light.added[..., 0] > 0.002)
    touched[[0, -1]] = touched[:, [0, -1]] = True
    v, u = np.mgrid[:table.shape[0], :table.shape[1]].astype(np.float32)
    picture, coins = table.copy(), []
    for _ in range(_COINS):
        radius = random.uniform(*_RADII)
        room = cv2.distanceTransform(np.uint8(~touched), cv2.DIST_L2, 5)
        free = np.argwhere(room > radius + _GAP_PX)
        if not len(free):
            break
        y, x = free[random.integers(len(free))] + random.uniform(-0.5, 0.5, 2)
        distance = np.hypot(u - x, v - y)
        cover = np.clip(radius + 0.5 - distance, 0, 1)[..., None]
        picture += cover * (_look(random, table[distance < radius]) - picture)
        touched |= distance < radius
        coins.append(Coin((float(x), float(y)), radius))
    return picture, coins


def _look(random: np.random.Generator, below: np.ndarray) -> np.ndarray:
    """Draw a neutral or a colourful look that is unlike what a coin covers; shape (3,), levels."""
    is_neutral = random.random() < 0.5
    looks = [random.uniform(15, 240, 1 if is_neutral else 3) * np.ones(3)
             for _ in range(_CANDIDATES)]
    # Of those that are unlike enough, this is the first.
    return max(looks, key=lambda look: min(
        _UNLIKE, np.percentile(np.abs(below - look).max(axis=1), 5)))


def _linear(levels: np.ndarray) -> np.ndarray:
    # The curve of sRGB, and back.
    coded = np.float32(levels) / 255
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def _levels(light: np.ndarray) -> np.ndarray:
    coded = np.where(light <= 0.0031308, 12.92 * light,
                     1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)
    return 255 * coded


def _photograph(levels: np.ndarray, random: np.random.Generator) -> np.ndarray:
    noisy = levels + _NOISE * random.standard_normal(levels.shape, dtype=np.float32)
    picture = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    _, data = cv2.imencode('.jpg', picture, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    return cv2.imdecode(data, cv2.IMREAD_COLOR)


def _random(seed: int, *names: str) -> np.random.Generator:
    return np.random.default_rng([seed, zlib.crc32('/'.join(names).encode())])


def _rendered(name: str, seed: int) -> np.ndarray:
    colour, share = TABLES[name]
    grain = _random(seed, name).standard_normal(_SIZE[::-1], dtype=np.float32)
    grain = cv2.GaussianBlur(grain, (0, 0), 7, sigmaY=1.2)
    return np.float32(colour) * (1 + share * grain / grain.std())[..., None]


def play(table: np.ndarray, kind: str, number: int, random: np.random.Generator) -> Outcome:
    """Detect on one picture; the odd numbers have coins."""
    light = KINDS[kind](random, table.shape[1::-1])
    scene, coins = _with_coins(random, table, light) if number % 2 else (table, [])
    background = _photograph(table, random)
    frame = _photograph(_levels(_linear(scene) * light.gain + light.added), random)
    detector = PreciseDifferenceDetector(background)
    start = time.thread_time()
    detected = [one for one in detector.detect(frame) if not one.cut_off]
    ms = 1e3 * (time.thread_time() - start)
    off = [min((_distance(one.centre, coin) for one in detected), default=np.inf)
           for coin in coins]
    others = [one for one in detected if not _is_on_coin(one.centre, coins)]
    return Outcome(
        number, [one.centre for one in others],
        not all(one.may_be_light for one in others),
        any(one.kind in _LIGHT_KINDS and not _is_on_coin(one.position, coins)
            for one in detector.dropped),
        len(coins), sum(one <= _FOUND_PX for one in off),
        sum(one > coin.radius for one, coin in zip(off, coins)), ms)


def _distance(centre: Tuple[float, float], coin: Coin) -> float:
    return float(np.hypot(*np.subtract(centre, coin.place)))


def _is_on_coin(centre: Tuple[float, float], coins: List[Coin]) -> bool:
    return any(_distance(centre, coin) <= coin.radius for coin in coins)


def _row(table: str, kind: str, outcomes: List[Outcome]) -> Dict[str, Any]:
    return {'table': table, 'kind': kind, 'pictures': len(outcomes),
            'published': sum(bool(one.published) for one in outcomes),
            'unsaid': sum(one.unsaid for one in outcomes),
            'said': sum(one.said for one in outcomes),
            **{name: sum(getattr(one, name) for one in outcomes)
               for name in ('coins', 'found', 'lost')},
            'p50_ms': round(float(np.median([one.ms for one in outcomes])), 1)}


def measure(
    tables: Iterator[Tuple[str, np.ndarray]], count: int, seed: int, is_verbose: bool
) -> Iterator[Dict[str, Any]]:
    """Give a row for each table and kind, and at last for each kind on all tables."""
    everything: Dict[str, List[Outcome]] = {kind: [] for kind in KINDS}
    for name, table in tables:
        for kind in KINDS:
            outcomes = [play(table, kind, number, _random(seed, name, kind, str(number)))
                        for number in range(count)]
            for one in outcomes:
                if is_verbose and (one.published or one.found < one.coins):
                    places = [tuple(map(round, place)) for place in one.published]
                    print(f'wrong: {name} {kind} {one.number}: published {places}, '
                          f'coins {one.found} of {one.coins}')
            everything[kind] += outcomes
            yield _row(name, kind, outcomes)
    for kind, outcomes in everything.items():
        yield _row('all', kind, outcomes)


def _tables(seed: int, folder: Optional[Path]) -> Iterator[Tuple[str, np.ndarray]]:
    for name in TABLES:
        yield name, _rendered(name, seed)
    for scene in map(read_scene, sorted(LABELS.glob('*.txt')) if folder else []):
        root = folder / scene.clone
        if root.is_dir():
            yield scene.name, np.float32(read_background(root, scene.background))
        else:
            print(f'left out {scene.name}: no clone of {scene.repository} in {folder}')


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--folder', type=Path, help='where the clones are')
    parser.add_argument('--count', type=int, default=8, help='pictures of each table and kind')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--quick', action='store_true', help='two pictures of each')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    parser.add_argument('-v', action='store_true', help='name each picture that is wrong')
    options = parser.parse_args()
    cv2.setNumThreads(1)
    print_rows(measure(_tables(options.seed, options.folder), 2 if options.quick else
                       options.count, options.seed, options.v), options.json)


if __name__ == '__main__':
    main()
