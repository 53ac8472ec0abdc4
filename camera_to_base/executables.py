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
again and again is often stopped right then.
"""

import os
import signal


def camera_publisher() -> int:
    """Run the node `camera_publisher`."""
    _end_quietly()
    from camera_to_base.camera_publisher import main
    return main()


def robot_base_publisher() -> int:
    """Run the node `robot_base_publisher`."""
    _end_quietly()
    from camera_to_base.robot_base_publisher import main
    return main()


def _end_quietly() -> None:
    # There is nothing to clean up yet; the node sets handlers of its own.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(0))
