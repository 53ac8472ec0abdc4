# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""What a page shows of a cell whose objects come from `camera_fusion`."""

from camera_to_base.nodes.camera_fusion import CameraFusion
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from fake_camera import BOX, DISC, FakeCamera, show_until
import pytest
from two_cameras import PAIRS


@pytest.fixture
def cameras(ros):
    """Start camera_fusion, and publish what its cameras would."""
    both = [FakeCamera(ros, name, place) for name, place in zip(
        ('left', 'right'), PAIRS['tilted 30 degrees, opposite sides'])]
    ros.add(CameraFusion)
    assert ros.spin_until(lambda: all(one.is_heard for one in both))
    return both


def test_fused_cell_has_heights_its_cameras_and_the_reasons_of_its_node(ros, dashboard, cameras):
    left, right = cameras
    page = dashboard()
    page.look()

    def shows_both():
        watch = page.parts.get('watch', {})
        return (len(page.parts.get('shapes', [])) == len(watch.get('objects', [])) == 2
                and watch['cameras'] and all(one['ellipse'] for one in watch['objects']))

    show_until(ros, shows_both, (left, (BOX, DISC)), (right, (BOX, DISC)))
    watch, shapes = page.parts['watch'], page.parts['shapes']
    assert watch['cameras'] == ['/left', '/right']
    assert [(one['camera'], one['pixel']) for one in watch['objects']] == [(None, None)] * 2
    box, disc = [one['base'] for one in watch['objects']]
    assert (box['x'], box['y']) == pytest.approx((6.0, 2.0), abs=0.05)
    assert (disc['x'], disc['y']) == pytest.approx((-7.0, -1.0), abs=0.05)
    assert [one['size_cm'] for one in shapes] == [
        pytest.approx((4.0, 3.0, 2.0), abs=0.12), pytest.approx((3.0, 3.0, 5.0), abs=0.15)]
    # The disc has no direction.
    assert len(shapes[0]['map']['box']) == 4 and shapes[1]['map']['box'] is None
    show_until(ros, lambda: page.parts['watch']['state']['reason'] == 'ok',
               (left, (BOX, DISC)), (right, (BOX, DISC)))

    # A camera that is nudged is not called well, though all is fused.
    talk = ros.node.create_publisher(DiagnosticArray, '/diagnostics', 10)

    def tells_nudge():
        talk.publish(DiagnosticArray(status=[DiagnosticStatus(
            name='/left/camera_publisher', level=DiagnosticStatus.WARN,
            message='the camera was nudged',
            values=[KeyValue(key='reason', value='view_corrected')])]))
        state = page.parts['watch']['state']
        return state['sentence'] == 'In /left, the camera was nudged' and state['level'] == 'warn'

    show_until(ros, tells_nudge, (left, (BOX, DISC)), (right, (BOX, DISC)))

    def tells(reason):
        return lambda: page.parts['watch']['state']['reason'] == reason

    # What is new for one camera alone is left out.
    show_until(ros, tells('one_camera'), (left, (BOX, DISC)), (right, (DISC,)))
    show_until(ros, tells('camera_silent'), (left, (BOX, DISC)))
    state = page.parts['watch']['state']
    assert state['sentence'].startswith('right publishes no positions')
    assert (state['level'], state['way']) == ('warn', 'health')
    show_until(ros, lambda: page.parts['health']['nodes'][0]['reason'] == 'camera_silent',
               (left, (BOX, DISC)))
    assert [one['name'] for one in page.parts['health']['nodes']] == [
        '/camera_fusion', '/left/camera_publisher', '/left/robot_base_publisher',
        '/right/camera_publisher', '/right/robot_base_publisher']
