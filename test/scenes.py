# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the cameras of the tests see: each scene gives a new frame for each call."""

import time

from camera_to_base.simulation.board import SimulatedBoard
import cv2
import numpy as np

SIZE = (640, 480)
CLOCK_ROUND_S = 4.0
_CLOCK_LEFT, _CLOCK_RIGHT, _CLOCK_ROW = 60, 580, 240


def coin(rate=20.0):
    """Make the simulated board: the coin moves, the first frame shows it without."""
    return SimulatedBoard(frame_rate=rate).read


class StillCoin:
    """
    A table with a disc at (400, 300) px.

    :param has_disc: False for an empty table, whose picture makes a background; can be changed at
        any time.
    """

    def __init__(self, has_disc=False, noise=2.0, texture=40):
        self.has_disc = has_disc
        self._draw = _noisy_table(noise, texture)

    def __call__(self):
        return self._draw(self._centre() if self.has_disc else None)

    def _centre(self):
        return 400, 300


def still_coin(rate=20.0, empty_s=2.0, noise=2.0, texture=40):
    """Make a :class:`StillCoin` whose disc is not there at first."""
    scene, begin = StillCoin(noise=noise, texture=texture), time.monotonic()

    def take_frame():
        scene.has_disc = time.monotonic() - begin > empty_s
        return scene()

    return take_frame


class Clock(StillCoin):
    """A table with a disc whose place tells the wall clock, see `clock_age`."""

    def _centre(self):
        share = time.time() % CLOCK_ROUND_S / CLOCK_ROUND_S
        return _CLOCK_LEFT + (_CLOCK_RIGHT - _CLOCK_LEFT) * share, _CLOCK_ROW


def clock_age(u, seen_at):
    """Tell how old the frame is on which the clock's disc was seen at u px, in s."""
    share = (u - _CLOCK_LEFT) / (_CLOCK_RIGHT - _CLOCK_LEFT)
    age = (seen_at - share * CLOCK_ROUND_S) % CLOCK_ROUND_S
    return age if age < CLOCK_ROUND_S - 0.3 else age - CLOCK_ROUND_S


def _noisy_table(noise, texture):
    # Ready-made noise, taken from another place for each frame, costs a tenth of fresh noise.
    random = np.random.default_rng(1)
    width, height = SIZE
    table = random.normal(0, texture, (height, width)).astype(np.float32)
    table = cv2.GaussianBlur(table, (0, 0), 4)
    table = np.clip(190 + table, 120, 250).astype(np.int16)[:, :, None]
    grain = random.normal(0, noise, (height + 64, width + 64, 3)).round().astype(np.int16)

    def draw(centre):
        top, left = random.integers(0, 64, 2)
        frame = table + grain[top:top + height, left:left + width]
        frame = np.clip(frame, 0, 255).astype(np.uint8)
        if centre is not None:
            at = tuple(round(16 * value) for value in centre)
            cv2.circle(frame, at, 22 * 16, (40, 40, 40), -1, cv2.LINE_AA, 4)
        return frame

    return draw


SCENES = {'coin': coin, 'still_coin': still_coin, 'clock': lambda rate: Clock()}
