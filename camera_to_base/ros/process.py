# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The life of a node's process, written once: signals, memory, exit codes.

The exit code is 0 after a signal or at the end of a recording. It is 1 if the node cannot start
for a reason that the user can fix; one sentence says which. It is 70 after a defect, whose
traceback is printed. The launch file restarts a node after 70, but not after 1.
"""

from contextlib import contextmanager
import ctypes
import os
import signal
import sys
import traceback
from typing import Any, Callable, Iterator, List, Optional

from camera_to_base.errors import CameraToBaseError, CANNOT_START, DEFECT
from camera_to_base.files import shared_memory_environment

# Numbers of glibc, see mallopt(3); other C libraries have no such function.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
_KEPT_BYTES, _LARGEST_FROM_HEAP_BYTES = 64 << 20, 32 << 20

_PROFILE = 'share/camera_to_base/config/fastdds/camera_node.xml'

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def keep_freed_memory() -> None:
    """
    Let the C library keep up to 64 MB of freed memory.

    Otherwise the memory of each large picture is given back to the system, and requested again for
    the next one, page by page: on one machine that was three quarters of the time that receiving a
    picture took.
    """
    mallopt = getattr(ctypes.CDLL(None), 'mallopt', None)
    if mallopt is not None:
        mallopt(_MMAP_THRESHOLD, _LARGEST_FROM_HEAP_BYTES)
        mallopt(_TRIM_THRESHOLD, _KEPT_BYTES)


def use_picture_memory() -> None:
    """
    Let Fast DDS use 8 MB of shared memory for this process, unless the user has chosen a profile.

    What a killed subscriber has not read stays in the shared memory. Of the 0.5 MB that are usual,
    it can leave no gap of the size of a JPEG picture: nobody receives another picture until the
    publisher is started again (see also issue 5469 of eProsima/Fast-DDS).
    """
    profile = _installed_profile()
    if profile is not None:
        os.environ.update(shared_memory_environment(profile, os.environ))


def _installed_profile() -> Optional[str]:
    prefixes = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    paths = (os.path.join(prefix, _PROFILE) for prefix in prefixes)
    return next(filter(os.path.isfile, paths), None)


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
    node, ending = None, _Ending()
    try:
        ending.listen()
        node = _make(name, make_node, args)
        if node is None:
            return CANNOT_START
        _spin(node, ending)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        # Within rclpy's conversion of a message, an interrupt becomes a RuntimeError of pybind11.
        if not ending.is_asked_for:
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


class _Ending:
    """
    Raises KeyboardInterrupt for SIGINT and SIGTERM, and remembers that one has come.

    rclpy's own signal handler has two faults. It shuts the context down during a callback, whose
    next publish then fails. And if SIGTERM arrives just before the executor waits, the executor
    keeps waiting (rclpy 7.1: about 1 in 20). This avoids both, together with the node's heartbeat.
    """

    is_asked_for = False

    def listen(self) -> None:
        """Take the signals."""
        # SIGINT must be set, too: a shell starts background processes with SIGINT ignored.
        for number in _SIGNALS:
            signal.signal(number, self._ask)

    def _ask(self, number: int, stack: Any) -> None:
        self.is_asked_for = True
        signal.default_int_handler(number, stack)


def _spin(node: Any, ending: _Ending) -> None:
    from rclpy import get_global_executor
    executor = get_global_executor()
    try:
        executor.add_node(node)
        # As rclpy.spin, which goes on where an interrupt is lost, as within a destructor.
        while executor.context.ok() and not ending.is_asked_for:
            executor.spin_once()
    finally:
        executor.remove_node(node)


@contextmanager
def whole_or_gone(node: Any) -> Iterator[None]:
    """Destroy a node whose constructor fails; otherwise a half-built node lingers in the graph."""
    try:
        yield
    except BaseException:
        node.destroy_node()
        raise


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
