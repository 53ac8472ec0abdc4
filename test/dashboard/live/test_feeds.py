# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the dashboard hears of a camera driver."""

from camera_to_base.dashboard.live.feeds import SessionFeed
from camera_to_base.nodes.camera_publisher import CameraPublisher
import pytest
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo


class Sessions:
    """Stands for a cell's sessions, which are tested on their own."""

    wants_objects, tool_topic = False, ''

    def __init__(self):
        self.wants_frames, self.infos = True, []

    def see_camera_info(self, info, is_rectified=False):
        self.infos.append((info and info.k[0], is_rectified))


@pytest.mark.parametrize('name, source, is_rectified', [
    ('/driver/image_raw', 'topic', False),
    ('/driver/image_rect/compressed', 'compressed_topic', True)])
def test_camera_info_beside_the_camera_nodes_pictures_is_heard_while_it_is_wanted(
        ros, name, source, is_rectified):
    topic = 'image/compressed' if source == 'compressed_topic' else 'image'
    ros.add(CameraPublisher, '-p', f'source:={source}', '-r', f'{topic}:={name}')
    driver = ros.node.create_publisher(
        CameraInfo, '/driver/camera_info', qos_profile_sensor_data)
    sessions = Sessions()
    feed = SessionFeed(ros.node, '/', sessions)

    def is_heard():
        feed.look_at_driver('/camera_publisher')
        driver.publish(CameraInfo(k=[500.0, *8 * [0.0]]))
        return sessions.infos

    ros.spin_until(is_heard)
    assert sessions.infos == [(500.0, is_rectified)]
    sessions.wants_frames = False
    feed.look_at_driver('/camera_publisher')
    assert sessions.infos[-1] == (None, False)
    feed.close()


def test_camera_without_a_driver_has_no_camera_info(ros):
    ros.add(CameraPublisher, '-p', 'source:=simulated')
    sessions = Sessions()
    feed = SessionFeed(ros.node, '/', sessions)
    feed.look_at_driver('/camera_publisher')
    feed.look_at_driver('/nobody')
    assert sessions.infos == []
