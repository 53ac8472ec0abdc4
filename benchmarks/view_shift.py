# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures the view check: a table of camera moves, disturbances and surfaces.

For each pair it prints the median of the measured shift, in px, and the number of frames beyond
the limit (found if the camera moved, false alarms if it did not) or without a result (?). The true
shift is that of the farthest corner. One check makes all comparisons of a cell, as in the node.
"""

import argparse
import json
import time

from camera_to_base.pipeline import Limits, ViewCheck
from camera_to_base.simulation import SimulatedBoard
import cv2
import numpy as np

WIDTH, HEIGHT, MARGIN = 640, 480, 60
MOVES = {'none': (0, 0, 0), '1 px': (1, 0, 0), '2 px': (1.4, 1.4, 0), '5 px': (3, -4, 0),
         '20 px': (-16, 12, 0), '0.5 deg': (0, 0, 0.5), '2 deg': (0, 0, 2)}


def board():
    """Draw the simulated board without noise, with a margin."""
    return SimulatedBoard(image_size=(WIDTH + 2 * MARGIN, HEIGHT + 2 * MARGIN), noise=0.0,
                          width_cm=42.75).read()


def wood():
    """Draw a surface with a soft texture."""
    random = np.random.default_rng(3)
    field = random.normal(0, 1, (HEIGHT + 2 * MARGIN, WIDTH + 2 * MARGIN)).astype(np.float32)
    field = cv2.GaussianBlur(field, (0, 0), 12, sigmaY=2)
    return cv2.merge([np.clip(170 + 120 * field, 0, 255).astype(np.uint8)] * 3)


def tiles():
    """Draw a surface of strong contrast."""
    v, u = np.mgrid[:HEIGHT + 2 * MARGIN, :WIDTH + 2 * MARGIN]
    random = np.random.default_rng(4)
    field = random.integers(60, 240, (20, 20))[v // 47, u // 53]
    return cv2.merge([field.astype(np.uint8)] * 3)


def plain():
    """Draw a surface without structure."""
    return np.full((HEIGHT + 2 * MARGIN, WIDTH + 2 * MARGIN, 3), 200, np.uint8)


def seen(surface, move, random, noise=2.0, disturb=None):
    """Take a picture of the surface with a camera that was moved."""
    du, dv, angle = move
    height, width = surface.shape[:2]
    warp = cv2.getRotationMatrix2D((width / 2, height / 2), angle, 1)
    warp[:, 2] += du, dv
    moved = cv2.warpAffine(surface, warp, (width, height), borderMode=cv2.BORDER_REFLECT)
    picture = moved[MARGIN:-MARGIN, MARGIN:-MARGIN].astype(np.float32)
    if disturb is not None:
        picture = disturb(picture, random)
    picture += random.normal(0, noise, picture.shape)
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def coin(picture, random):
    """Draw a coin at a random place."""
    at = int(random.integers(60, WIDTH - 60)), int(random.integers(60, HEIGHT - 60))
    return cv2.circle(picture.copy(), at, 21, (52, 60, 70), -1, cv2.LINE_AA)


def hand(picture, random):
    """Reach in with an arm and a hand."""
    picture = picture.copy()
    at = np.array([random.integers(200, 440), random.integers(160, 320)])
    edge = np.array([random.integers(100, 540), HEIGHT])
    cv2.line(picture, [int(x) for x in edge], [int(x) for x in at], (90, 120, 170), 90)
    cv2.circle(picture, [int(x) for x in at], 75, (100, 130, 180), -1)
    return picture


def brighter(picture, random):
    """Change the exposure by a step."""
    return picture * 1.15 + 5


def sunlight(picture, random):
    """Brighten one side and darken the other."""
    ramp = np.linspace(0.8, 1.25, WIDTH, dtype=np.float32)[None, :, None]
    picture = picture * ramp
    picture[:, 450:] *= 0.85
    return picture


DISTURBANCES = {'nothing': None, 'coin': coin, 'hand': hand, 'brighter': brighter,
                'sun and shadow': sunlight}
SURFACES = {'board': board, 'wood': wood, 'tiles': tiles, 'plain': plain}


def true_shift(move):
    """Return the shift of the farthest corner, in px."""
    warp = cv2.getRotationMatrix2D((WIDTH / 2, HEIGHT / 2), move[2], 1)
    warp[:, 2] += move[:2]
    corners = np.array([[0, 0, 1], [WIDTH, 0, 1], [0, HEIGHT, 1], [WIDTH, HEIGHT, 1]])
    return np.hypot(*(corners @ warp.T - corners[:, :2]).T).max()


def measure(surface, move, disturb, rounds, noise=2.0):
    """Compare some pictures; return the measured shifts, None without a result."""
    random = np.random.default_rng(7)
    check = ViewCheck(seen(surface, (0, 0, 0), random, noise))
    return [check.compare(seen(surface, move, random, noise, disturb)).shift_px
            for _ in range(rounds)]


def cost_ms(surface, size, rounds=20):
    """Return the median time of a comparison, in ms."""
    random = np.random.default_rng(7)
    frames = [cv2.resize(seen(surface, move, random), size)
              for move in (MOVES['none'], MOVES['2 px'])]
    check, times = ViewCheck(frames[0]), []
    for _ in range(rounds):
        begin = time.perf_counter()
        check.compare(frames[1])
        times.append(time.perf_counter() - begin)
    return np.median(times) * 1e3


def text(shifts, limit):
    """Write one cell."""
    told = [shift for shift in shifts if shift is not None]
    if not told:
        return f'? {len(shifts)}'
    beyond, unknown = sum(shift > limit for shift in told), len(shifts) - len(told)
    return f'{np.median(told):.1f} {beyond}/{len(shifts)}' + (f' ?{unknown}' if unknown else '')


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rounds', type=int, default=10)
    parser.add_argument('--limit', type=float, default=Limits().max_shift_px,
                        help='view.max_shift_px')
    parser.add_argument('--quick', action='store_true', help='few frames, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the cells as a list of objects')
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.rounds = 1
    rows = []
    print(f'OpenCV {cv2.__version__}, noise 2 grey levels, limit {arguments.limit} px, '
          f'{arguments.rounds} frames a cell')
    for name, draw in list(SURFACES.items())[:2 if arguments.quick else None]:
        surface = draw()
        print(f'\n{name:16}' + ''.join(f'{other:>17}' for other in DISTURBANCES))
        for move_name, move in MOVES.items():
            cells = {other: measure(surface, move, disturb, arguments.rounds)
                     for other, disturb in DISTURBANCES.items()}
            print(f'{move_name:8} ({true_shift(move):4.1f}) ' + ''.join(
                f'{text(cell, arguments.limit):>17}' for cell in cells.values()), flush=True)
            rows += [{'surface': name, 'move': move_name, 'disturbance': other,
                      'true_px': true_shift(move), 'told_px': cell}
                     for other, cell in cells.items()]
    print('\nms a comparison: ' + ', '.join(
        f'{cost_ms(wood(), size):.1f} at {size[0]} x {size[1]} px'
        for size in ((640, 480), (1280, 720), (1920, 1080))))
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(rows, file, indent=1)


if __name__ == '__main__':
    main()
