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

"""The life of a node's process: from its arguments to its exit code, without a traceback."""

from contextlib import contextmanager
import os
import signal
import traceback
from typing import Callable, Iterator, List, Optional

from camera_to_base.errors import CameraToBaseError
import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions


@contextmanager
def whole_or_gone(node: Node) -> Iterator[None]:
    """Destroy a node if what makes it fails: half of it would be seen by others, and for long."""
    try:
        yield
    except BaseException:
        node.destroy_node()
        raise


def run(name: str, make_node: Callable[[], Node], args: Optional[List[str]] = None) -> int:
    """
    Spin a node until it is told to end or shuts its context down.

    :param name: What an error is logged as before there is a node.
    :param make_node: The node's class; its node has a heartbeat.
    :param args: Command-line arguments; those of the process where none are given.
    :returns: The process's exit code: 0, 1 if the node could not start, or 70 if it failed later.
    """
    node = None
    try:
        # rclpy's own handler shuts the context down under a running callback, whose next publish
        # then fails; and a SIGTERM just before the executor waits leaves it waiting (rclpy 7.1:
        # about 1 in 20). A KeyboardInterrupt for both signals and the node's heartbeat do neither.
        # SIGINT is set, too: a shell starts what runs in its background with SIGINT ignored.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        node = _start(name, make_node, args)
        if node is None:
            return 1
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        # Python's own exit code would be 1: the launch file would not start the node again.
        traceback.print_exc()
        return os.EX_SOFTWARE
    finally:
        # A terminal, ros2 run and ros2 launch may each send a signal for one Ctrl-C.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0


def _start(name: str, make_node: Callable[[], Node], args: Optional[List[str]]) -> Optional[Node]:
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        return make_node()
    except (CameraToBaseError, ParameterException, RuntimeError, ValueError) as error:
        # Where rclpy refuses arguments or a parameter file, the places in rcl's source code at
        # the end of its text say nothing to a user.
        get_logger(name).fatal(f"cannot start: {str(error).split(', at /')[0]}")
        return None
