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
What OpenCV makes of damaged pictures, and what our checks make of that: a table.

For each damage, of three in ten pictures of a stream: how many reads gave a picture (True), how
many failed, what the damage check caught, how many of the positions that were left were wrong by
more than 4 px, how many of these the jump filter let through, and what the check costs.
"""

import argparse
from collections import Counter
import os
import sys
import time

from camera_to_base.absolute_difference import AbsoluteDifferenceDetector
from camera_to_base.cameras import Camera
from camera_to_base.damage_check import DamageCheck
from camera_to_base.errors import FrameSourceError
from camera_to_base.jump_filter import JumpFilter
import cv2
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'test'))
from damage import DAMAGES  # noqa: E402, I100
from mjpeg_server import MjpegServer  # noqa: E402
from rtsp_server import RtspServer  # noqa: E402
from scenes import still_coin  # noqa: E402

TRUE = np.array([400, 300])


def measure(server_class, quality, damage, count):
    """Read some damaged pictures; give what became of them, by name."""
    counts, spent = Counter(), 0.0
    empty_until = time.monotonic() + 0.3
    with server_class(still_coin(empty_s=0.3), 200.0, quality=quality) as server:
        camera, check, jumps = Camera(server.url), DamageCheck(), JumpFilter(8)
        detector = AbsoluteDifferenceDetector(camera.read())
        while time.monotonic() < empty_until + 0.5:
            check.reason(camera.read())
        server.set_damage(damage, 0.3)
        for _ in range(count):
            try:
                frame = camera.read()
            except FrameSourceError:
                counts['failed'] += 1
                continue
            counts['True'] += 1
            begin = time.perf_counter()
            reason = check.reason(frame)
            spent += time.perf_counter() - begin
            detections = detector.detect(frame)
            if reason is not None:
                counts[reason] += 1
            elif detections:
                wrong = np.abs(TRUE - detections[0].centre).max() > 4
                counts['wrong'] += wrong
                accepted = jumps.accepts(detections[0].centre)
                counts['wrong, published'] += wrong and accepted
        camera.release()
    return counts, server.damaged_count, spent / max(1, counts['True'])


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--frames', type=int, default=150)
    parser.add_argument('--qualities', type=int, nargs='+', default=[90, 60])
    arguments = parser.parse_args()
    print(f'OpenCV {cv2.__version__}, {arguments.frames} reads a row')
    for server_class in (MjpegServer, RtspServer):
        for quality in arguments.qualities:
            print(f'\n{server_class.__name__}, JPEG quality {quality}')
            for name, damage in [('none', None), *DAMAGES.items()]:
                counts, damaged, cost = measure(server_class, quality, damage, arguments.frames)
                print(f'{name:14} {damaged:3} damaged, {cost * 1e3:.2f} ms: ' + ', '.join(
                    f'{count} {what}' for what, count in sorted(counts.items()) if count))


if __name__ == '__main__':
    main()
