# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A camera that moves while the background is taken."""

import time

from camera_to_base.pipeline import CameraPipeline, Limits
from camera_to_base.sources import DEVICE
from camera_to_base.surface.models import ParallelSurface
from nudged_table import nudge, NudgedTable, WIDTH
import numpy as np
import pytest

FRAMES_PER_S = 15


class Taking:
    """A camera whose pipeline takes the background."""

    def __init__(self, background_frames=1):
        # In the future, so that no frame is too old.
        self.table, self.now = NudgedTable(), time.monotonic() + 3600
        self.pipeline = CameraPipeline(
            ParallelSurface(24.0, WIDTH), limits=Limits(), kind=DEVICE,
            background_frames=background_frames)

    def see(self, *moves):
        """See a frame after each move by some px along u; return the last reason's kind."""
        for du in moves:
            self.now += 1 / FRAMES_PER_S
            frame = self.table.shoot(nudge(du) if du else None)
            reason = self.pipeline.process(frame, self.now).reason
        return None if reason is None else reason.kind


def test_background_of_a_camera_at_rest_takes_two_frames():
    taking = Taking()
    assert taking.see(0) == 'background_missing'
    assert taking.see(0) != 'background_missing' and taking.pipeline.background is not None


def test_bump_while_the_background_is_taken_leaves_the_view_checked():
    taking = Taking()
    assert taking.see(0, 6) == 'background_unsettled'
    assert 'stands still' in taking.pipeline.reason.sentence
    assert taking.see(*[6] * FRAMES_PER_S) is None
    assert taking.see(40) == 'view_moved'


@pytest.mark.slow
def test_camera_that_swings_gives_no_background_until_it_stands_still():
    taking = Taking()
    swing = [9 * 0.9 ** n * np.cos(2 * n) for n in range(30)]
    assert taking.see(*swing) == 'background_unsettled'
    assert taking.see(*[0] * FRAMES_PER_S) is None
    assert np.abs(taking.pipeline.background - taking.table.shoot().astype(float)).mean() < 3


def test_median_of_frames_of_a_camera_that_moves_is_taken_again():
    taking = Taking(background_frames=9)
    assert taking.see(*range(10)) == 'background_unsettled'
    assert taking.see(*[9] * 2 * FRAMES_PER_S) is None


@pytest.mark.slow
def test_surface_that_does_not_come_to_rest_gives_a_background_after_three_seconds():
    taking = Taking()
    assert taking.see(*[0, 5] * FRAMES_PER_S) == 'background_unsettled'
    taking.see(*[0, 5] * FRAMES_PER_S)
    assert taking.pipeline.background is not None
