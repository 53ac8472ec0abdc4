# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Starts both nodes and the dashboard, and prints each object that they publish."""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

from camera_to_base.errors import CameraToBaseError
from camera_to_base.settings import read_node_settings
from demo_bumps import Bumps
from demo_claims import Claims
from demo_pick import Picks
from demo_report import Report
from demo_terminal import Terminal
from demo_two import TwoCameras

# What is set up on the dashboard's page is saved here.
CELL_FILE, PICTURE = 'cell.yaml', 'demo.png'
# The address is printed below what the nodes log as they start.
QUIET_S = 1.0
# A signal only sets this flag: an exception raised inside rclpy is not always passed on.
told_to_end = threading.Event()


def main(arguments):
    """Run the demo until Ctrl-C, or until the recording ends; return the exit code."""
    options = parse(arguments)
    source, terminal, claims = options.source, Terminal(), Claims()
    # A separate ROS domain, unless one is set, so that no arm follows the demo.
    os.environ.setdefault('ROS_DOMAIN_ID', str(claims.domain()))
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    if not os.environ['ROS_DOMAIN_ID'].isdecimal() or int(os.environ['ROS_DOMAIN_ID']) > 232:
        print(f'error: ROS_DOMAIN_ID must be 0..232, got {os.environ["ROS_DOMAIN_ID"]}',
              file=sys.stderr)
        return 1
    picture, page = claims.file(PICTURE), Page(claims.port())
    if os.path.exists(picture):
        os.remove(picture)
    nodes, others = [], []
    try:
        terminal.say(f'starting both nodes in ROS domain {os.environ["ROS_DOMAIN_ID"]} on the '
                     f"source '{source}'; Ctrl-C ends them")
        if options.two:
            nodes += [start(terminal, executable, {}, file, namespace)
                      for executable, file, namespace in TwoCameras.nodes()]
        else:
            start_camera(terminal, nodes, options)
        # Positions are printed with or without it.
        if page.port:
            others.append(start(terminal, 'dashboard', {
                'port': page.port, 'params_file': os.path.abspath(options.params or CELL_FILE)}))
        if options.pick:
            others.append(start_command(terminal, Picks.arm_command()))
        return listen(terminal, nodes, page, picture, options)
    except BrokenPipeError:
        # The reader has closed the pipe. Further output is discarded.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    finally:
        stop([*nodes, *others])


def start_camera(terminal, nodes, options):
    """Start both nodes of one camera, and add them to the nodes."""
    source, params = options.source, options.params or calibration_of(
        options.source, options.pick)
    nodes.append(start(terminal, 'robot_base_publisher', {}, params))
    nodes.append(start(terminal, 'camera_publisher', {
        'source': source, 'wait_for_subscribers': 2, 'wait_for_camera': False,
        **method_for(source), **Bumps.parameters(options.bump)}, params))


class Page:
    """
    The dashboard's page.

    :param port: Its port; 0 if there is none.
    """

    def __init__(self, port):
        self.port, self.address = port, f'http://127.0.0.1:{port}/'
        self._began, self._is_told = time.monotonic(), not port

    def tell(self, terminal):
        """Print the address in a box, once it answers and the nodes have logged their start."""
        if not self._is_told and time.monotonic() - self._began > QUIET_S and self._answers():
            self._is_told = True
            terminal.frame(['Watch it, and set it up, in your browser:', self.address])

    def _answers(self):
        try:
            socket.create_connection(('127.0.0.1', self.port), 0.1).close()
        except OSError:
            self._began = time.monotonic()
            return False
        return True


def calibration_of(source, is_picking):
    """Return the parameter file of the simulated camera; None for other sources."""
    config = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'config')
    name = 'simulated_solid_objects.yaml' if is_picking else 'simulated_camera.yaml'
    return os.path.join(config, name) if source == 'simulated' else None


def parse(arguments):
    """Parse the command line; the source is that of the parameter file, if it names one."""
    parser = argparse.ArgumentParser(prog='scripts/demo', description=__doc__)
    parser.add_argument('--params', metavar='FILE')
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument('--bump', action='store_true')
    kinds.add_argument('--pick', action='store_true')
    kinds.add_argument('--two', action='store_true')
    parser.add_argument('source', nargs='?')
    options = parser.parse_args(arguments)
    try:
        settings = read_node_settings(options.params)
    except CameraToBaseError as error:
        parser.error(str(error))
    if options.source is None:
        named = settings.camera.source
        is_simulated = named == 'auto' or options.bump or options.pick or options.two
        options.source = 'simulated' if is_simulated else named
    if options.bump and options.source != 'simulated':
        parser.error('--bump bumps the simulated camera only: leave the source out')
    if options.pick and options.source != 'simulated':
        parser.error('--pick takes objects of the simulated camera only: leave the source out')
    if options.two and (options.source != 'simulated' or options.params):
        parser.error('--two has two simulated cameras: leave the source and --params out')
    return options


def method_for(source):
    """Return the method: the tutorial's for a recording, for comparison."""
    return {'detector.method': 'tutorial'} if os.path.isfile(source) else {}


def start(terminal, executable, parameters, file=None, namespace=''):
    """Start an installed executable like `ros2 run`, but without the terminal's Ctrl-C."""
    from ament_index_python.packages import get_package_prefix
    path = os.path.join(get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', executable)
    command = [path, '--ros-args', *(['--params-file', file] if file else []),
               *(['-r', f'__ns:=/{namespace}'] if namespace else [])]
    for name, value in parameters.items():
        command += ['-p', f'{name}:={json.dumps(value)}']
    return start_command(terminal, command)


def start_command(terminal, command):
    """Start a process whose lines are printed."""
    process = subprocess.Popen(
        command, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, errors='replace', env={
            **os.environ, 'RCUTILS_COLORIZED_OUTPUT': str(int(sys.stdout.isatty()))})
    process.printed = terminal.follow(process.stdout)
    return process


def listen(terminal, nodes, page, picture, options):
    """Print what the nodes publish until one of them ends; return its exit code."""
    import rclpy
    from rclpy.signals import SignalHandlerOptions
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('demo')
    report = TwoCameras(node, terminal) if options.two else Report(node, terminal, picture)
    # What happens to the table or the camera, and is told.
    shows = [show for show in (options.bump and Bumps(node, report, terminal),
                               options.pick and Picks(node, terminal)) if show]
    try:
        while not told_to_end.is_set() and all(process.poll() is None for process in nodes):
            rclpy.spin_once(node, timeout_sec=0.1)
            page.tell(terminal)
        until = time.monotonic() + 0.5
        while not told_to_end.is_set() and time.monotonic() < until:
            rclpy.spin_once(node, timeout_sec=0.1)
        codes = [process.poll() or 0 for process in nodes]
    finally:
        terminal.settle()
        stop(nodes)
        for show in shows:
            show.close()
        report.close()
        if page.port:
            terminal.say(f'page: {page.address} (it has ended with the demo)')
    return 0 if told_to_end.is_set() else max(
        exit_code(*ended) for ended in zip(nodes, codes))


def exit_code(process, code):
    """Return a node's exit code in the shell's form for a signal, and tell of a signal."""
    if code >= 0:
        return code
    print(f'error: {os.path.basename(process.args[0])} has died: '
          f'{signal.strsignal(-code)} (signal {-code})', file=sys.stderr)
    return 128 - code


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
