# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the pipeline does while something covers most of the view."""

import itertools

from camera_to_base.detection import DetectorSettings
from camera_to_base.pipeline import ViewCheck
from camera_to_base.pipeline.view import view_stage
from camera_to_base.pipeline.view.view_stage import Pace
from nudged_table import nudge
import numpy as np
import pytest
from watched_table import calibrated, COIN, LIMITS, point_errors_mm, Watched

STEP_S = 1 / 30


class Covered(Watched):
    """A pipeline that sees 30 frames a second of a table with a coin and, at times, a cover."""

    def __init__(self):
        super().__init__()
        self.see(None, [COIN], 3)

    def play(self, seconds, cover=None, matrix=None):
        """Return what is told of each frame."""
        return [self._shown(cover, matrix) for _ in range(round(seconds / STEP_S))]

    def _shown(self, cover, matrix):
        frame = self.table.shoot(matrix, [COIN])
        if cover is not None:
            cover(frame)
        self._now += STEP_S
        return self.pipeline.process(frame, self._now)


def board(frame):
    squares = np.kron(np.indices((7, 9)).sum(0) % 2, np.ones((48, 50)))
    frame[12:348, 15:465] = (40 + 180 * squares[:, :, None]).astype(np.uint8)


def sheet(frame):
    frame[5:-5, 5:-5] = 235


def third_of_a_sheet(frame):
    frame[:, :200] = 235


def lights_out(frame):
    frame[:] = frame // 60


COVERS = [board, sheet, lights_out]


@pytest.fixture
def watched(monkeypatch):
    # A comparison takes 50 ms, however busy the machine is.
    monkeypatch.setattr(view_stage, 'Pace', lambda: Pace(itertools.count(step=0.05).__next__))
    return Covered()


@pytest.fixture
def compared(monkeypatch):
    """Collect the frames that are compared in full."""
    frames, compare = [], ViewCheck.compare
    monkeypatch.setattr(ViewCheck, 'compare', lambda check, frame: (
        frames.append(frame), compare(check, frame))[1])
    return frames


@pytest.mark.slow
@pytest.mark.parametrize('cover', COVERS)
def test_covered_view_is_held_back_with_its_reason_and_rarely_compared(watched, compared, cover):
    seen = watched.play(4.0, cover)
    assert {one.reason.kind for one in seen} <= {'view_changed', 'view_unknown'}
    assert len(compared) < len(seen) / 2
    assert watched.pipeline.reason.kind == seen[-1].reason.kind
    assert watched.pipeline.view.changed_share > 0.7
    assert not any(one.objects for one in seen)


@pytest.mark.parametrize('cover', COVERS)
def test_positions_come_back_with_the_second_frame_after_the_cover_is_gone(watched, cover):
    for seconds in (0.1, 0.5, 1.2):
        watched.play(seconds, cover)
        watched.play(STEP_S)
        sighting, = watched.play(STEP_S)
        assert max(point_errors_mm(sighting, COIN)) < 0.3
        assert watched.pipeline.reason is None


@pytest.mark.slow
def test_view_that_is_free_in_part_comes_back_within_half_a_second(watched):
    watched.play(2.0, board)
    seen = watched.play(0.6, third_of_a_sheet)
    assert any(one.reason is None for one in seen)


@pytest.mark.slow
def test_camera_that_was_bumped_below_a_cover_is_noticed_and_gives_no_point(watched):
    watched.play(1.0, sheet)
    seen = watched.play(1.0, matrix=nudge(25, 14))
    assert all(one.reason is not None for one in seen)
    assert seen[-1].reason.kind == 'view_moved'
    assert 'view.correct_up_to_px is 20' in seen[-1].reason.sentence


@pytest.mark.slow
def test_small_nudge_below_a_cover_is_corrected_within_a_second(watched):
    watched.play(1.0, sheet)
    seen = watched.play(1.0, matrix=nudge(7, -5, 3))
    published = [one for one in seen if one.reason is None]
    assert published and seen[-1] is published[-1]
    for one in published:
        assert max(point_errors_mm(one, COIN)) < 0.3


@pytest.mark.slow
def test_nudged_camera_is_corrected_again_after_a_cover(watched, compared):
    matrix = nudge(7, -5, 3)
    watched.play(0.3, matrix=matrix)
    assert watched.pipeline.doubt.kind == 'view_corrected'
    compared.clear()
    seen = watched.play(3.0, board, matrix)
    # A comparison each with where the camera stands, and with where it stood.
    assert all(one.reason is not None for one in seen) and len(compared) < len(seen)
    sighting = watched.play(0.1, matrix=matrix)[-1]
    assert max(point_errors_mm(sighting, COIN)) < 0.3
    watched.play(1.0, board)
    assert max(point_errors_mm(watched.play(0.1)[-1], COIN)) < 0.3
    assert watched.pipeline.doubt is None


def test_other_limits_count_from_the_next_frame_on(watched):
    strict = LIMITS._replace(max_changed_share=0.2)
    watched.pipeline.configure(calibrated(), DetectorSettings(), strict)
    seen = watched.play(0.5, third_of_a_sheet)
    assert {one.reason.kind for one in seen} == {'view_changed'}
    watched.pipeline.configure(calibrated(), DetectorSettings(), LIMITS)
    first, second = watched.play(2 * STEP_S, third_of_a_sheet)
    assert first.reason is None or first.reason.kind == 'unconfirmed'
    assert second.reason is None
