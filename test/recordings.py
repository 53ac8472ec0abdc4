# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Recordings that the tests make: a dark disc that moves over a light table."""

import cv2
import numpy as np

SIZE = (320, 240)
RADIUS = 25


def disc_frame(position, size=SIZE):
    """Draw the table, with a disc at a pixel or at several; None draws the table alone."""
    frame = np.full((size[1], size[0], 3), 200, np.uint8)
    for centre in [position] if isinstance(position, tuple) else position or []:
        cv2.circle(frame, centre, RADIUS, (40, 40, 40), -1)
    return frame


def write_video(path, positions, size=SIZE, fps=30.0):
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*'MJPG'), fps, size)
    for position in positions:
        writer.write(disc_frame(position, size))
    writer.release()
    return str(path)
