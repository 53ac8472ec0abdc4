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

"""Command-line options of `locate`."""

import argparse
from typing import List, Optional

from camera_to_base.commands.parser import CommandParser
from camera_to_base.drawing import check_video_path
from camera_to_base.errors import InvalidValueError
from camera_to_base.files import refuse_existing, refuse_same_file
from camera_to_base.sources import BAG, kind_of

DESCRIPTION = """
Finds objects on a recording, without ROS, and prints their positions in the camera frame and in
the robot's base frame. The two nodes publish the same positions with the same parameter file. The
first frame, or as many as background_frames says, must show the empty surface.

  locate last_night.mp4 --params-file cell.yaml
  locate last_night.mp4 --params-file cell.yaml --csv positions.csv --annotated seen.mp4
  locate rosbag2_2026_01_31/ --topic /camera/image_raw --every 10
  locate 0 --params-file cell.yaml                           a camera, until Ctrl-C

Do not control an arm with this command: a camera's frames wait in a queue while one is processed.
The nodes always take the newest frame."""


def parse(args: Optional[List[str]]) -> argparse.Namespace:
    """
    Parse the command line.

    :raises InvalidValueError: If an option has an invalid value, or an output file exists already.
    :raises SystemExit: With code 0 after --help, with 1 if an option is unknown or missing.
    """
    options = _parser().parse_args(args)
    if options.every < 1:
        raise InvalidValueError(f'--every must be 1 or more, got {options.every}')
    if options.topic and kind_of(options.source) != BAG:
        raise InvalidValueError(f"--topic is for a bag, got '{options.source}': leave it out")
    _check_files(options)
    return options


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        prog='locate', description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('source', metavar='SOURCE',
                        help='a video file; a rosbag2 bag (its folder, a .mcap or .db3 file; '
                             'needs the library rosbags); a device (0, /dev/video0) or a '
                             "stream's URL, until Ctrl-C; or simulated, for one minute")
    parser.add_argument('--params-file', metavar='FILE',
                        help="the nodes' parameters, as `calibrate` writes them and `ros2 run` "
                             'takes them (default: their defaults)')
    parser.add_argument('--namespace', metavar='NAME',
                        help="the nodes' namespace, if the file has parameters for several")
    parser.add_argument('--topic', metavar='NAME',
                        help="a bag's topic of sensor_msgs/Image or CompressedImage "
                             '(default: the only one)')
    parser.add_argument('--every', type=int, default=1, metavar='N',
                        help='use the first frame and every Nth after it (default: all)')
    parser.add_argument('--csv', metavar='OUT.csv', help='also write the table to this file')
    parser.add_argument('--annotated', metavar='OUT.mp4',
                        help='write a video of the frames with the objects drawn on them')
    parser.add_argument('--force', action='store_true', help='overwrite files')
    return parser


def _check_files(options: argparse.Namespace) -> None:
    outputs = [path for path in (options.csv, options.annotated) if path]
    refuse_same_file([options.source, options.params_file, *outputs])
    if options.annotated:
        check_video_path(options.annotated)
    if not options.force:
        refuse_existing(outputs)
