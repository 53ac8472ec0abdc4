# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""From frame to frame: what rests keeps its height, and what contradicts is not published."""

from camera_to_base.errors import InvalidValueError
from camera_to_base.fusion import (
    CameraFrame, ClockCheck, FusedCell, fusion_settings, FUSION_SPECS, FusionLimits, KnownHeight)
from camera_to_base.parameters import default_values
import numpy as np
import pytest
from two_cameras import base_of, PAIRS, seen

CAMERAS = PAIRS['tilted 30 degrees, opposite sides']
# Opposite cameras look along y.
ALONG = (0.0, 0.5)
LOW, HIGH = (base_of('box', 4.0, 3.0, (-6.0, 2.0), 0.3), 2.0), (
    base_of('disc', 3.0, 3.0, (7.0, -1.0), 0.0), 5.0)


class Table:
    """A table that two cameras see, frame by frame."""

    def __init__(self, **limits):
        self.cell = FusedCell(['left', 'right'], FusionLimits(**limits))
        self.time = 100.0
        self.random = np.random.default_rng(3)

    def see(self, left, right=None, late_s=0.0, moved=(0.0, 0.0), frames=1, **options):
        """Show objects to both cameras, or what each sees; None for a camera that is lost."""
        views = [left, left if right is None else right]
        for _ in range(frames):
            self.time += 0.1
            sighting = self.cell.fuse([
                None if view == 'lost' else CameraFrame.of(
                    self.time - late_s * number,
                    [seen(base, height, camera, self.random, noise_px=0.2,
                          moved=np.multiply(moved, number)) for base, height in view])
                for number, (camera, view) in enumerate(zip(CAMERAS, views))],
                self.time, **options)
        return sighting


def check_true(sighting, *objects, within_cm=0.1):
    assert len(sighting.objects) == len(objects)
    for base, height in objects:
        nearest = min(sighting.objects, key=lambda one: np.hypot(
            *(one.solution.moments.centre - base.mean(axis=0))))
        np.testing.assert_allclose(
            nearest.solution.moments.centre, base.mean(axis=0), atol=within_cm)
        assert nearest.solution.height.height_cm == pytest.approx(height, abs=0.2)


def test_objects_are_published_at_once_the_largest_first():
    sighting = Table().see([HIGH, LOW])
    check_true(sighting, LOW, HIGH)
    assert sighting.reason is None and sighting.left_out == []
    assert [one.cameras for one in sighting.objects] == [(0, 1), (0, 1)]
    assert sighting.objects[0].solution.height.height_cm < 3


@pytest.mark.parametrize('right', [[LOW], [], 'lost'])
def test_what_one_camera_loses_keeps_the_height_that_was_measured(right):
    table = Table()
    table.see([LOW, HIGH], frames=3)
    sighting = table.see([LOW, HIGH], right, frames=30)
    check_true(sighting, LOW, HIGH)
    assert sighting.reason.kind == 'one_camera'
    assert [one.cameras for one in sighting.objects if 4 < one.solution.height.height_cm] == [(0,)]


def test_what_one_camera_alone_has_ever_seen_is_left_out():
    sighting = Table().see([LOW, HIGH], [LOW], frames=5)
    check_true(sighting, LOW)
    assert sighting.reason.kind == 'one_camera'
    assert 'only left sees it' in sighting.left_out[0].reason.sentence


def test_with_a_height_it_is_published_with_its_doubt():
    sighting = Table(one_camera=KnownHeight(4.5, 0.5)).see([LOW, HIGH], [LOW])
    high, = (one.solution for one in sighting.objects if one.cameras == (0,))
    off = high.moments.centre - HIGH[0].mean(axis=0)
    assert off @ np.linalg.solve(high.covariance, off) < 9
    assert np.linalg.eigvalsh(high.covariance)[-1] > 0.02
    assert sighting.reason.kind == 'one_camera' and sighting.left_out == []


