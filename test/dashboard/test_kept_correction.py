# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The correction of a nudge, kept from a page, with real nodes."""

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.parameters import read_node_parameters
from geometry_msgs.msg import PoseArray
import numpy as np
import pytest
from rclpy.parameter import Parameter
from ros_helpers import OBJECTS_TOPIC, SIMULATED_CELL

BUMP = {'simulated.camera_shift_px': [5.0, -4.0], 'simulated.camera_turn_deg': 0.4}


@pytest.fixture
def status(ros):
    return ros.listen_to_diagnostics('/camera_publisher')


@pytest.fixture
def node(ros):
    arguments = ('source:=simulated', 'simulated.frame_rate:=20.0', 'simulated.table:=wood',
                 'simulated.shows:=still_objects')
    node = ros.add(
        CameraPublisher, *SIMULATED_CELL, *(word for one in arguments for word in ('-p', one)))
    ros.add(RobotBasePublisher)
    return node


@pytest.fixture
def page(ros, dashboard, node, tmp_path, monkeypatch):
    # Without params_file, it writes in the folder that it was started in.
    monkeypatch.chdir(tmp_path)
    page = dashboard()
    page.look()
    ros.spin_until(lambda: page.parts.get('parameters', {}).get('camera') and 'save' in page.parts)
    return page


def bump(ros, node, status):
    assert ros.spin_until(lambda: status and status[-1].values['reason'] == 'ok')
    assert all(result.successful for result in node.set_parameters(
        [Parameter(name, value=value) for name, value in BUMP.items()]))
    assert ros.spin_until(lambda: status[-1].values['reason'] == 'view_corrected', 60.0)


def points_of_next(ros, found):
    found.clear()
    assert ros.spin_until(lambda: len(found) > 3 and found[-1].poses)
    # Those in one column are as far to the right, but for the noise.
    return sorted(((pose.position.x, pose.position.y) for pose in found[-1].poses),
                  key=lambda point: np.round(point, 3).tolist())


@pytest.mark.slow
def test_kept_correction_is_in_the_file_and_in_the_node(ros, page, node, status, tmp_path):
    found = ros.listen_to(PoseArray, OBJECTS_TOPIC)
    bump(ros, node, status)
    before = points_of_next(ros, found)
    assert len(before) > 3
    path = tmp_path / 'cell.yaml'
    code, state = page.post('/api/correction?cell=/', {'path': str(path)})
    assert code == 200 and str(path) in state['saved']['sentence'], state
    held = read_node_parameters(str(path), '/camera_publisher')
    assert held['surface.model'] == 'homography'
    assert 'nudge' in held['calibration.surface']
    for name in ('surface.homography.surface_from_pixel', 'surface.covariance'):
        assert list(node.get_parameter(name).value) == held[name]
    status.clear()
    assert ros.spin_until(lambda: status and status[-1].values['reason'] == 'ok')
    assert np.allclose(before, points_of_next(ros, found), atol=1e-4)
    assert ros.spin_until(lambda: page.parts['save']['changes'] == []), page.parts['save']


@pytest.mark.slow
def test_nothing_is_written_where_nothing_is_corrected(ros, page, node, status, tmp_path):
    assert ros.spin_until(lambda: status and status[-1].values['reason'] == 'ok')
    code, answer = page.post('/api/correction?cell=/', {'path': str(tmp_path / 'cell.yaml')})
    assert code == 409 and 'there is no correction to keep' in answer['error']
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_without_a_file_the_page_is_asked_for_one_and_the_node_goes_on(ros, page, node, status):
    bump(ros, node, status)
    code, answer = page.post('/api/correction?cell=/', {})
    assert code == 409 and 'name the file to write' in answer['error']
    assert node.get_parameter('surface.model').value == 'parallel'
