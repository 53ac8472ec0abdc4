# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What a nudged camera publishes: how many nudges are corrected, how well, and how soon.

On each surface the camera is nudged by 1 to 20 px at the farthest corner: shift, turn, zoom and
tilt mixed, at once or within half a second, at 10 to 30 frames a second. A coin lies there; in
turn, nothing else happens, a hand reaches in, the light changes, or the coin is moved at the same
time. A point is wrong if it is more than 1 mm from the coin. A nudge is corrected if right
positions come within 1.5 s from its end; the table also shows in how many cases nothing was
published at all, the errors, and how many of the points lie outside their own 99 % ellipse.

With --drifts, the camera creeps instead: 15 px in 150 s, seen at 5 frames a second.
"""

import argparse
import json
from pathlib import Path
import time

import attack_scenes as scenes
from camera_to_base.parameters import default_values
from camera_to_base.pipeline import CameraPipeline, Limits
from camera_to_base.settings import CAMERA_SPECS
from camera_to_base.sources import DEVICE
from camera_to_base.surface import HomographySurface, RadialDistortion
from camera_to_base.uncertainty import position_uncertainty, radius_for, triangle_of
import cv2
from nudge_scenes import Camera, MM_PER_PX, MOTIONS, random_nudge
import numpy as np

WRONG_MM, IN_TIME_S, AFTER_S = 1.0, 1.5, 1.6
DRIFT_PX, DRIFT_S, DRIFT_FRAMES_PER_S = 15.0, 150.0, 5.0
CASES = 'coin', 'hand', 'light', 'moved coin'
SURFACES = 'wood', 'tiles', 'print', 'faint grain', 'table edge'


class Watcher:
    """A pipeline with a calibrated camera and a clock of its own."""

    def __init__(self, camera, frames_per_s):
        matrix = np.diag([MM_PER_PX / 10, MM_PER_PX / 10, 1.0])
        lens = RadialDistortion.of_picture(scenes.SIZE, camera.coefficient)
        surface = HomographySurface(matrix, scenes.SIZE, lens)
        # The calibration itself is exact here.
        self._uncertainty = position_uncertainty({
            **default_values(CAMERA_SPECS), 'surface.model': 'homography',
            'surface.homography.distortion_coefficient': camera.coefficient,
            'surface.covariance': triangle_of(1e-14 * np.eye(14)),
            'uncertainty.height_tolerance_cm': 0.0}, surface)
        self.pipeline = CameraPipeline(surface, limits=Limits(), kind=DEVICE)
        self._now, self._step = time.monotonic() + 3600, 1 / frames_per_s

    def see(self, frame):
        """Give what is published: positions in mm, and their covariances in mm²; or the reason."""
        self._now += self._step
        sighting = self.pipeline.process(frame, self._now)
        if sighting.reason is not None:
            return [], sighting.reason
        uncertainty = self.pipeline.frame_uncertainty(frame, self._uncertainty)
        return [(np.array(one.point) * 10, uncertainty.of(one).matrix[:2, :2] * 100)
                for one in sighting.objects], None


def nudged(name, random, surface=None, case=None, motion='mixed'):
    """Nudge a camera once; give a row of what came of it."""
    table = scenes.Table(name, random, surface)
    camera = Camera(table, random, random.choice([0.0, random.uniform(-0.15, 0.05)]))
    length_px, frames_per_s = random.uniform(1, 20), random.uniform(10, 30)
    nudge, moving = random_nudge(random, length_px, motion), int(random.choice(
        [0, random.uniform(0, 0.5) * frames_per_s]))
    case = case or CASES[random.integers(len(CASES))]
    at, colour = random.uniform((90, 90), (550, 390)), table.unlike(random)
    watcher = Watcher(camera, frames_per_s)
    light = random.choice([random.uniform(0.5, 0.85), random.uniform(1.1, 1.3)])
    hand = _hand(random, at)
    row = {'surface': name, 'case': case, 'length_px': length_px, 'frames': 0, 'wrong': 0,
           'outside': 0, 'points': 0, 'errors_mm': [], 'back_s': None, 'reason': None}
    for number in range(-6, moving + int(AFTER_S * frames_per_s)):
        share = np.clip((number + 1) / (moving + 1), 0, 1)
        if number == 0 and case == 'moved coin':
            at = random.uniform((90, 90), (550, 390))
        draw = [scenes.coin(at, colour=colour)] if number >= -3 else []
        if case == 'hand' and number >= -2:
            draw += hand
        frame = camera.shoot(nudge(share), draw, light if number >= 0 and case == 'light' else 1.0)
        points, row['reason'] = watcher.see(frame)
        row['frames'] += 1
        for point, covariance in points:
            _judge(row, point - at * MM_PER_PX, covariance, number > moving)
        if points and number >= moving and row['back_s'] is None:
            row['back_s'] = (number - moving) / frames_per_s
    row['reason'] = None if row['reason'] is None else row['reason'].kind
    row['is_corrected'] = row['back_s'] is not None and row['back_s'] <= IN_TIME_S
    return row


def drifted(name, random, surface=None):
    """Let the camera creep; give a row of what came of it."""
    table = scenes.Table(name, random, surface)
    camera = Camera(table, random, random.choice([0.0, random.uniform(-0.15, 0.05)]))
    move, frames = random_nudge(random, DRIFT_PX), int(DRIFT_S * DRIFT_FRAMES_PER_S)
    at, colour = random.uniform((60, 60), (580, 420)), table.unlike(random)
    watcher = Watcher(camera, DRIFT_FRAMES_PER_S)
    row = {'surface': name, 'case': 'drift', 'length_px': DRIFT_PX, 'frames': frames, 'wrong': 0,
           'outside': 0, 'points': 0, 'errors_mm': [], 'back_s': None, 'reason': None}
    for number in range(-6, frames):
        draw = [scenes.coin(at, colour=colour)] if number >= -3 else []
        points, reason = watcher.see(camera.shoot(move(max(number, 0) / frames), draw))
        for point, covariance in points:
            _judge(row, point - at * MM_PER_PX, covariance, number >= 0)
    row['reason'] = None if reason is None else reason.kind
    # Corrected all the way: a position of nearly each frame, and of the last one.
    row['is_corrected'] = reason is None and row['points'] > 0.98 * frames
    row['back_s'] = 0.0 if row['is_corrected'] else None
    return row


def _hand(random, at):
    while True:
        edge = scenes.beyond(scenes.EDGES[random.integers(4)], random)
        tip = random.uniform((150, 100), (490, 380))
        cover = scenes.arm_cover(edge, tip, random.uniform(35, 80), random.uniform(-1, 1, 4))
        u, v = (at + scenes.MARGIN).astype(int)
        if cover[v - 45:v + 46, u - 45:u + 46].max() < 0.01:
            return [scenes.arm(cover, scenes.SKINS[random.integers(6)])]


def _judge(row, off, covariance, is_after):
    error = float(np.hypot(*off))
    row['wrong'] += error > WRONG_MM
    if is_after:
        row['points'] += 1
        row['outside'] += off @ np.linalg.solve(covariance, off) > radius_for(0.99) ** 2
        row['errors_mm'].append(error)


def told(rows):
    """Sum rows up as text."""
    errors = [error for row in rows for error in row['errors_mm']]
    back = [row['back_s'] for row in rows if row['back_s'] is not None]
    points = max(sum(row['points'] for row in rows), 1)
    text = (f'{len(rows):5} nudges, wrong {sum(row["wrong"] for row in rows)} points, corrected '
            f'{sum(row["is_corrected"] for row in rows) / len(rows):.0%}')
    if errors and back:
        text += (f', error mean {np.mean(errors):.2f}, 99 % {np.percentile(errors, 99):.2f}, '
                 f'worst {max(errors):.2f} mm, outside '
                 f'{sum(row["outside"] for row in rows) / points:.1%}, back in '
                 f'{np.median(back):.2f} s, worst {max(back):.2f} s')
    return text


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--nudges', type=int, default=75, help='of each surface')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--motion', choices=MOTIONS, default='mixed')
    parser.add_argument('--drifts', type=int, default=0,
                        help='of each surface, instead of nudges')
    parser.add_argument('--surfaces', nargs='+', default=SURFACES, metavar='NAME')
    parser.add_argument('--pictures', nargs='+', metavar='FILE', default=[],
                        help='pictures or videos to take the surfaces from, for drawn ones')
    parser.add_argument('--quick', action='store_true', help='few nudges, for its exit code')
    parser.add_argument('--json', metavar='FILE', help='write the nudges as a list of objects')
    arguments = parser.parse_args()
    surfaces = {Path(name).name: scenes.picture(name) for name in arguments.pictures}
    surfaces = surfaces or dict.fromkeys(arguments.surfaces)
    count, rows = arguments.drifts or (1 if arguments.quick else arguments.nudges), []
    print(f'OpenCV {cv2.__version__}, seed {arguments.seed}')
    for index, (name, surface) in enumerate(surfaces.items()):
        randoms = [np.random.default_rng([arguments.seed, index, number])
                   for number in range(count)]
        own = [drifted(name, random, surface) if arguments.drifts else nudged(
            name, random, surface, CASES[number % len(CASES)], arguments.motion)
            for number, random in enumerate(randoms)]
        print(f'{name:16}{told(own)}', flush=True)
        rows += own
    for case in CASES:
        own = [row for row in rows if row['case'] == case]
        if own:
            print(f'{case:16}{told(own)}')
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(rows, file, indent=1, default=float)


if __name__ == '__main__':
    main()
