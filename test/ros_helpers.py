# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What node tests and process tests share: a node that listens, and waiting for a condition."""

from collections import namedtuple
import os
import signal
import subprocess
import sys
import time

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

LogLine = namedtuple('LogLine', 'received_at level text')
Status = namedtuple('Status', 'received_at level message values')

CAMERA_TOPIC = '/pos_in_cam_frame'
BASE_TOPIC = '/pos_in_robot_base_frame'
OBJECTS_TOPIC = '/objects_in_cam_frame'
TRUE_TOPIC = '/true_pos_in_cam_frame'
# The simulated camera's own calibration.
SIMULATED_CELL = ('--params-file', os.path.join(
    get_package_share_directory('camera_to_base'), 'config', 'simulated_camera.yaml'))


class NotInTime(AssertionError):
    """Something took too long, as it may on a busy machine: a test that raises it is run again."""


def assert_in_time(seconds, limit):
    """Raise NotInTime where something took longer than it may."""
    if seconds >= limit:
        raise NotInTime(f'took {seconds:.2f} s, expected less than {limit} s')


def stamp_now():
    """Make the stamp of a picture that a driver takes now."""
    seconds, nanoseconds = divmod(time.time_ns(), 10**9)
    return Time(sec=seconds, nanosec=nanoseconds)


class Ros:
    """A ROS context of its own, with an executor and a node that listens and talks."""

    def __init__(self):
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.node = rclpy.create_node('test_listener', context=self.context)
        self.executor.add_node(self.node)
        self._nodes = [self.node]
        self._subscriptions = {}

    def add(self, node_class, *arguments):
        """Make a node of the package, as the command line would, and spin it here."""
        cli_args = ['--ros-args', *arguments] if arguments else None
        node = node_class(context=self.context, cli_args=cli_args)
        self._nodes.append(node)
        self.executor.add_node(node)
        return node

    def remove(self, node):
        """Destroy a node, as if its process had ended."""
        self.executor.remove_node(node)
        self._nodes.remove(node)
        node.destroy_node()

    def listen(self, topic):
        """Return a list that grows by [x, y] for each message of a topic."""
        return self._record(topic, lambda message, info: list(message.data))

    def listen_with_time(self, topic):
        """Return a list that grows by (time sent in s, [x, y]) for each message of a topic."""
        return self._record(topic, lambda message, info: (
            info['source_timestamp'] / 1e9, list(message.data)))

    def listen_to(self, message_type, topic):
        """Return a list that grows by each message of a topic."""
        received = []
        self._subscriptions[topic] = self.node.create_subscription(
            message_type, topic, received.append, 100)
        return received

    def stop_listening(self, topic):
        """Give a subscription back."""
        self.node.destroy_subscription(self._subscriptions.pop(topic))

    def listen_to_diagnostics(self, node_name):
        """Return a list that grows by level, message and values for each status of a node."""
        received = []

        def on_message(message):
            received.extend(
                Status(time.monotonic(), status.level[0], status.message,
                       {pair.key: pair.value for pair in status.values})
                for status in message.status if status.name == node_name)

        self.node.create_subscription(DiagnosticArray, '/diagnostics', on_message, 100)
        return received

    def listen_to_log(self, node_name):
        """Return a list that grows by time received, level and text for each line of a node."""
        received = []
        self.node.create_subscription(Log, '/rosout', lambda line: received.append(
            LogLine(time.monotonic(), line.level, line.msg)) if line.name == node_name else None,
            QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        return received

    def call(self, name, timeout=15.0):
        """Call a service of type Trigger, and return its response."""
        client = self.node.create_client(Trigger, name)
        assert self.spin_until(client.service_is_ready)
        future = client.call_async(Trigger.Request())
        assert self.spin_until(future.done, timeout)
        return future.result()

    def talk(self, topic):
        """Return a publisher."""
        return self.node.create_publisher(Float64MultiArray, topic, 10)

    def spin_until(self, condition, timeout=30.0):
        """Spin until a condition holds, and return True, or raise NotInTime."""
        until = time.monotonic() + timeout
        while not condition():
            if time.monotonic() >= until:
                raise NotInTime(f'waited for {timeout:.1f} s')
            self.executor.spin_once(timeout_sec=0.05)
        return True

    def spin_for(self, seconds):
        """Spin for a time."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.executor.spin_once(timeout_sec=0.05)

    def close(self):
        """Destroy all nodes and the context."""
        for node in self._nodes:
            node.destroy_node()
        self.executor.shutdown()
        rclpy.shutdown(context=self.context)

    def hears(self, topic):
        """Tell whether a publisher of a topic that is listened to has been found."""
        return self._subscriptions[topic].get_publisher_count() > 0

    def _record(self, topic, convert):
        received = []
        self._subscriptions[topic] = self.node.create_subscription(
            Float64MultiArray, topic,
            lambda message, info: received.append(convert(message, info)), 100)
        return received


class Process:
    """
    An installed executable of the package, running.

    :param executable: Its name, or a script's path.
    """

    def __init__(self, executable, *arguments):
        command = [sys.executable, executable] if executable.endswith('.py') else [os.path.join(
            get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', executable)]
        self._process = subprocess.Popen(
            [*command, *(['--ros-args', *arguments] if arguments else [])],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.output = ''

    @property
    def number(self):
        """The process's number, its PID."""
        return self._process.pid

    @property
    def is_running(self):
        """Tell whether it has not ended."""
        return self._process.poll() is None

    def send_signal(self, number):
        """Send a signal."""
        self._process.send_signal(number)

    def end(self, number=signal.SIGINT, timeout=2.0):
        """Send a signal; return the exit code, or fail where it takes longer than allowed."""
        self.send_signal(number)
        return self.wait(timeout)

    def wait(self, timeout=20.0):
        """Wait for the end; return the exit code, and keep what was printed as `output`."""
        try:
            self.output, _ = self._process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            self.kill()
            raise NotInTime(f'still running after {timeout} s; it said: {self.output}')
        return self._process.returncode

    def kill(self):
        """End it whatever it does."""
        self._process.kill()
        self.output, _ = self._process.communicate()


def between_waits(example):
    """Give a command that runs an example as on a slow machine: mostly between two waits."""
    code = f"""
import runpy, sys, time
from rclpy import executors
class Slow:
    def __getattr__(self, name):
        return getattr(bindings, name)
    def WaitSet(self, *counts):
        time.sleep(0.1)
        return bindings.WaitSet(*counts)
bindings, executors._rclpy = executors._rclpy, Slow()
sys.path.insert(0, {str(example.parent)!r})
runpy.run_path({str(example)!r}, run_name='__main__')
"""
    return [sys.executable, '-c', code]
