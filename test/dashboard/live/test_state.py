# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What state a cell is in: decided from facts, without a browser and without ROS."""

import time

from camera_to_base.calibration import BASE, SURFACE
from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.cells import GraphCell
from camera_to_base.dashboard.live.positions import SeenFrame
from camera_to_base.dashboard.live.state import cell_state, Facts, Report
from camera_to_base.dashboard.live.status import HeldEllipses, objects_data
from camera_to_base.ros import UncertainPose
import numpy as np
import pytest

CELL = GraphCell('/', '/camera_publisher', '/robot_base_publisher')
ALL = (SURFACE, BASE)


def said(reason='ok', level='ok', sentence='all is well', age_s=0.1):
    return Report(level, reason, sentence, {}, time.monotonic() - age_s)


def state(**known):
    return cell_state(Facts(CELL, **{
        'camera': said(), 'transform': said(), 'parts': ALL, 'object_count': 2, **known}))


def nudged(age_s=0.1):
    return said('view_corrected', 'warn', 'the camera was nudged by 7.4 px', age_s)


def covered():
    return said('view_changed', 'error', '80 % of the view differs: call ~/capture_background')


def test_all_is_well_only_if_nothing_is_known_that_is_not():
    assert state() == ('ok', 'ok', '2 objects are published.', ())
    assert state(object_count=1).sentence == '1 object is published.'
    assert 'empty' in state(object_count=0).sentence
    left_out = state(object_count=0, has_left_out=True).sentence
    assert 'left out' in left_out and 'empty' not in left_out


@pytest.mark.parametrize('sees_board', [False, True])
def test_a_nudge_while_positions_are_published_is_never_called_normal(sees_board):
    one = state(camera=nudged(), sees_board=sees_board)
    assert (one.kind, one.level) == ('view_corrected', 'warn') and '7.4 px' in one.sentence
    moved = said('view_moved', 'error', 'the camera was nudged')
    assert state(camera=moved, silent_s=5.0, sees_board=sees_board).level == 'error'


def test_a_covered_view_is_normal_only_while_a_board_is_seen():
    one = state(camera=covered(), silent_s=5.0, sees_board=True)
    assert one.level == 'calm' and 'This is normal' in one.sentence
    one = state(camera=covered(), silent_s=5.0, sees_board=False)
    assert (one.kind, one.level) == ('view_changed', 'error') and 'normal' not in one.sentence


def test_after_the_surface_was_accepted_the_next_step_is_said_and_no_fault():
    one = state(camera=covered(), silent_s=5.0, has_new_surface=True)
    assert one.level == 'calm' and 'take the background' in one.sentence
    assert 'capture_background' not in one.sentence
    lost = said('camera_lost', 'error', 'the camera is gone')
    assert state(camera=lost, silent_s=5.0, has_new_surface=True).level == 'error'


def test_base_positions_of_a_base_frame_that_was_never_measured_are_told():
    one = state(parts=(SURFACE,))
    assert (one.kind, one.level) == ('base_not_calibrated', 'warn')
    assert one.data['way'] == 'robot'
    # A nudge is told beside it, not instead of it.
    assert nudged().sentence in state(parts=(SURFACE,), camera=nudged()).also
    tutorial = said('not_calibrated', 'warn', 'the surface is still that of the tutorial')
    assert state(parts=(), camera=tutorial).kind == 'not_calibrated'


def test_a_camera_node_that_is_gone_is_told_within_three_seconds():
    assert state(silent_s=2.6, camera=said(age_s=2.6)).kind == 'node_hangs'
    assert state(silent_s=1.6, camera=said(age_s=1.6)).level == 'warn'
    gone = CELL._replace(camera=None)
    assert cell_state(Facts(gone, silent_s=1.6)).kind == 'node_ended'
    assert cell_state(Facts(gone, was_seen=False, silent_s=1.6)).kind == 'not_running'


