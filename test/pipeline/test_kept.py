# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A correction that is kept: its surface as that of the parameters."""

from camera_to_base.detection import DetectorSettings
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import default_values
from camera_to_base.pipeline import kept_values
from camera_to_base.settings import CAMERA_SPECS
from camera_to_base.surface import make_hull, make_surface
from camera_to_base.uncertainty import position_uncertainty, triangle_of
from nudged_table import CM_PER_PX, nudge, NudgedTable, plain, SIZE
import numpy as np
import pytest
from watched_table import COIN, LIMITS, MATRIX, point_errors_mm, Watched

VALUES = {
    **default_values(CAMERA_SPECS), 'surface.model': 'homography',
    'surface.image_size': list(SIZE),
    'surface.homography.surface_from_pixel':
        [CM_PER_PX, 0.0, 0.0, 0.0, CM_PER_PX, 0.0, 0.0, 0.0, 1.0],
    'surface.homography.distortion_centre': [(side - 1) / 2 for side in SIZE],
    'surface.covariance': triangle_of(1e-12 * np.eye(14)),
    'surface.hull': [40.0, 40.0, 420.0, 40.0, 420.0, 320.0, 40.0, 320.0]}


def offer(watched, **changed):
    """Give the parameters with which the surface in force is kept."""
    values = {**VALUES, **changed}
    surface = make_surface(values)
    return {**values, **kept_values(
        watched.pipeline.standpoint.surface, surface, position_uncertainty(values, surface),
        make_hull(values), SIZE)}


def use(watched, values):
    """Let it use parameters."""
    watched.pipeline.configure(make_surface(values), DetectorSettings(), LIMITS)


@pytest.fixture
def nudged():
    watched = Watched()
    watched.see(MATRIX, [COIN], 4)
    return watched


def test_kept_correction_goes_on_without_a_pause_and_without_a_warning(nudged):
    use(nudged, offer(nudged))
    for _ in range(3):
        assert max(point_errors_mm(nudged.see(MATRIX, [COIN]), COIN)) < 0.1
        assert nudged.pipeline.doubt is None and nudged.pipeline.standpoint.correction is None


def test_next_nudge_is_measured_from_where_the_correction_was_kept(nudged):
    use(nudged, offer(nudged))
    assert max(point_errors_mm(nudged.see(None, [COIN], 4), COIN)) < 0.2
    assert nudged.pipeline.standpoint.correction.shift_px == pytest.approx(11.4, abs=0.5)


def test_restarted_pipeline_with_the_kept_file_and_background_is_right(nudged):
    values = offer(nudged)
    use(nudged, values)
    kept = nudged.pipeline.standpoint.background_as_calibrated
    again = Watched(nudged.table, begin=False)
    use(again, values)
    again.pipeline.restore_background(kept.picture, 5.0, unknown=kept.unknown)
    assert max(point_errors_mm(again.see(MATRIX, [COIN], 3), COIN)) < 0.1
    assert again.pipeline.doubt is None


def test_what_the_kept_background_does_not_show_stays_unknown():
    watched, at_edge = Watched(), (470, 180)
    far = nudge(-14, 0)
    watched.see(far, [COIN], 4)
    for is_kept in (False, True):
        if is_kept:
            use(watched, offer(watched))
        sighting = watched.see(far, [COIN, at_edge], 3)
        assert len(sighting.objects) == 1
        assert [one.reason.kind for one in sighting.left_out] == ['outside_background']


def test_correction_after_a_new_background_can_be_kept(nudged):
    nudged.pipeline.capture_background(1)
    nudged.see(MATRIX, count=3)
    assert nudged.pipeline.standpoint.correction is None and nudged.pipeline.doubt is not None
    use(nudged, offer(nudged))
    assert max(point_errors_mm(nudged.see(MATRIX, [COIN], 2), COIN)) < 0.1
    assert nudged.pipeline.doubt is None


def test_other_surface_than_the_corrected_one_ends_the_correction(nudged):
    values = offer(nudged)
    values['surface.homography.surface_from_pixel'][2] += 0.1
    use(nudged, values)
    assert nudged.see(MATRIX, [COIN], 3).reason.kind == 'view_moved'


def test_area_of_the_calibration_moves_with_the_picture(nudged):
    before, after = make_hull(VALUES), make_hull(offer(nudged))
    moved = nudged.pipeline.standpoint.surface.frame_from_calibrated.pixels(before.corners)
    assert after.corners == pytest.approx(moved, abs=0.01)


def test_kept_surface_holds_for_raised_objects_and_for_a_parallel_camera():
    watched = Watched()
    raised = {'surface.model': 'parallel', 'surface.parallel.width_cm': SIZE[0] * CM_PER_PX,
              'surface.camera_height_cm': 60.0, 'object_height_cm': 3.0}
    use(watched, {**VALUES, **raised})
    watched.see(MATRIX, [COIN], 5)
    before = watched.pipeline.standpoint.surface.surface.locate([COIN])
    values = offer(watched, **raised)
    assert values['surface.model'] == 'homography'
    use(watched, values)
    assert watched.pipeline.doubt is None
    assert make_surface(values).locate([COIN]) == pytest.approx(before, abs=1e-4)


def test_kept_calibration_is_less_certain(nudged):
    def deviation(values):
        of = position_uncertainty(values, make_surface(values))
        return float(np.trace(of.warp_covariance))

    assert deviation(offer(nudged)) > deviation(VALUES)


def test_polynomial_cannot_be_kept():
    watched = Watched(NudgedTable(plain))
    polynomial = {'surface.model': 'polynomial'}
    use(watched, {**VALUES, **polynomial})
    watched.see(None, [COIN], 3)
    with pytest.raises(InvalidValueError, match="tutorial's polynomial cannot be kept"):
        offer(watched, **polynomial)
