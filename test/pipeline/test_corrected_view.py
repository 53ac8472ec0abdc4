# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the pipeline publishes after its camera was nudged."""

from camera_to_base.detection import DetectorSettings
from camera_to_base.errors import InvalidValueError, Level
from camera_to_base.parameters import default_values
from camera_to_base.pipeline import LIMIT_SPECS, make_limits, SurfaceInForce
from camera_to_base.settings import CAMERA_SPECS
from camera_to_base.sources import VIDEO_FILE
from camera_to_base.uncertainty import position_uncertainty, triangle_of
from nudged_table import CM_PER_PX, grid, nudge, NudgedTable, plain
import numpy as np
import pytest
from watched_table import calibrated, COIN, LIMITS, MATRIX, point_errors_mm, Watched


@pytest.fixture
def watched():
    return Watched()


@pytest.mark.parametrize('scene', [{}, {'arm': True}, {'light': 0.7}], ids=['', 'arm', 'light'])
def test_coin_is_published_where_it_is_after_a_nudge(watched, scene):
    coin = 380, 120
    assert watched.see(MATRIX, [coin], **scene).reason.kind == 'view_moved'
    sighting = watched.see(MATRIX, [coin], 3, **scene)
    assert max(point_errors_mm(sighting, coin)) < 0.3
    assert watched.pipeline.view.shift_px < 0.5


@pytest.mark.slow
def test_movement_that_may_be_corrected_is_a_warning_for_two_seconds_and_then_an_error(watched):
    reason = watched.see(nudge(6, 2), [COIN]).reason
    assert reason.kind == 'view_moved' and reason.level is Level.WARN
    assert 'calibrate anew' not in reason.sentence and '6.3 px' in reason.sentence
    covered = Watched(NudgedTable(grid))
    reasons = [covered.see(nudge(6, 2), [COIN]).reason for _ in range(25)]
    levels = [reason.level for reason in reasons if reason.kind == 'view_moved']
    assert levels[0] is Level.WARN and levels[-1] is Level.ERROR
    assert 'calibrate anew' in reasons[-1].sentence


def test_movement_that_is_too_large_to_be_corrected_is_an_error_at_once(watched):
    reason = watched.see(nudge(20, 20), [COIN]).reason
    assert reason.kind == 'view_moved' and reason.level is Level.ERROR


def test_correction_is_a_warning_with_its_size(watched):
    assert watched.pipeline.doubt is None
    watched.see(nudge(6, 8), [COIN], 3)
    doubt, correction = watched.pipeline.doubt, watched.pipeline.standpoint.correction
    assert doubt.kind == 'view_corrected' and doubt.level is Level.WARN
    assert correction.shift_px == pytest.approx(10, abs=0.3)
    assert correction.shift_mm == pytest.approx(5, abs=0.2)
    assert 0 < correction.error_mm < 1
    assert f'{correction.shift_px:.1f} px ({correction.shift_mm:.1f} mm)' in doubt.sentence


def test_camera_that_is_put_back_is_not_corrected_any_more(watched):
    watched.see(MATRIX, [COIN], 3)
    assert watched.pipeline.doubt is not None
    sighting = watched.see(None, [COIN], 4)
    assert max(point_errors_mm(sighting, COIN)) < 0.3
    assert watched.pipeline.doubt is None and watched.pipeline.standpoint.correction is None


@pytest.mark.slow
def test_slow_drift_below_the_limit_is_corrected(watched):
    for number in range(30):
        watched.see(nudge(0.08 * number, 0, 0.05 * number), [COIN])
        assert watched.sighting.reason is None or number == 0
    sighting = watched.see(nudge(2.4, 0, 1.5), [COIN], 12)
    assert max(point_errors_mm(sighting, COIN)) < 0.45  # what drifts by less than 0.8 px is left
    assert watched.pipeline.standpoint.correction.shift_px > 1.5


@pytest.mark.parametrize('tilt', [(2.4, 0), (0, -2.4), (-2, 2)])
def test_tilt_below_the_limit_is_mended_in_the_first_frame_and_corrected(watched, tilt):
    corner = 440, 320
    watched.see(None, [corner], 3)
    for _ in range(10):
        sighting = watched.see(nudge(tilt=tilt), [corner])
        assert max(point_errors_mm(sighting, corner)) < 0.25  # without: up to 1 mm
    assert watched.pipeline.standpoint.correction is not None


def test_tilt_of_a_corner_by_more_than_the_limit_is_held_back(watched):
    watched.see(None, [COIN], 3)
    matrix = nudge(tilt=(4.5, 3))
    assert watched.see(matrix, [COIN]).reason.kind == 'view_moved'
    assert max(point_errors_mm(watched.see(matrix, [COIN], 4), COIN)) < 0.2


def test_one_nudge_after_another_is_measured_from_the_background(watched):
    for share in (0.4, 0.8, 0.1, 0.6):
        matrix = nudge(10 * share, -9 * share, 6 * share)
        sighting = watched.see(matrix, [COIN], 4)
        assert max(point_errors_mm(sighting, COIN)) < 0.3


