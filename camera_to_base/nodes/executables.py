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
The installed executables: each is quiet if it is told to end while it still loads its node.

Loading ROS, OpenCV and numpy takes part of a second, and a launch file that starts a dying node
again and again is often stopped right then. What can be said without them is said before.
"""

import os
import signal
import sys
from typing import Optional

from camera_to_base.nodes.help import asks_for_help, help_text, plain_arguments


def camera_publisher() -> int:
    """Run the node `camera_publisher`."""
    code = _answer('camera_publisher')
    if code is not None:
        return code
    from camera_to_base.nodes.camera_publisher import main
    return main()


def robot_base_publisher() -> int:
    """Run the node `robot_base_publisher`."""
    code = _answer('robot_base_publisher')
    if code is not None:
        return code
    from camera_to_base.nodes.robot_base_publisher import main
    return main()


def _answer(node: str) -> Optional[int]:
    _end_quietly()
    name, arguments = os.path.basename(sys.argv[0]), sys.argv[1:]
    if asks_for_help(arguments):
        print(help_text(node, name), end='')
        return 0
    # rclpy ignores them, and a `-p source:=0` without --ros-args would publish random pixels.
    plain = plain_arguments(arguments)
    if plain:
        print(f"{name}: expected ROS arguments only, after --ros-args, got '{plain[0]}': "
              f'see {name} --help', file=sys.stderr)
        return 1
    return None


def _end_quietly() -> None:
    # There is nothing to clean up yet; the node sets handlers of its own.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(0))
