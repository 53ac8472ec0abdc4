# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures how OpenCV decodes damaged pictures, which of them the checks find, and the time it takes.

Three in ten pictures of a stream are damaged. A row tells what became of the reads of one damage:
how many failed; of the others, how many the damage check refused, for which reason; how many
positions were wrong by more than 4 px without any check, behind the damage check, and behind the
gate that holds jumps back, which is what would be published; the largest error of these; how many
right positions were not published; and the time that each of both checks took for a picture.
"""

import argparse
from collections import Counter
from contextlib import contextmanager
import json
import os
import platform
import sys
import time

from camera_to_base.detection import LocatedObject, PreciseDifferenceDetector
from camera_to_base.errors import FrameSourceError
from camera_to_base.pipeline import DamageCheck, FrameRecord, PositionGate, Standpoint
from camera_to_base.sources import Camera
from camera_to_base.surface.models import ParallelSurface
import cv2
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'test'))
from damaged_frames import DAMAGES  # noqa: E402, I100
from mjpeg_server import MjpegServer  # noqa: E402
from rtsp_server import RtspServer  # noqa: E402
from scenes import StillCoin  # noqa: E402

TRUE, WRONG_PX = np.array([400, 300]), 4
SHARE = 0.3
STANDPOINT = Standpoint.as_calibrated(ParallelSurface(36.0, 640))
UNDAMAGED_COUNT = 20
KINDS = ['black', 'repeated', 'old_end', 'flat_end', 'large_change']


class Checks:
    """Both checks in the order in which the node applies them; what they did is in `counts`."""

    def __init__(self, background):
        self._detector = PreciseDifferenceDetector(background)
        self._damage, self._gate = DamageCheck(), PositionGate(0.3, 8.0)
        self.restart()

    def restart(self):
        """Reset the counts."""
        self.counts, self.seconds, self.largest_error_px = Counter(), Counter(), 0.0

    def apply(self, frame):
        """Judge a frame and the position on it."""
        with self._timed('damage'):
            reason = self._damage.reason(frame)
        objects = [LocatedObject(detection, None, None)
                   for detection in self._detector.detect(frame)]
        self.counts['pictures'] += 1
        self._note(objects, 'wrong', 'right')
        if reason is not None:
            self.counts[reason.kind] += 1
            return
        self._note(objects, 'wrong behind damage check', 'right behind damage check')
        with self._timed('gate'):
            record = self._gate.judge(FrameRecord(
                frame, STANDPOINT, time.monotonic(), objects=objects))
        if record.reason is None:
            error_px = self._note(record.objects, 'wrong published', 'right published')
            self.largest_error_px = max(self.largest_error_px, error_px)

    def _note(self, objects, if_wrong, if_right):
        if not objects:
            return 0.0
        error_px = np.abs(TRUE - objects[0].detection.centre).max()
        self.counts[if_wrong if error_px > WRONG_PX else if_right] += 1
        return float(error_px)

    @contextmanager
    def _timed(self, name):
        begin = time.perf_counter()
        yield
        self.seconds[name] += time.perf_counter() - begin


def measure(server_class, quality, damage, count):
    """Read some pictures, some of them damaged; return the counts as a row."""
    scene, failed = StillCoin(), 0
    with server_class(scene, 200.0, quality=quality) as server:
        camera = Camera(server.url)
        checks = Checks(camera.read())
        scene.has_disc = True
        for _ in range(UNDAMAGED_COUNT):
            checks.apply(camera.read())
        checks.restart()
        server.set_damage(damage, SHARE)
        for _ in range(count):
            try:
                frame = camera.read()
            except FrameSourceError:
                failed += 1
                continue
            checks.apply(frame)
        camera.release()
        return {'damaged': server.damaged_count, 'failed': failed, **as_row(checks)}


def as_row(checks):
    """Make a row of the checks' results."""
    counts, pictures = checks.counts, max(1, checks.counts['pictures'])
    names = [*KINDS, 'wrong', 'wrong behind damage check', 'wrong published']
    return {**{name: counts[name] for name in names},
            'largest error published px': round(checks.largest_error_px, 1),
            'right held back': counts['right'] - counts['right published'],
            'damage check ms': round(1e3 * checks.seconds['damage'] / pictures, 2),
            'gate ms': round(1e3 * checks.seconds['gate'] / pictures, 3)}


def main():
    """Measure, print and, with --json, write the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--quick', action='store_true', help='few pictures, for its exit code')
    parser.add_argument('--frames', type=int, default=150, help='reads for each row')
    parser.add_argument('--qualities', type=int, nargs='+', default=[90, 60], help='of the JPEGs')
    parser.add_argument('--json', metavar='FILE', help='write the rows as a list of objects')
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.frames, arguments.qualities = 10, arguments.qualities[:1]
    print(f'OpenCV {cv2.__version__}, numpy {np.__version__}, Python {platform.python_version()}, '
          f'{arguments.frames} reads a row')
    rows = []
    for server_class in (MjpegServer, RtspServer):
        for quality in arguments.qualities:
            for name, damage in [('none', None), *DAMAGES.items()]:
                rows.append({
                    'stream': server_class.__name__[:-len('Server')], 'quality': quality,
                    'damage': name, **measure(server_class, quality, damage, arguments.frames)})
                print(', '.join(f'{key} {value}' for key, value in rows[-1].items() if value),
                      flush=True)
    if arguments.json:
        with open(arguments.json, 'w') as file:
            json.dump(rows, file, indent=1)


if __name__ == '__main__':
    main()
