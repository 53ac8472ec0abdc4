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

"""Command-line options of `calibrate` that are about markers."""

import argparse

from camera_to_base.commands.parser import decimal

MARKERS_EXAMPLES = """
Print the markers with calibrate sheet --markers, cut them out, and glue them flat near the corners
of the working area. Once the surface is calibrated, and before the camera is moved:

  calibrate markers --camera 0 -o cell.yaml
  calibrate base --markers cell.yaml

The running node then computes the surface anew from three or four markers wherever the camera
stands."""


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
