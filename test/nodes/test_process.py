# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The exit code says whether a node could not start, or failed later and may be started again."""

import signal
import subprocess
import sys
import time

import pytest

FAILING_NODE = """
from camera_to_base.errors import CameraToBaseError
from camera_to_base.ros.process import run
from rclpy.node import Node


class Failing(Node):

    def __init__(self):
        super().__init__('failing')
        {}

    def fail(self):
        raise {}


raise SystemExit(run('failing', Failing, []))
"""


def run_failing(when, error):
    return subprocess.run(
        [sys.executable, '-c', FAILING_NODE.format(when, error)],
        text=True, capture_output=True, timeout=30.0)


def test_node_that_cannot_start_ends_with_1_and_a_sentence():
    child = run_failing('self.fail()', "CameraToBaseError('no such file')")
    assert child.returncode == 1 and 'cannot start: no such file' in child.stderr
    assert 'Traceback' not in child.stderr


@pytest.mark.parametrize('error', ['ValueError', 'RuntimeError'])
@pytest.mark.parametrize('when', ['self.fail()', 'self.create_timer(0.01, self.fail)'])
def test_defect_keeps_its_traceback_and_ends_with_70(when, error):
    child = run_failing(when, f"{error}('a defect')")
    assert child.returncode == 70 and f'{error}: a defect' in child.stderr
    assert 'Traceback' in child.stderr and 'cannot start' not in child.stderr


INTERRUPTED_NODE = """
import os
import signal

from camera_to_base.ros import Heartbeat
from camera_to_base.ros.process import run
from rclpy.node import Node
from std_msgs.msg import Header


class Interrupted(Node):

    def __init__(self):
        super().__init__('interrupted')
        Heartbeat(self)
        self._publisher = self.create_publisher(Header, 'itself', 1)
        self.create_subscription(Header, 'itself', print, 1)
        self.create_timer(0.1, self._publish)

    def _publish(self):
        self._publisher.publish(Header())
        Header.frame_id = property(lambda _: '', {})


def interrupt(*_):
    os.kill(os.getpid(), signal.SIGINT)


class Lost:

    def __del__(self):
        interrupt()


def lose(*_):
    Lost()


raise SystemExit(run('interrupted', Interrupted, []))
"""


@pytest.mark.parametrize('where', ['interrupt', 'lose'])
def test_signal_while_a_message_is_converted_ends_with_0(where):
    child = subprocess.run([sys.executable, '-c', INTERRUPTED_NODE.format(where)],
                           text=True, capture_output=True, timeout=30.0)
    assert child.returncode == 0 and 'RuntimeError' not in child.stderr, child.stderr


@pytest.mark.slow
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('executable', ['camera_publisher', 'robot_base_publisher'])
def test_signal_in_the_first_third_of_a_second_ends_with_0(start, executable, number):
    for delay in (0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3):
        node = start(executable)
        time.sleep(delay)
        assert node.end(number) == 0, delay
        assert 'Traceback' not in node.output


@pytest.mark.parametrize('arguments, sentence', [
    (['--params-file', 'nothing.yaml'], "cannot read the parameter file 'nothing.yaml': No such "),
    (['-p', 'displacement_cm:=[1, 2.0, 3]'],
     'all numbers of the list displacement_cm must be of one kind')])
def test_argument_that_ros_refuses_is_explained(start, arguments, sentence):
    node = start('robot_base_publisher', *arguments)
    assert node.wait() == 1
    assert f'cannot start: {sentence}' in node.output


def test_log_that_cannot_be_written_is_told_with_the_cure(start, monkeypatch, tmp_path):
    (tmp_path / 'file').touch()
    monkeypatch.setenv('ROS_LOG_DIR', str(tmp_path / 'file' / 'log'))
    node = start('robot_base_publisher')
    assert node.wait() == 1
    assert 'set ROS_LOG_DIR to a folder that can be written' in node.output
