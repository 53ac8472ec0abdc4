# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Command-line options of `calibrate`, with its descriptions and examples."""

import argparse
import os
import re
import sys
from typing import Any, List, Optional, TextIO, Tuple

from camera_to_base.calibration import PAPERS
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import misspelt_name
from camera_to_base.shell_commands import full_command

BOLD, RED, GREEN, YELLOW = '1', '31', '32', '33'

EXAMPLES = {
    'sheet': """
Print it at 100 % (not "fit to page"), measure the ruler on it, and glue it to something flat.

  calibrate sheet -o board.pdf
  calibrate sheet --paper Letter --corners 8x5 --square-mm 28 -o board.pdf""",
    'board': """
Print a chessboard, lay it flat on the work surface, and take pictures of it.

  calibrate board --camera 0 --corners 9x6 --square-mm 25 -o cell.yaml

With a camera, the board is laid in four places, and then held above the table at four tilts, which
give the lens, the camera's height and its foot point. The camera stays where it is; the command
says where to lay the board next, and which edge to raise. Pictures work the same:

  calibrate board a.png b.png c.png d.png --tilted t1.png t2.png t3.png t4.png -o cell.yaml

The camera frame lies on the board: its origin is the first inner corner, x runs along the rows
of corners, y along the columns. The report and its picture show the result.

With the intrinsics that ROS's camera_calibration writes, flat pictures are enough:

  calibrate board picture.png --corners 9x6 --square-mm 25 --intrinsics lens.yaml -o cell.yaml""",
    'points': """
Measure the positions of points on the work surface (cm) and their pixels in the picture.
The table's columns, in any order: x_cm, y_cm, u_px, v_px (optional: width_px, height_px).

  calibrate points points.csv --image-size 640x480 -o surface.yaml""",
    'base': """
Put one object after the other on the surface, and touch it with the robot. The command asks for
each, sees it by the running camera_publisher or by the camera itself, and adds the base frame to
the file:

  calibrate base --live cell.yaml

Where another camera in the namespace /left has the base frame, lay five flat objects that both
see; nothing is touched:

  calibrate base --from /left --live right.yaml

Or note the objects' /pos_in_cam_frame and the robot's positions in a table with the columns
x_cam_cm, y_cam_cm, x_base_cm, y_base_cm (and z_cam_cm, z_base_cm, which are 0 by default).

  calibrate base pairs.csv --surface surface.yaml -o cell.yaml
  ros2 launch camera_to_base camera_to_base.launch.py params_file:=cell.yaml""",
    'check': """
Use points that the calibration was not made from, in a table as for `calibrate points`:

  calibrate check surface.yaml more_points.csv""",
    'status': """
How old each part is, how good it is, and what to do next:

  calibrate status cell.yaml

With --live it tells, too, whether the running node corrects a nudge of the camera:

  calibrate status --live cell.yaml""",
    'keep': """
A nudged camera is corrected while the node runs. This command writes the corrected surface into
the node's file, and the node uses it from then on; the old file is kept as FILE.bak. The
base frame, the markers and the areas stay.

  calibrate keep cell.yaml""",
}
DESCRIPTION = """
Calibrates a camera that looks at a work surface, and reports the errors. The output is a
parameter file for the nodes. The --help of each command has an example; the first one:

  calibrate board picture.png --corners 9x6 --square-mm 25 -o surface.yaml"""

MARKERS_EXAMPLES = """
Print the markers with calibrate sheet --markers, cut them out, and glue them flat near the corners
of the working area. Once the surface is calibrated, and before the camera is moved:

  calibrate markers --camera 0 -o cell.yaml
  calibrate base --markers cell.yaml

The running node then computes the surface anew from three or four markers wherever the camera
stands."""

_EXAMPLES = {**EXAMPLES, 'markers': MARKERS_EXAMPLES}


def styled(text: str, style: str, stream: TextIO) -> str:
    """Return a text in a style for a terminal; as it is for a pipe, or if NO_COLOR is set."""
    if os.environ.get('NO_COLOR') or os.environ.get('TERM') == 'dumb' or not stream.isatty():
        return text
    return f'\x1b[{style}m{text}\x1b[0m'


