# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Prints where objects lie, seen by a webcam or on a video, without ROS.

    python3 webcam_without_ros.py cell.yaml
    python3 webcam_without_ros.py cell.yaml last_night.mp4

cell.yaml is the file that `calibrate` and the dashboard write. A webcam is named by its number,
0 if it is left out. The first frame of a video must show the empty surface.
"""

import argparse
import sys
import time
from typing import Iterator, List, Optional, Tuple

from camera_to_base import Cell, Seen
from camera_to_base.errors import CameraToBaseError
import cv2
import numpy as np

# A webcam's first pictures are dark, until it has set its exposure.
_SETTLING_FRAMES, _BACKGROUND_FRAMES = 20, 5


def frames_of(capture: cv2.VideoCapture) -> Iterator[Tuple[np.ndarray, float]]:
    """Read frames until the last one, each with the time at which it came."""
    while True:
        is_read, frame = capture.read()
        if not is_read:
            return
        yield frame, time.monotonic()


def text_of(seen: Seen) -> str:
    """Say in one line what a frame shows."""
    if seen.reason is not None:
        return f'nothing, {seen.reason.sentence}'
    if not seen.objects:
        return 'no object'
    return '; '.join(
        'beyond reach' if one.base_xy_cm is None else
        'x {:.2f}, y {:.2f} cm, 95 % within {:.2f} cm'.format(
            *one.base_xy_cm, 2.45 * np.sqrt(np.linalg.eigvalsh(one.base_covariance_cm2)[-1]))
        for one in seen.objects)


def main(args: Optional[List[str]] = None) -> None:
    """Run until the video ends, or until Ctrl-C."""
    parser = argparse.ArgumentParser(description='Prints where objects lie, without ROS.')
    parser.add_argument('file', help='the file that calibrate writes')
    parser.add_argument('source', nargs='?', default='0', help="a webcam's number, or a video")
    options = parser.parse_args(args)
    is_webcam = options.source.isdecimal()
    capture = cv2.VideoCapture(int(options.source) if is_webcam else options.source)
    if not capture.isOpened():
        sys.exit(f"cannot open '{options.source}'")
    try:
        cell = Cell.open(options.file, live=is_webcam, source=options.source)
        if is_webcam:
            input('Clear the surface, take your hands away, and press Enter: ')
        frames = frames_of(capture)
        passed_over, taken = (_SETTLING_FRAMES, _BACKGROUND_FRAMES) if is_webcam else (0, 1)
        background = [next(frames)[0] for _ in range(passed_over + taken)][passed_over:]
        cell.take_background(*background)
        before = None
        for frame, taken_at in frames:
            text = text_of(cell.locate(frame, taken_at))
            if text != before:
                print(text, flush=True)
            before = text
    except StopIteration:
        sys.exit(f"'{options.source}' gives too few frames for a background")
    except CameraToBaseError as error:
        sys.exit(str(error))
    finally:
        capture.release()


if __name__ == '__main__':
    try:
        main()
    except KeyboardInterrupt:
        pass