@pytest.mark.parametrize('limits, matrix, why', [
    (LIMITS, nudge(20, 20), 'view.correct_up_to_px is 20'),
    (LIMITS._replace(correct_up_to_px=5.0), nudge(6, 2), 'view.correct_up_to_px is 5'),
    (LIMITS._replace(correct_error_mm=0.01), nudge(6, 2), 'view.correct_error_mm is 0.01')])
def test_what_is_not_corrected_stays_silent_and_says_why(limits, matrix, why):
    watched = Watched(limits=limits)
    reason = watched.see(matrix, [COIN], 20).reason
    assert reason.kind == 'view_moved' and why in reason.sentence
    assert watched.pipeline.standpoint.correction is None


def test_zero_px_never_corrects():
    watched = Watched(limits=LIMITS._replace(correct_up_to_px=0.0))
    reason = watched.see(nudge(6, 2), [COIN], 20).reason
    assert reason.kind == 'view_moved' and 'corrected' not in reason.sentence


@pytest.mark.slow
def test_camera_in_motion_gives_no_wrong_point(watched):
    watched.see(None, [COIN], 3)
    for number in range(24):
        share = np.sin(number / 3)
        sighting = watched.see(nudge(12 * share, 9 * share, 4 * share), [COIN])
        if sighting.reason is None:
            assert all(error < 1.5 for error in point_errors_mm(sighting, *(
                [COIN] * len(sighting.objects))))


def test_correction_makes_positions_less_certain(watched):
    values = {**default_values(CAMERA_SPECS),
              'surface.covariance': triangle_of(1e-12 * np.eye(14)),
              'uncertainty.centre_floor_px': 0.0, 'uncertainty.height_tolerance_cm': 0.0}
    uncertainty = position_uncertainty(values, calibrated())

    def deviation_mm(matrix, coin):
        sighting = watched.see(matrix, [coin], 4)
        found, = sighting.objects
        frame = watched.table.shoot(matrix, [coin])
        of_frame = watched.pipeline.frame_uncertainty(frame, uncertainty)
        return 10 * np.sqrt(of_frame.of(found).xx)

    corner = 60, 60
    before, after = deviation_mm(None, corner), deviation_mm(MATRIX, corner)
    assert before < after < 1


def test_object_that_touches_what_the_background_does_not_show_is_left_out(watched):
    # 20 px to the right: the left edge of the picture is new.
    outside, inside = (9, 200), (300, 100)
    sighting = watched.see(nudge(18, 0), [outside, inside], 4)
    assert len(sighting.objects) == 1
    assert [left.reason.kind for left in sighting.left_out] == ['outside_background']


def test_new_background_keeps_the_correction(watched):
    watched.see(MATRIX, [COIN], 3)
    watched.pipeline.capture_background(1)
    watched.see(MATRIX, count=3)
    assert watched.pipeline.doubt.kind == 'view_corrected'
    assert max(point_errors_mm(watched.see(MATRIX, [COIN], 3), COIN)) < 0.3
    further = nudge(3, 4) @ MATRIX
    assert max(point_errors_mm(watched.see(further, [COIN], 4), COIN)) < 0.4


def test_background_is_kept_as_the_calibrated_camera_sees_it(watched):
    taken = watched.pipeline.standpoint.background_as_calibrated.picture
    assert taken is watched.pipeline.background
    watched.see(MATRIX, [COIN], 3)
    assert watched.pipeline.standpoint.background_as_calibrated.picture is taken
    watched.pipeline.capture_background(1)
    watched.see(MATRIX, count=3)
    again = Watched(watched.table, begin=False)
    kept = watched.pipeline.standpoint.background_as_calibrated
    again.pipeline.restore_background(kept.picture, 5.0)
    assert max(point_errors_mm(again.see(MATRIX, [COIN], 6), COIN)) < 0.4
    assert again.pipeline.doubt.kind == 'view_corrected'


def test_background_that_is_older_than_the_calibration_corrects_nothing():
    watched = Watched(begin=False)
    watched.pipeline.restore_background(watched.table.shoot(), 5.0, may_correct=False)
    assert watched.see(nudge(6, 2), [COIN], 12).reason.kind == 'view_moved'
    watched.pipeline.capture_background(1)
    watched.see(nudge(6, 2), count=3)
    sighting = watched.see(nudge(6, 2), [COIN], 3)
    assert sighting.reason is None and watched.pipeline.doubt is None


def test_another_calibration_ends_the_correction_until_a_background_is_taken(watched):
    watched.see(MATRIX, [COIN], 3)
    other = calibrated(**{'surface.homography.surface_from_pixel':
                          [0.06, 0.0, 0.0, 0.0, 0.06, 0.0, 0.0, 0.0, 1.0]})
    watched.pipeline.configure(other, DetectorSettings(), LIMITS)
    assert watched.see(MATRIX, [COIN], 12).reason.kind == 'view_moved'
    watched.pipeline.capture_background(1)
    watched.see(MATRIX, count=3)
    found, = watched.see(MATRIX, [COIN], 3).objects
    assert found.point == pytest.approx(
        0.06 * (MATRIX @ [*COIN, 1])[:2] / (MATRIX @ [*COIN, 1])[2], abs=0.02)