def drop_output() -> None:
    """Drop what cannot be printed; otherwise Python prints an error when it flushes at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def decimal(text: str) -> float:
    """
    Read a decimal number, with a point or a comma.

    :raises ArgumentTypeError: If it is none.
    """
    try:
        return float(text.replace(',', '.'))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"expected a number such as 25.4, got '{text}'") from None


class CommandParser(argparse.ArgumentParser):
    """Reports a wrong option in one sentence, like any other wrong input, and exits with 1."""

    def error(self, message: str) -> None:
        """Exit with the sentence."""
        command, *subcommand = self.prog.split()
        self.exit(1, f'{command}: {message}: see {full_command(command, *subcommand, "--help")}\n')

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        # argparse's own sentence has no suggestion.
        if action.choices is not None and value not in action.choices:
            near = misspelt_name(str(value), list(map(str, action.choices)))
            cure = f'did you mean {near}?' if near else f'choose {" or ".join(action.choices)}'
            name = None if action.dest == 'command' else action
            raise argparse.ArgumentError(name, f"there is no '{value}', {cure}")


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


def add_markers(markers: argparse.ArgumentParser) -> None:
    """Add the options of `calibrate markers`."""
    markers.add_argument('pictures', nargs='*', metavar='PICTURE',
                         help='of the markers, all taken by the camera in one place')
    markers.add_argument('--camera', metavar='SOURCE',
                         help="instead of pictures: a device, a video, a stream's URL, or "
                              'simulated (default: the source that FILE names)')
    markers.add_argument('--marker-mm', type=decimal, metavar='40',
                         help='edge of the black square as printed: measure it')
    markers.add_argument('-o', '--output', required=True, metavar='FILE',
                         help='the parameter file with the surface, to which the markers are '
                              'added')
    markers.add_argument('--force', action='store_true', help='replace what is in the file')


def add_sheet_markers(sheet: argparse.ArgumentParser) -> None:
    """Add the options of `calibrate sheet` for markers."""
    sheet.add_argument('--markers', action='store_true',
                       help='instead of a chessboard: four markers that stay on the table, with '
                            'cut lines')
    sheet.add_argument('--marker-mm', type=decimal, default=40.0, metavar='40',
                       help="edge of a marker's black square (default: %(default)g)")


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
    commands = parser.add_subparsers(
        dest='command', required=True, parser_class=CommandParser,
        metavar='sheet | board | markers | points | base | check | status | keep')
    _add_sheet(_command(commands, 'sheet', 'a chessboard to print'))
    _add_board(_command(commands, 'board',
                        'the surface, from one picture of a chessboard that lies on it'))
    add_markers(_command(commands, 'markers',
                         'where markers lie on the surface, from pictures of them'))
    points = _command(commands, 'points', 'the surface, from a table of points')
    points.add_argument('table', metavar='TABLE.csv')
    points.add_argument('--model', choices=('homography', 'polynomial'), default='homography',
                        help="homography, or the tutorial's two quadratics (default: %(default)s)")
    add_image_size(points, 'of the picture that the points were measured in')
    _add_output(points)
    _add_base(_command(commands, 'base',
                       'the pose of the camera frame in the base frame, from pairs of points'))
    check = _command(commands, 'check', 'the error of a calibration on other points')
    check.add_argument('file', metavar='FILE', help='from calibrate board or calibrate points')
    check.add_argument('table', metavar='TABLE.csv')
    status = _command(commands, 'status', 'what a parameter file holds, and what it lacks')
    status.add_argument('file', metavar='FILE')
    status.add_argument('--live', action='store_true',
                        help='tell, too, whether the running camera_publisher corrects a nudge of '
                             'the camera, which can be kept')
    _add_namespace(status)
    keep = _command(commands, 'keep', 'the correction that the running camera_publisher makes')
    keep.add_argument('file', metavar='FILE', help='the file that the node was started with')
    _add_namespace(keep)
    return parser


def _command(commands: Any, name: str, purpose: str) -> argparse.ArgumentParser:
    does = {'sheet': 'Draws', 'markers': 'Learns', 'check': 'Tells', 'status': 'Tells',
            'keep': 'Keeps'}.get(
        name, 'Calibrates')
    command = commands.add_parser(
        name, help=purpose, description=f'{does} {purpose}.\n{_EXAMPLES[name]}',
        formatter_class=argparse.RawDescriptionHelpFormatter)
    command.add_argument('--json', action='store_true',
                         help='print the report as one JSON object')
    command.add_argument('--verbose', action='store_true',
                         help='print the expected errors all over the picture, too')
    return command


def _add_namespace(command: argparse.ArgumentParser) -> None:
    command.add_argument('--namespace', default='', metavar='NS',
                         help='namespace of the running camera_publisher (default: none)')


def _add_sheet(sheet: argparse.ArgumentParser) -> None:
    sheet.add_argument('--paper', type=_paper, choices=tuple(PAPERS), default='A4',
                       help='(default: %(default)s)')
    sheet.add_argument('--corners', default='9x6', metavar='9x6',
                       help='inner corners along a row and along a column; one even and one odd '
                            'give the board one origin (default: %(default)s)')
    sheet.add_argument('--square-mm', type=decimal, default=25.0, metavar='25',
                       help="a square's edge (default: %(default)g)")
    sheet.add_argument('--charuco', action='store_true',
                       help='with markers in the white squares: a part of the board is enough')
    add_sheet_markers(sheet)
    sheet.add_argument('-o', '--output', required=True, metavar='FILE',
                       help='the file to write: .pdf, .svg or .png')
    sheet.add_argument('--force', action='store_true', help='overwrite a file')


def _add_board(board: argparse.ArgumentParser) -> None:
    board.add_argument('pictures', nargs='*', metavar='PICTURE',
                       help='several show the board in several places, taken by the camera in one '
                            'place; the first one defines the camera frame')
    board.add_argument('--camera', metavar='SOURCE',
                       help="instead of a picture: a device, a video, a stream's URL, or "
                            'simulated; the median of several frames')
    board.add_argument('--image-topic', metavar='TOPIC',
                       help="instead of a picture: a driver's topic, such as /camera/image_raw; "
                            'with a lens in its camera_info, flat placements are enough')
    board.add_argument('--tilted', nargs='+', default=[], metavar='PICTURE',
                       help='pictures of the same board, held above the table at a tilt: they '
                            "give the lens, the camera's height and the foot point")
    board.add_argument('--placements', type=int, metavar='N',
                       help='number of places that the board is laid in, with --camera; it asks '
                            'for each, and says where to (default: 4)')
    board.add_argument('--tilted-placements', type=int, metavar='N',
                       help='number of pictures with the board held at a tilt, with --camera; '
                            'each is taken when the board is still (default: 4; 0 with '
                            '--placements or --intrinsics)')
    board.add_argument('--corners', default='9x6', metavar='9x6',
                       help='number of inner corners, where four squares meet, along a row and '
                            'along a column: one less than the squares (default: %(default)s)')
    board.add_argument('--square-mm', type=decimal, default=25.0, metavar='25',
                       help="a square's edge as printed: measure it (default: %(default)g, as "
                            'calibrate sheet prints it)')
    board.add_argument('--charuco', action='store_true',
                       help='the board has markers, as calibrate sheet --charuco prints it; it '
                            "may be partly covered, or cut off by the picture's edge")
    board.add_argument('--origin-corner', type=int, default=0, metavar='0..3',
                       help='which of the four outermost corners is the origin, clockwise from '
                            'the first (default: %(default)s)')
    board.add_argument('--origin-mm', type=decimal, nargs=2, default=(0.0, 0.0),
                       metavar=('X', 'Y'),
                       help='move the origin along the board from that corner')
    board.add_argument('--yaw-deg', type=decimal, default=0.0, metavar='DEG',
                       help="turn the camera frame from the board's x towards its y")
    board.add_argument('--intrinsics', metavar='CAMERA_INFO.yaml',
                       help="the lens as ROS's camera_calibration writes it: then flat pictures "
                            "are enough for the camera's height and foot point")
    add_image_size(board, 'requested from --camera')
    board.add_argument('--simulated-tilt-deg', type=decimal, default=0.0, metavar='DEG',
                       help='tilt of --camera simulated (default: %(default)s)')
    _add_output(board)


def _add_base(base: argparse.ArgumentParser) -> None:
    base.add_argument('table', nargs='?', metavar='PAIRS.csv')
    base.add_argument('--live', nargs='?', const='', metavar='FILE',
                      help='instead of a table: ask for one object after the other, with the '
                           'surface in FILE, and add the base frame to it. Positions come from '
                           'the running camera_publisher, or from the camera that FILE names')
    base.add_argument('--places', type=int, default=5, metavar='5',
                      help='number of objects for --live (default: %(default)s)')
    base.add_argument('--from', dest='other', metavar='NAMESPACE',
                      help='for --live: nothing is touched; a running camera in this namespace, '
                           'which has its base frame, sees the same flat objects')
    base.add_argument('--camera', metavar='SOURCE', help='camera for --live, whatever runs')
    base.add_argument('--markers', metavar='FILE',
                      help='instead of a table: the robot touches the middle of each marker that '
                           'FILE knows; no object and no camera is needed')
    add_robot_topic(base, '--live and --markers')
    base.add_argument('--namespace', metavar='NAMESPACE',
                      help='namespace of the running camera_publisher, for --live')
    base.add_argument('--surface', metavar='FILE',
                      help='a parameter file whose parameters and comments are copied into the '
                           'output, so that one file serves both nodes; the pairs are checked '
                           'against it')
    add_base_z(base)
    base.add_argument('-o', '--output', metavar='FILE',
                      help='the parameter file to write (with --live and --markers: that file)')
    base.add_argument('--force', action='store_true', help='overwrite files')


def _add_output(command: argparse.ArgumentParser) -> None:
    command.add_argument('-o', '--output', required=True, metavar='FILE',
                         help='the parameter file to write')
    command.add_argument('--force', action='store_true', help='overwrite files')
    command.add_argument('--picture', metavar='REPORT.png',
                         help='the report picture to write (default: FILE_report.png)')


def _paper(text: str) -> str:
    return {name.lower(): name for name in PAPERS}.get(text.lower(), text)


def _two_counts(name: str, text: str) -> Tuple[int, int]:
    match = re.fullmatch(r'(\d{1,5})[xX](\d{1,5})', text)
    if match is None:
        raise InvalidValueError(f"{name} must be two counts as in 9x6, got '{text}'")
    return int(match[1]), int(match[2])
