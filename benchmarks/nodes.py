# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures the nodes: CPU time per message compared with a bare relay, start-up time, memory.

Run it where the package is sourced, or by `scripts/benchmark nodes`.
"""

import argparse
import os
import platform
from statistics import median
import subprocess
import sys
import time

from ament_index_python.packages import get_package_prefix
from fusion_node import fusion_costs
import rclpy
from rclpy.signals import SignalHandlerOptions
from rows import print_rows
from std_msgs.msg import Float64MultiArray

RELAY = [sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), 'relay.py')]


def main():
    """Measure, print and, with --json, write the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--quick', action='store_true', help='few messages, for a first look')
    parser.add_argument('--json', metavar='FILE', help='write the rows there as well')
    arguments = parser.parse_args()
    os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    rounds, messages = (2, 200) if arguments.quick else (9, 1000)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    print(f'Python {platform.python_version()}, {platform.machine()}, {os.cpu_count()} CPUs, '
          f'{rounds} rounds of {messages} messages, interleaved, medians')
    print_rows(message_costs(rounds, messages) + [
        *fusion_costs([executable('camera_fusion')], cpu_seconds, *(
            (1, 60) if arguments.quick else (3, 600))),
        start_up('robot_base_publisher', [], rounds),
        start_up('camera_publisher', ['--ros-args', '-p', 'source:=random'], rounds)],
        arguments.json)
    rclpy.shutdown()


def message_costs(rounds, messages):
    """Compare the transform node's CPU time for a message with a bare relay's."""
    relay, transform = [], []
    for _ in range(rounds):
        relay.append(cost_of_a_message(RELAY, messages))
        transform.append(cost_of_a_message([executable('robot_base_publisher')], messages))
    ratio = median(t / r for t, r in zip(transform, relay))
    return [{'node': 'relay', 'ms_per_message': round(1e3 * median(relay), 4), 'ratio': 1.0},
            {'node': 'robot_base_publisher', 'ms_per_message': round(1e3 * median(transform), 4),
             'ratio': round(ratio, 3)}]


def cost_of_a_message(command, messages):
    """Send messages one after another; return the process's CPU time per message, in s."""
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    node = rclpy.create_node('benchmark')
    received = []
    node.create_subscription(
        Float64MultiArray, 'pos_in_robot_base_frame', received.append, 10)
    publisher = node.create_publisher(Float64MultiArray, 'pos_in_cam_frame', 10)
    message = Float64MultiArray(data=[19.5, 13.75])
    try:
        exchange(node, publisher, message, received, 50)
        before = cpu_seconds(process.pid)
        exchange(node, publisher, message, received, messages)
        return (cpu_seconds(process.pid) - before) / messages
    finally:
        process.kill()
        process.wait()
        node.destroy_node()


def exchange(node, publisher, message, received, count):
    """Send messages and wait for each reply; messages lost during discovery are sent again."""
    answered = 0
    while answered < count:
        received.clear()
        publisher.publish(message)
        until = time.monotonic() + 0.2
        while not received and time.monotonic() < until:
            rclpy.spin_once(node, timeout_sec=0.05)
        answered += bool(received)


def start_up(name, arguments, rounds):
    """Measure the time until another node discovers a node, and its memory then."""
    seconds, megabytes = [], []
    for _ in range(rounds):
        node = rclpy.create_node('benchmark')
        begin = time.monotonic()
        process = subprocess.Popen([executable(name), *arguments], stderr=subprocess.DEVNULL)
        while name not in node.get_node_names():
            time.sleep(0.005)
        seconds.append(time.monotonic() - begin)
        megabytes.append(resident_megabytes(process.pid))
        process.terminate()
        process.wait()
        while name in node.get_node_names():
            time.sleep(0.01)
        node.destroy_node()
    return {'node': name, 'start_up_s': round(median(seconds), 2),
            'resident_mb': round(median(megabytes), 1)}


def executable(name):
    """Return the path of an installed executable."""
    return os.path.join(get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', name)


def cpu_seconds(pid):
    """Read the CPU time of all threads of a process; the kernel counts it in ns."""
    total = 0
    for task in os.listdir(f'/proc/{pid}/task'):
        with open(f'/proc/{pid}/task/{task}/schedstat') as file:
            total += int(file.read().split()[0])
    return total / 1e9


def resident_megabytes(pid):
    """Return the resident memory of a process."""
    with open(f'/proc/{pid}/statm') as file:
        return int(file.read().split()[1]) * os.sysconf('SC_PAGE_SIZE') / 1e6


if __name__ == '__main__':
    main()
