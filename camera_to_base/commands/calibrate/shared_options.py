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

"""Options that several commands of `calibrate` have."""

import argparse


def add_base_z(command: argparse.ArgumentParser) -> None:
    """Add the option that says how the base frame's z points."""
    command.add_argument('--base-z', choices=('up', 'down'), default='up',
                         help="direction of the base frame's z at the table: up, away from it, or "
                              'down, as for a hanging robot (default: %(default)s)')


def add_robot_topic(command: argparse.ArgumentParser, purpose: str) -> None:
    """Add the option that names the robot's topic."""
    command.add_argument('--robot-topic', metavar='TOPIC',
                         help=f"take the robot's position for {purpose} from "
                              'geometry_msgs/PoseStamped, in m, in the base frame, instead of '
                              'asking for it')


def add_image_size(command: argparse.ArgumentParser, which: str) -> None:
    """Add the option that gives a picture's size."""
    command.add_argument('--image-size', metavar='640x480',
                         help=f'width and height {which}, in px')
