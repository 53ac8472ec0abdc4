# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Starts both nodes and the dashboard, and prints each object that they publish."""

import argparse
import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time

from camera_to_base.errors import CameraToBaseError
from camera_to_base.settings import read_node_settings
import cv2
from demo_bumps import Bumps
import numpy as np

PICTURE = 'demo.png'
# What is set up on the dashboard's page is saved here.
CELL_FILE = 'cell.yaml'
DASHBOARD_PORT = 8080
# A frame's true position is sent right before its position; the frame before is 100 ms older.
LONGEST_LAG_NS = 30_000_000
# A signal only sets this flag: an exception raised inside rclpy is not always passed on.
told_to_end = threading.Event()


def main(arguments):
    """Run the demo until Ctrl-C, or until the recording ends; return the exit code."""
    options = parse(arguments)
    source = options.source
    # A separate ROS domain, unless one is set, so that no arm follows the demo.
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    if not os.environ['ROS_DOMAIN_ID'].isdecimal() or int(os.environ['ROS_DOMAIN_ID']) > 232:
        print(f'error: ROS_DOMAIN_ID must be 0..232, got {os.environ["ROS_DOMAIN_ID"]}',
              file=sys.stderr)
        return 1
    remove_old_picture()
    print(f'starting both nodes in ROS domain {os.environ["ROS_DOMAIN_ID"]} on the source '
          f"'{source}'; Ctrl-C ends them", flush=True)
    nodes, others = [], []
    try:
        nodes.append(start('robot_base_publisher', {}, options.params))
        nodes.append(start('camera_publisher', {
            'source': source, 'wait_for_subscribers': 2, 'wait_for_camera': False,
            **method_for(source), **Bumps.parameters(options.bump)}, options.params))
        # Positions are printed with or without it.
        others.append(start('dashboard', {
            'port': port_for_dashboard(),
            'params_file': os.path.abspath(options.params or CELL_FILE)}))
        return listen(nodes, options)
    except BrokenPipeError:
        # The reader has closed the pipe. Further output is discarded.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    finally:
        stop([*nodes, *others])


def port_for_dashboard():
    """Return the usual port, or 0 for any one if that is taken."""
    with socket.socket() as one:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            one.bind(('127.0.0.1', DASHBOARD_PORT))
        except OSError:
            return 0
    return DASHBOARD_PORT


def parse(arguments):
    """Parse the command line; the source is that of the parameter file, if it names one."""
    parser = argparse.ArgumentParser(prog='scripts/demo', description=__doc__)
    parser.add_argument('--params', metavar='FILE')
    parser.add_argument('--bump', action='store_true')
    parser.add_argument('source', nargs='?')
    options = parser.parse_args(arguments)
    try:
        settings = read_node_settings(options.params)
    except CameraToBaseError as error:
        parser.error(str(error))
    options.conversion = settings.transform.conversion
    if options.source is None:
        named = settings.camera.source
        options.source = 'simulated' if named == 'auto' or options.bump else named
    if options.bump and options.source != 'simulated':
        parser.error('--bump bumps the simulated camera only: leave the source out')
    return options


def method_for(source):
    """Return the method: the tutorial's for a recording, for comparison."""
    return {'detector.method': 'tutorial'} if os.path.isfile(source) else {}


