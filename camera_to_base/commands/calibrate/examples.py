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

"""Descriptions and examples in the --help of `calibrate`."""

EXAMPLES = {
    'sheet': """
Print it at 100 % (not "fit to page"), measure the ruler on it, and glue it to something flat.

  calibrate sheet -o board.pdf
  calibrate sheet --paper Letter --corners 8x5 --square-mm 28 -o board.pdf""",
    'board': """
Print a chessboard, lay it flat on the work surface, and take one picture of it.

  calibrate board --camera 0 --corners 9x6 --square-mm 25 -o cell.yaml
  calibrate board picture.png --corners 9x6 --square-mm 25 -o cell.yaml

A board that covers only a part of the table is laid in several places, the camera stays where it
is. The command says where to lay it next:

  calibrate board --camera 0 --placements 4 -o cell.yaml

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
Put one object after the other on the surface, and touch it with the robot. The command asks for
each, sees it by the running camera_publisher or by the camera itself, and adds the base frame to
the file:

  calibrate base --live cell.yaml

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
the node's file, and the node uses it from then on; the file of before is kept as FILE.bak. The
base frame, the markers and the areas stay.

  calibrate keep cell.yaml""",
}
DESCRIPTION = """
Calibrates a camera that looks at a work surface, and reports the errors. The output is a
parameter file for the nodes. The --help of each command has an example; the first one:

  calibrate board picture.png --corners 9x6 --square-mm 25 -o surface.yaml"""
