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
"""The installed executables of the nodes."""

from camera_to_base.nodes.process import start


def camera_publisher() -> int:
    """Run the node `camera_publisher`."""
    return start('camera_publisher', 'camera_to_base.nodes.camera_publisher')


def robot_base_publisher() -> int:
    """Run the node `robot_base_publisher`."""
    return start('robot_base_publisher', 'camera_to_base.nodes.robot_base_publisher')
