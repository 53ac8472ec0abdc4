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
"""
The life of a node's process, written once: signals, arguments, start and exit codes.

The exit code is 0 after a signal or at the end of a recording. It is 1 if the node cannot start
for a reason that the user can fix; one sentence says which. It is 70 after a defect, whose
traceback is printed. The launch file restarts a node after 70, but not after 1.
"""

from contextlib import contextmanager
from importlib import import_module
import os
import signal
import sys
import traceback
from typing import Any, Callable, Iterator, List, Optional

from camera_to_base.errors import CameraToBaseError
from camera_to_base.interrupt import serve_signals
from camera_to_base.nodes.help import asks_for_help, help_text, plain_arguments

CANNOT_START, DEFECT = 1, os.EX_SOFTWARE
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


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


def run(name: str, make_node: Callable[[], Any], args: Optional[List[str]] = None) -> int:
    """
    Spin a node until a signal arrives or the node shuts its context down.

    :param name: The logger's name for errors before the node exists.
    :param make_node: The node's class; the node must have a heartbeat.
    :param args: Command-line arguments; by default those of the process.
    :returns: The process's exit code.
    """
    import rclpy
    from rclpy.executors import ExternalShutdownException
    node = None
    try:
        # rclpy's own signal handler has two faults. It shuts the context down during a callback,
        # whose next publish then fails. And if SIGTERM arrives just before the executor waits, the
        # executor keeps waiting (rclpy 7.1: about 1 in 20). A KeyboardInterrupt for both signals,
        # together with the node's heartbeat, avoids both. SIGINT must be set, too: a shell starts
        # background processes with SIGINT ignored.
        for number in _SIGNALS:
            signal.signal(number, signal.default_int_handler)
        node = _make(name, make_node, args)
        if node is None:
            return CANNOT_START
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        traceback.print_exc()
        return DEFECT
    finally:
        # For one Ctrl-C, the terminal, ros2 run and ros2 launch may each send a signal.
        for number in _SIGNALS:
            signal.signal(number, signal.SIG_IGN)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0


@contextmanager
def whole_or_gone(node: Any) -> Iterator[None]:
    """Destroy a node whose constructor fails; otherwise a half-built node lingers in the graph."""
    try:
        yield
    except BaseException:
        node.destroy_node()
        raise


def _end_quietly_while_loading() -> None:
    # Nothing needs to be cleaned up yet.
    for number in _SIGNALS:
        signal.signal(number, lambda *_: os._exit(0))
    serve_signals()


def _make(name: str, make_node: Callable[[], Any], args: Optional[List[str]]) -> Any:
    import rclpy
    from rclpy.exceptions import NameValidationException, ParameterException
    from rclpy.impl.implementation_singleton import rclpy_implementation
    from rclpy.logging import get_logger
    from rclpy.signals import SignalHandlerOptions
    # Errors that rclpy raises for wrong arguments, remappings and parameter files.
    wrong_arguments = (rclpy_implementation.RCLError, rclpy_implementation.UnknownROSArgsError,
                       NameValidationException, ParameterException)
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        return make_node()
    except (CameraToBaseError, *wrong_arguments) as error:
        get_logger(name).fatal(f'cannot start: {_sentence(error, args)}')
        return None


def _sentence(error: Exception, args: Optional[List[str]]) -> str:
    from camera_to_base.parameters import argument_problem
    is_ours = isinstance(error, CameraToBaseError)
    # rcl says where its parser stopped, but not what to write.
    known = None if is_ours else argument_problem(sys.argv if args is None else args)
    # Cut off the locations in rcl's source code that follow the text.
    text = str(error).split(', at /')[0]
    cure = '; set ROS_LOG_DIR to a folder that can be written' if 'log directory' in text else ''
    return known or text + cure


def _refuse(name: str, sentence: str) -> int:
    print(f'{name}: {sentence}', file=sys.stderr)
    return CANNOT_START