def test_a_fused_cell_is_told_by_camera_fusion_and_lacks_no_camera_node():
    running = GraphCell('/', None, None, '/camera_fusion', True)
    assert cell_state(Facts(running, fusion=said(), object_count=2)).kind == 'ok'
    one = cell_state(Facts(running, fusion=said(), cameras={'/left': nudged(), '/right': said()}))
    assert (one.level, one.sentence) == ('warn', 'In /left, the camera was nudged by 7.4 px')
    assert one.data['way'] == 'health'
    lone = said('one_camera', 'warn', 'left alone sees an object')
    assert cell_state(Facts(running, fusion=lone)).sentence == lone.sentence
    assert cell_state(Facts(running, silent_s=2.6, fusion=said(age_s=2.6))).kind == 'node_hangs'
    gone = cell_state(Facts(running._replace(fusion=None), silent_s=1.6))
    assert gone.kind == 'node_ended' and 'ros2 run camera_to_base camera_fusion' in gone.sentence


def test_a_robot_node_that_is_gone_is_told_within_three_seconds():
    one = state(owed_s=2.6, transform=said(age_s=2.6))
    assert (one.kind, one.level) == ('transform_hangs', 'error')
    one = cell_state(Facts(CELL._replace(transform=None), parts=ALL))
    assert one.kind == 'transform_not_running'


def test_two_seconds_without_a_base_position_are_told_with_their_cause():
    one = state(owed_s=2.1)
    assert (one.kind, one.level) == ('no_base_positions', 'error')
    dropped = said('positions_dropped', 'warn', '12 position(s) dropped: check reach_cm')
    assert 'check reach_cm' in state(owed_s=2.1, transform=dropped).sentence
    assert state(owed_s=0.5).kind == 'ok'


def test_a_doubt_holds_until_another_report_comes_however_late_that_is():
    # A busy machine delays reports by seconds, while positions come: they are no less doubtful.
    assert state(camera=nudged(9.0)).kind == 'view_corrected'
    assert state(camera=said(age_s=9.0)).kind == 'ok'


# One object, and where the base frame shows it.
IN_CAMERA, IN_BASE = Pose(10.0, 5.0, 0.0, 0.0), Pose(-7.8, 19.4, 0.0, 0.0)


def ellipse_of(frame, held):
    return objects_data(frame, None, held)[0]['ellipse']


def uncertain(pose, cm):
    return [UncertainPose(pose, np.eye(6) * cm ** 2)]


def test_a_base_position_never_has_the_ellipse_of_the_camera_frame():
    frame = SeenFrame([IN_CAMERA], [IN_BASE], uncertain(IN_CAMERA, 0.01))
    assert ellipse_of(frame, HeldEllipses()) is None
    alone = SeenFrame([IN_CAMERA], None, uncertain(IN_CAMERA, 0.01))
    assert ellipse_of(alone, HeldEllipses())['frame'] == 'camera'


def test_the_last_ellipse_of_a_base_position_is_held_until_the_next_one_comes():
    held = HeldEllipses()
    first = SeenFrame([IN_CAMERA], [IN_BASE], [], uncertain(IN_BASE, 0.1))
    known = ellipse_of(first, held)
    assert known['frame'] == 'base' and known['major_mm'] == pytest.approx(2.45, abs=0.01)
    moved = Pose(IN_BASE.x + 0.5, IN_BASE.y, 0.0, 0.0)
    assert ellipse_of(SeenFrame([IN_CAMERA], [moved], uncertain(IN_CAMERA, 0.01)), held) == known
    elsewhere = Pose(30.0, 30.0, 0.0, 0.0)
    assert ellipse_of(SeenFrame([IN_CAMERA], [elsewhere]), held) is None


def test_an_ellipse_is_not_held_for_longer_than_two_seconds():
    held = HeldEllipses()
    assert held.of('base', [IN_BASE], uncertain(IN_BASE, 0.1), 100.0) != [None]
    assert held.of('base', [IN_BASE], [], 101.9) != [None]
    assert held.of('base', [IN_BASE], [], 102.1) == [None]


def test_objects_that_count_as_flat_and_look_solid_are_no_fine_state():
    camera = said('looks_solid', 'warn', '1 of 2 objects looks solid')
    one = state(camera=camera)
    assert (one.kind, one.level, one.data['way']) == ('looks_solid', 'warn', 'watch')
    assert one.sentence == camera.sentence


def test_steps_that_are_not_on_the_disk_are_no_fine_state():
    one = state(not_kept="cannot write 'x': No space left on device")
    assert one.level == 'warn' and 'lost when the dashboard ends' in one.sentence
