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


"""Command-line options of `calibrate`."""

import argparse
import re
from typing import Any, List, Optional, Tuple

from camera_to_base.calibration import PAPERS
from camera_to_base.commands.parser import CommandParser
from camera_to_base.errors import InvalidValueError

EXAMPLES = {
    'sheet': """
Print it at 100 % (not "fit to page"), measure the ruler on it, and glue it to something flat.

  calibrate sheet -o board.pdf
  calibrate sheet --paper Letter --corners 8x5 --square-mm 28 -o board.pdf""",
    'board': """
Print a chessboard, lay it flat on the work surface, and take one picture of it.

  calibrate board picture.png --corners 9x6 --square-mm 25 -o surface.yaml
  calibrate board --camera 0 --corners 9x6 --square-mm 25 -o surface.yaml

The camera frame lies on the board: its origin is the first inner corner, x runs along the rows
of corners, y along the columns. The report and its picture show the result.

Objects that are not flat need the camera's height, too. It is computed from the intrinsics that
ROS's camera_calibration writes:

  calibrate board picture.png --corners 9x6 --square-mm 25 --intrinsics lens.yaml -o cell.yaml""",
    'points': """
Measure the positions of points on the work surface (cm) and their pixels in the picture.
The table's columns, in any order: x_cm, y_cm, u_px, v_px (optional: width_px, height_px).

  calibrate points points.csv --image-size 640x480 -o surface.yaml""",
    'base': """
Put objects on the surface, note their /pos_in_cam_frame, and touch them with the robot.
The table's columns, in any order: x_cam_cm, y_cam_cm, x_base_cm, y_base_cm (and z_cam_cm,
z_base_cm, which are 0 by default).

  calibrate base pairs.csv --surface surface.yaml -o cell.yaml
  ros2 launch camera_to_base camera_to_base.launch.py params_file:=cell.yaml""",
    'check': """
Use points that the calibration was not made from, in a table as for `calibrate points`:

  calibrate check surface.yaml more_points.csv""",
    'status': """
How old each part is, how good it is, and what to do next:

  calibrate status cell.yaml""",
}
DESCRIPTION = """
Calibrates a camera that looks at a work surface, and reports the errors. The output is a
parameter file for the nodes. The --help of each command has an example; the first one:

  calibrate board picture.png --corners 9x6 --square-mm 25 -o surface.yaml"""


def parse(args: Optional[List[str]]) -> argparse.Namespace:
    """
    Parse the command line; `command` is the subcommand's name.

    :raises InvalidValueError: If an option has an invalid value.
    :raises SystemExit: With code 0 after --help, with 1 if an option is unknown or missing.
    """
    options = _parser().parse_args(args)
    for name in ('corners', 'image_size'):
        text = getattr(options, name, None)
        if text is not None:
            setattr(options, name, _two_counts('--' + name.replace('_', '-'), text))
    return options


def _parser() -> argparse.ArgumentParser:
    parser = CommandParser(
        prog='calibrate', description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest='command', required=True, parser_class=CommandParser,
                                     metavar='sheet | board | points | base | check | status')
    _add_sheet(_command(commands, 'sheet', 'a chessboard to print'))
    _add_board(_command(commands, 'board',
                        'the surface, from one picture of a chessboard that lies on it'))
    points = _command(commands, 'points', 'the surface, from a table of points')
    points.add_argument('table', metavar='TABLE.csv')
    points.add_argument('--model', choices=('homography', 'polynomial'), default='homography',
                        help="homography, or the tutorial's two quadratics (default: %(default)s)")
    _add_image_size(points, 'of the picture that the points were measured in')
    _add_output(points, with_picture=True)
    base = _command(commands, 'base',
                    'the pose of the camera frame in the base frame, from pairs of points')
    base.add_argument('table', metavar='PAIRS.csv')
    base.add_argument('--surface', metavar='FILE',
                      help='a parameter file whose parameters and comments are copied into the '
                           'output, so that one file serves both nodes; the pairs are checked '
                           'against it')
    base.add_argument('--base-z', choices=('up', 'down'), default='up',
                      help="direction of the base frame's z at the table: up, away from it, or "
                      'down, as for a hanging robot (default: %(default)s)')
    _add_output(base, with_picture=False)
    check = _command(commands, 'check', 'the error of a calibration on other points')
    check.add_argument('file', metavar='FILE', help='from calibrate board or calibrate points')
    check.add_argument('table', metavar='TABLE.csv')
    status = _command(commands, 'status', 'what a parameter file holds, and what it lacks')
    status.add_argument('file', metavar='FILE')
    return parser


