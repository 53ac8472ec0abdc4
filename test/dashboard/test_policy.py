# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The SROS2 policy allows what the dashboard does, and nothing that it doesn't."""

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from test_sros2_policy import allowed

VERBS = {'publisher': 'publish', 'subscriber': 'subscribe', 'service': 'reply',
         'client': 'request'}


def done_by_dashboard(ros):
    """Give what the dashboard does, as the graph knows it."""
    return {(verb, name) for kind, verb in VERBS.items()
            for name, _ in getattr(ros.node, f'get_{kind}_names_and_types_by_node')(
                'dashboard', '/')}


def test_policy_allows_what_the_dashboard_does_and_nothing_else(ros, dashboard):
    # With a camera's place there are silhouettes, too.
    ros.add(CameraPublisher, '-p', 'source:=simulated', '-p', 'surface.camera_height_cm:=60.0',
            '-p', 'surface.camera_foot_cm:=[18.0, 13.5]')
    ros.add(RobotBasePublisher)
    page = dashboard()
    page.look()
    for kind in ('annotated', 'frame', 'mask', 'background', 'board'):
        page.watch_pictures(kind)
    ros.spin_until(lambda: page.parts.get('watch', {}).get('objects') and page.pictures)
    ros.spin_until(lambda: done_by_dashboard(ros) >= allowed('dashboard'))
    assert done_by_dashboard(ros) == allowed('dashboard')
