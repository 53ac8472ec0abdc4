# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The installed executables; each loads its module only when it is run."""

from importlib import import_module
import os
import signal
import sys

from camera_to_base.errors import CANNOT_START
from camera_to_base.files import serve_signals
from camera_to_base.nodes.help import asks_for_help, help_text, plain_arguments

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def use_one_blas_thread() -> None:
    """
    Let OpenBLAS compute in the calling thread; it must be called before numpy is imported.

    The matrices of a fit are small: on a busy machine, threads for them cost fifteen times as
    much. A number of threads that the user has set is kept.
    """
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')


def start(node: str, module: str) -> int:
    """
    Answer `--help`, refuse wrong arguments, or load a node's module and run its `main`.

    Loading ROS, OpenCV and numpy takes part of a second, so it is done last.

    :param node: The node's name.
    :param module: The module with its `main`.
    :returns: The process's exit code.
    """
    _end_quietly_while_loading()
    name, arguments = os.path.basename(sys.argv[0]), sys.argv[1:]
    if asks_for_help(arguments):
        print(help_text(node, name), end='')
        return 0
    # rclpy ignores other arguments: `-p source:=0` without --ros-args would publish random pixels.
    plain = plain_arguments(arguments)
    if plain:
        return _refuse(name, 'expected ROS arguments only, after --ros-args, got '
                             f"'{plain[0]}': see {name} --help")
    try:
        import_module('rclpy')
    except ModuleNotFoundError as error:
        if error.name != 'rclpy':
            raise
        return _refuse(name, 'ROS 2 is missing: source /opt/ros/jazzy/setup.bash, or install the '
                             "extra ros: pip install '.[ros]'")
    return import_module(module).main()


def _end_quietly_while_loading() -> None:
    # Nothing needs to be cleaned up yet.
    for number in _SIGNALS:
        signal.signal(number, lambda *_: os._exit(0))
    serve_signals()


def _refuse(name: str, sentence: str) -> int:
    print(f'{name}: {sentence}', file=sys.stderr)
    return CANNOT_START


def calibrate() -> int:
    """Run the command `calibrate`."""
    use_one_blas_thread()
    from camera_to_base.commands.calibrate.command import main
    return main()


def locate() -> int:
    """Run the command `locate`."""
    from camera_to_base.commands.locate import main
    return main()


def camera_publisher() -> int:
    """Run the node `camera_publisher`."""
    return start('camera_publisher', 'camera_to_base.nodes.camera_publisher')


def robot_base_publisher() -> int:
    """Run the node `robot_base_publisher`."""
    return start('robot_base_publisher', 'camera_to_base.nodes.robot_base_publisher')


def camera_fusion() -> int:
    """Run the node `camera_fusion`."""
    use_one_blas_thread()
    return start('camera_fusion', 'camera_to_base.nodes.camera_fusion')


def dashboard() -> int:
    """Run the node `dashboard`."""
    use_one_blas_thread()
    return start('dashboard', 'camera_to_base.dashboard.dashboard')