def _command(commands: Any, name: str, purpose: str) -> argparse.ArgumentParser:
    does = {'sheet': 'Draws', 'check': 'Tells', 'status': 'Tells'}.get(name, 'Calibrates')
    command = commands.add_parser(
        name, help=purpose, description=f'{does} {purpose}.\n{EXAMPLES[name]}',
        formatter_class=argparse.RawDescriptionHelpFormatter)
    command.add_argument('--json', action='store_true',
                         help='print the report as one JSON object')
    return command


def _add_sheet(sheet: argparse.ArgumentParser) -> None:
    sheet.add_argument('--paper', choices=tuple(PAPERS), default='A4',
                       help='(default: %(default)s)')
    sheet.add_argument('--corners', default='9x6', metavar='9x6',
                       help='inner corners along a row and along a column; one even and one odd '
                            'give the board one origin (default: %(default)s)')
    sheet.add_argument('--square-mm', type=float, default=25.0, metavar='25',
                       help="a square's edge (default: %(default)g)")
    sheet.add_argument('-o', '--output', required=True, metavar='FILE',
                       help='the file to write: .pdf, .svg or .png')
    sheet.add_argument('--force', action='store_true', help='overwrite a file')


def _add_board(board: argparse.ArgumentParser) -> None:
    source = board.add_mutually_exclusive_group(required=True)
    source.add_argument('picture_file', nargs='?', metavar='PICTURE')
    source.add_argument('--camera', metavar='SOURCE',
                        help="instead of a picture: a device, a video, a stream's URL, or "
                             'simulated; the median of several frames')
    board.add_argument('--corners', required=True, metavar='9x6',
                       help='number of inner corners, where four squares meet, along a row and '
                       'along a column: one less than the squares')
    board.add_argument('--square-mm', type=float, required=True, metavar='25',
                       help="a square's edge as printed: measure it")
    board.add_argument('--origin-corner', type=int, default=0, metavar='0..3',
                       help='which of the four outermost corners is the origin, clockwise from '
                            'the first (default: %(default)s)')
    board.add_argument('--origin-mm', type=float, nargs=2, default=(0.0, 0.0), metavar=('X', 'Y'),
                       help='move the origin along the board from that corner')
    board.add_argument('--yaw-deg', type=float, default=0.0, metavar='DEG',
                       help="turn the camera frame from the board's x towards its y")
    board.add_argument('--intrinsics', metavar='CAMERA_INFO.yaml',
                       help="the lens as ROS's camera_calibration writes it: gives the camera's "
                       'height and foot point, which object_height_cm needs')
    _add_image_size(board, 'requested from --camera')
    board.add_argument('--simulated-tilt-deg', type=float, default=0.0, metavar='DEG',
                       help='tilt of --camera simulated (default: %(default)s)')
    _add_output(board, with_picture=True)


def _add_image_size(command: argparse.ArgumentParser, which: str) -> None:
    command.add_argument('--image-size', metavar='640x480',
                         help=f'width and height {which}, in px')


def _add_output(command: argparse.ArgumentParser, *, with_picture: bool) -> None:
    command.add_argument('-o', '--output', required=True, metavar='FILE',
                         help='the parameter file to write')
    command.add_argument('--force', action='store_true', help='overwrite files')
    if with_picture:
        command.add_argument('--picture', metavar='REPORT.png',
                             help='the report picture to write (default: FILE_report.png)')


def _two_counts(name: str, text: str) -> Tuple[int, int]:
    match = re.fullmatch(r'(\d{1,5})[xX](\d{1,5})', text)
    if match is None:
        raise InvalidValueError(f"{name} must be two counts as in 9x6, got '{text}'")
    return int(match[1]), int(match[2])