@pytest.mark.parametrize('moved', [ALONG, (0.5, 0.0), (0.3, -0.4)])
def test_camera_that_is_bumped_is_named_and_moves_nothing(moved):
    table = Table()
    table.see([LOW, HIGH], frames=3)
    for _ in range(20):
        sighting = table.see([LOW, HIGH], moved=moved)
        check_true(sighting, LOW, HIGH)
        assert sighting.reason.kind == 'cameras_disagree'
        assert sighting.reason.sentence.startswith('right sees')
    assert {one.reason.kind for one in sighting.left_out} == {'cameras_disagree'}


def test_object_that_moves_is_followed_and_its_height_is_measured_again():
    table = Table()
    for step in range(6):
        there = HIGH[0] + [-step, step / 2]
        check_true(table.see([LOW, (there, 5.0)]), LOW, (there, 5.0))


def test_another_object_in_the_same_place_has_its_own_height():
    table = Table()
    table.see([LOW], frames=3)
    check_true(table.see([(LOW[0], 4.0)]), (LOW[0], 4.0))


def test_object_that_moves_between_the_pictures_is_left_out_and_what_rests_is_not():
    table = Table()
    table.see([LOW, HIGH], late_s=0.05, frames=4)
    moving = [(HIGH[0] + [0.3, 0.0], 5.0), (HIGH[0] + [0.25, 0.0], 5.0)]
    sighting = table.see([LOW, moving[0]], [LOW, moving[1]], late_s=0.05)
    check_true(sighting, LOW)
    assert [one.reason.kind for one in sighting.left_out] == ['too_old']
    assert '50 ms apart' in sighting.left_out[0].reason.sentence
    check_true(table.see([LOW, moving[0]], late_s=0.05, frames=3), LOW, moving[0])


def test_with_clocks_that_differ_only_what_rests_is_fused():
    table = Table()
    table.see([LOW, HIGH], frames=8)
    moving = HIGH[0] + [0.3, 0.0], 5.0
    sighting = table.see([LOW, moving], untrusted=True)
    check_true(sighting, LOW)
    assert 'clocks' in sighting.left_out[0].reason.sentence
    check_true(table.see([LOW, moving], untrusted=True, frames=10), LOW, moving)


def test_what_nobody_sees_any_more_is_forgotten():
    table = Table()
    table.see([LOW, HIGH], frames=3)
    assert table.see([LOW], frames=1).objects[1:] == []
    table.see([LOW], frames=15)
    check_true(table.see([LOW, HIGH], [LOW]), LOW)


def test_a_camera_at_another_place_starts_anew():
    table = Table()
    table.see([LOW], frames=3)
    table.cell.forget()
    sighting = table.see([LOW], [])
    assert sighting.objects == [] and sighting.reason.kind == 'one_camera'


def test_nothing_is_nothing_and_no_camera_is_no_error():
    table = Table()
    assert table.see([]) == ([], [], None)
    assert table.see('lost') == ([], [], None)


def test_clock_that_is_off_is_noticed_and_a_slow_message_is_not():
    random, check = np.random.default_rng(0), ClockCheck()
    for _ in range(40):
        for camera, ahead in (('left', 0.0), ('right', 0.05)):
            way = 0.001 + random.exponential(0.005)
            check.note(camera, 5.0 + ahead, 5.0 + way)
    found = check.error(0.02)
    assert found.camera == 'right' and found.ahead_s == pytest.approx(0.049, abs=0.003)
    assert check.error(0.06) is None
    assert ClockCheck().error(0.02) is None


@pytest.mark.parametrize('cameras', [['left', 'left'], ['left', 'left/'], ['', 'right']])
def test_cameras_have_names_of_their_own(cameras):
    with pytest.raises(InvalidValueError, match='cameras must name the namespace'):
        fusion_settings({**default_values(FUSION_SPECS), 'cameras': cameras})


def test_empty_height_of_one_camera_is_none():
    values = default_values(FUSION_SPECS)
    assert fusion_settings(values).limits.one_camera is None
    assert fusion_settings({**values, 'one_camera_height_cm': [3.0]}).limits.one_camera == (
        KnownHeight(3.0, 0.1))
