# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""README's node prints each position, and ends without a traceback."""

from pathlib import Path
import signal
import subprocess
import sys

from geometry_msgs.msg import PointStamped
import pytest
from ros_helpers import between_waits

EXAMPLE = Path(__file__).parents[1] / 'examples' / 'print_positions.py'


@pytest.mark.slow
def test_each_position_is_printed_until_ctrl_c(ros):
    publisher = ros.node.create_publisher(PointStamped, 'pos_in_robot_base_frame/point', 10)
    example = subprocess.Popen([sys.executable, EXAMPLE], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    try:
        assert ros.spin_until(lambda: publisher.get_subscription_count())
        message = PointStamped()
        message.header.frame_id, message.point.x, message.point.y = 'base_link', 0.25, -0.1
        publisher.publish(message)
        assert example.stdout.readline() == 'x 0.250 m, y -0.100 m in base_link\n'
    finally:
        example.send_signal(signal.SIGINT)
        output, _ = example.communicate(timeout=10.0)
    assert (example.returncode, output) == (0, '')


@pytest.mark.parametrize('name', ['print_positions.py', 'two_link_arm.py'])
def test_signal_between_two_waits_is_an_end(ros, name):
    publisher = ros.node.create_publisher(PointStamped, 'pos_in_robot_base_frame/point', 10)
    example = subprocess.Popen(between_waits(EXAMPLE.with_name(name)), stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    assert ros.spin_until(lambda: publisher.get_subscription_count())
    ros.node.create_timer(0.01, lambda: publisher.publish(PointStamped()))
    ros.spin_for(1.0)
    example.send_signal(signal.SIGTERM)
    _, errors = example.communicate(timeout=20.0)
    assert example.returncode == 0 and 'Traceback' not in errors