def test_other_height_of_the_objects_keeps_the_correction(watched):
    watched.see(MATRIX, [COIN], 3)
    raised = calibrated(**{'surface.camera_height_cm': 60.0,
                           'surface.camera_foot_cm': list(CM_PER_PX * np.array(COIN))})
    watched.pipeline.configure(raised, DetectorSettings(heights_cm=(6.0,)), LIMITS)
    found, = watched.see(MATRIX, [COIN], 2).objects
    assert found.solid.height_cm == 6.0
    assert found.point == pytest.approx(CM_PER_PX * np.array(COIN), abs=0.03)
    assert watched.pipeline.doubt.kind == 'view_corrected'


def test_correction_can_be_switched_off_while_it_is_in_force(watched):
    watched.see(MATRIX, [COIN], 3)
    watched.pipeline.configure(
        calibrated(), DetectorSettings(), LIMITS._replace(correct_up_to_px=0.0))
    assert watched.see(MATRIX, [COIN], 3).reason.kind == 'view_moved'
    assert watched.pipeline.doubt is None


def test_calibration_for_another_picture_size_ends_a_correction_with_a_reason(watched):
    watched.see(MATRIX, [COIN], 3)
    assert watched.pipeline.standpoint.correction is not None
    other = calibrated(**{'surface.image_size': [640, 480]})
    watched.pipeline.configure(other, DetectorSettings(), LIMITS)
    reason = watched.see(MATRIX, [COIN], 3).reason
    assert reason.kind == 'frame_size' and '640 x 480 px' in reason.sentence
    assert watched.pipeline.doubt is None
    watched.pipeline.configure(calibrated(), DetectorSettings(), LIMITS)
    assert max(point_errors_mm(watched.see(None, [COIN], 4), COIN)) < 0.3


def test_another_surface_waits_for_its_background(watched):
    reason = watched.see(nudge(40, 0), count=3).reason._replace(kind='by_hand')
    surface = calibrated(**{'surface.homography.surface_from_pixel':
                            [CM_PER_PX, 0.0, -2.0, 0.0, CM_PER_PX, 0.0, 0.0, 0.0, 1.0]})
    watched.pipeline.standpoint = watched.pipeline.standpoint.with_surface(
        SurfaceInForce(surface, reason=reason))
    assert watched.see(nudge(40, 0), [COIN], 12).reason.kind in ('view_moved', 'view_unknown')
    watched.pipeline.capture_background(1)
    watched.see(nudge(40, 0), count=3)
    assert max(point_errors_mm(watched.see(nudge(40, 0), [COIN], 3), COIN)) < 0.3
    assert watched.pipeline.doubt.kind == 'by_hand'
    both = nudge(5, 5) @ nudge(40, 0)
    assert max(point_errors_mm(watched.see(both, [COIN], 4), COIN)) < 0.3
    assert watched.pipeline.doubt.kind == 'view_corrected'


def test_surface_of_one_colour_is_not_corrected():
    watched = Watched(NudgedTable(plain))
    assert watched.see(nudge(6, 2), [COIN], 12).reason is None
    assert watched.pipeline.standpoint.correction is None


def test_recording_is_corrected_as_a_camera_is():
    watched = Watched(kind=VIDEO_FILE)
    assert watched.see(nudge(6, 2), [COIN], 12).reason is None
    assert watched.pipeline.doubt.kind == 'view_corrected'


FIXED = '0 0, 110 0, 110 90, 0 90'


def pushed(watched, matrix):
    """Let it see the table pushed below a camera and a robot's foot that stand still."""
    still = watched.table.shoot()
    for _ in range(6):
        watched._now += 0.1
        frame = watched.table.shoot(matrix)
        frame[:90, :110] = still[:90, :110]
        watched.sighting = watched.pipeline.process(frame, watched._now)
    return watched.sighting


def test_pushed_table_is_not_corrected_where_a_part_of_the_robot_is_in_view():
    watched = Watched(limits=LIMITS._replace(fixed_areas=FIXED))
    reason = pushed(watched, nudge(6, 2)).reason
    assert reason.kind == 'view_moved' and 'the table was pushed' in reason.sentence
    watched = Watched(limits=LIMITS._replace(fixed_areas=FIXED))
    assert watched.see(nudge(6, 2), [COIN], 6).reason is None
    assert watched.pipeline.doubt.kind == 'view_corrected'


def test_both_cases_are_named_where_the_picture_cannot_tell():
    watched = Watched()
    pushed(watched, nudge(6, 2))
    assert 'If the table was pushed instead' in watched.pipeline.doubt.sentence


def test_fixed_areas_that_are_none_are_refused():
    with pytest.raises(InvalidValueError, match="view.fixed_areas must be polygons.*'0 0, 3'"):
        make_limits({**default_values(LIMIT_SPECS), 'view.fixed_areas': '0 0, 3'})