def start(executable, parameters, file=None):
    """Start an installed executable like `ros2 run`, but without the terminal's Ctrl-C."""
    from ament_index_python.packages import get_package_prefix
    path = os.path.join(get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', executable)
    command = [path, '--ros-args', *(['--params-file', file] if file else [])]
    for name, value in parameters.items():
        command += ['-p', f'{name}:={json.dumps(value)}']
    return subprocess.Popen(command, start_new_session=True)


def listen(nodes, options):
    """Print what the nodes publish until one of them ends; return its exit code."""
    import rclpy
    from rclpy.signals import SignalHandlerOptions
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('demo')
    report = Report(node, options.conversion)
    bumps = Bumps(node, report) if options.bump else None
    try:
        while not told_to_end.is_set() and all(process.poll() is None for process in nodes):
            rclpy.spin_once(node, timeout_sec=0.1)
        until = time.monotonic() + 0.5
        while not told_to_end.is_set() and time.monotonic() < until:
            rclpy.spin_once(node, timeout_sec=0.1)
    finally:
        if bumps is not None:
            bumps.close()
        report.close()
    return 0 if told_to_end.is_set() else max(exit_code(process) for process in nodes)


def exit_code(process):
    """Return a node's exit code, in the shell's form for a signal; 0 if it is running."""
    code = process.poll() or 0
    if code >= 0:
        return code
    print(f'error: {os.path.basename(process.args[0])} has died: '
          f'{signal.strsignal(-code)} (signal {-code})', file=sys.stderr)
    return 128 - code


class Report:
    """
    Prints a line for each position in the base frame, with the camera position it came from.

    `errors` has the time of each position and its error in mm, where the truth is known.
    """

    def __init__(self, node, conversion):
        from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
        from geometry_msgs.msg import PointStamped
        from sensor_msgs.msg import Image
        from std_msgs.msg import Float64MultiArray
        self.errors = []
        self._conversion = conversion
        # Of the simulated camera's true positions, whatever the calibration is.
        self._true_conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
        self._camera_positions = []
        self._true_positions = []
        self._waiting = []
        self._last_stamp = 0
        self._count = 0
        self._node = node
        self._picture_saved = False
        self._stamps, self._newest_image = set(), None
        for topic, callback in (('pos_in_cam_frame', self._on_camera_position),
                                ('true_pos_in_cam_frame', self._on_true_position),
                                ('pos_in_robot_base_frame', self._on_base_position)):
            node.create_subscription(Float64MultiArray, topic, callback, 100)
        self._for_picture = [
            node.create_subscription(PointStamped, 'pos_in_cam_frame/point', self._on_point, 100),
            node.create_subscription(Image, 'debug_image', self._on_image, 1)]
        node.create_timer(0.05, self._print_settled)

    def close(self):
        """Print the number of positions, and the picture's path."""
        print(f'{self._count} positions')
        if self._picture_saved:
            print(f'annotated picture: {os.path.abspath(PICTURE)}', flush=True)

    def _on_camera_position(self, message, info):
        remember(self._camera_positions, info['source_timestamp'], message.data)

    def _on_true_position(self, message, info):
        remember(self._true_positions, info['source_timestamp'], message.data)

    def _on_base_position(self, message, info):
        self._waiting.append((time.monotonic(), info['source_timestamp'], tuple(message.data)))

    def _print_settled(self):
        # Topics are not synchronised: a camera position may arrive after its base position.
        while self._waiting and time.monotonic() - self._waiting[0][0] > 0.1:
            received_at, stamp, position = self._waiting.pop(0)
            self._print(received_at, stamp, *position)

    def _print(self, received_at, stamp, x, y):
        camera = self._origin(stamp, x, y)
        if camera is None:
            return  # sent before this subscriber was discovered
        self._last_stamp, (camera_x, camera_y) = camera
        self._count += 1
        line = f'camera ({camera_x:6.2f}, {camera_y:6.2f}) cm  ->  base ({x:6.2f}, {y:6.2f}) cm'
        truth = last_before(self._true_positions, self._last_stamp)
        # The first true positions may be missing: an earlier frame's is no measure.
        if truth is not None and self._last_stamp - truth[0] < LONGEST_LAG_NS:
            true_x, true_y, _ = self._true_conversion.convert_point(*truth[1])
            error_mm = 10 * math.dist((x, y), (true_x, true_y))
            self.errors.append((received_at, error_mm))
            line += f'   true ({true_x:6.2f}, {true_y:6.2f}) cm   error {error_mm:.2f} mm'
        print(line, flush=True)

    def _origin(self, stamp, x, y):
        # A position has no stamp, and a busy machine may lose one: it belongs to the camera
        # position that it agrees with.
        waiting = [position for position in self._camera_positions
                   if self._last_stamp < position[0] <= stamp]
        return min(waiting, default=None, key=lambda position: math.dist(
            (x, y), self._conversion.convert_point(*position[1])[:2]))

    def _on_point(self, message):
        self._stamps.add(stamp_of(message))
        self._save_picture()

    def _on_image(self, message):
        self._newest_image = message
        self._save_picture()

    def _save_picture(self):
        # The first one with a published object; either the image or its position arrives first.
        image = self._newest_image
        if self._picture_saved or image is None or stamp_of(image) not in self._stamps:
            return
        picture = np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)
        cv2.imwrite(PICTURE, picture)
        self._picture_saved = True
        # The node draws as long as there is a subscriber.
        for subscription in self._for_picture:
            self._node.destroy_subscription(subscription)
        print(f'annotated picture: {os.path.abspath(PICTURE)}', flush=True)


def stamp_of(message):
    """Return the capture time of a message's frame."""
    return message.header.stamp.sec, message.header.stamp.nanosec


def remember(positions, stamp, position):
    """Keep the newest hundred positions with the time at which they were sent."""
    positions.append((stamp, tuple(position)))
    del positions[:-100]


def last_before(positions, stamp):
    """Return the last position that was sent before a time, or None."""
    earlier = [position for position in positions if position[0] <= stamp]
    return max(earlier) if earlier else None


def remove_old_picture():
    """Delete the picture of an earlier demo."""
    if os.path.exists(PICTURE):
        os.remove(PICTURE)


def stop(nodes):
    """End the processes with SIGTERM, which they handle even while Python starts."""
    for process in nodes:
        process.terminate()
    for process in nodes:
        try:
            process.wait(1.5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


if __name__ == '__main__':
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: told_to_end.set())
    sys.exit(main(sys.argv[1:]))
