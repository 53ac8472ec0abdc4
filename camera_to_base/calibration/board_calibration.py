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

"""Calibrates the surface from the placements of a board."""

from dataclasses import replace
from typing import Optional, Sequence

from camera_to_base.calibration.boards.placement import outer_edge, Placement, shares_of
from camera_to_base.calibration.boards.printed_board import PrintedBoard
from camera_to_base.calibration.coverage_map import map_lines, uncovered
from camera_to_base.calibration.markers.learning import with_markers
from camera_to_base.calibration.result import Calibration
from camera_to_base.calibration.surface_calibration import add_camera_pose, calibrate_surface
from camera_to_base.surface import CameraIntrinsics
from camera_to_base.trust import view_thumbnail


def calibrate_placements(
    board: PrintedBoard, placements: Sequence[Placement],
    intrinsics: Optional[CameraIntrinsics] = None,
) -> Calibration:
    """
    Fit the surface to all placements of a board, which lies on it in each.

    The values hold a thumbnail of the surface, and markers that lie beside the board, too.

    :param placements: The first one defines the camera frame.
    :param intrinsics: The lens; it gives the camera's height. None if it is not known.
    :raises CalibrationError: If the placements do not fit each other.
    """
    first, *further = placements
    height, width = first.image.shape[:2]
    columns, rows = board.corners
    names = ', '.join(dict.fromkeys(one.name for one in placements))
    calibration = calibrate_surface(
        first.matched, (width, height), image=first.image,
        lattice=board.first_points().reshape(rows, columns, 2), points_are='corner',
        further=[placement.matched for placement in further],
        source=f'{board.text}, in {names}'
               + (f', in {len(placements)} places' if further else ''))
    if intrinsics is not None:
        calibration = add_camera_pose(calibration, first.matched, intrinsics)
    report = calibration.report
    report['warnings'] += [doubt for placement in placements for doubt in placement.doubts]
    report['covered_map'] = map_lines(shares_of(placements))
    report['not_covered'] = uncovered(shares_of(placements))
    thumbnail = view_thumbnail(first.image, [outer_edge(first)])
    return with_markers(replace(
        calibration, values={'calibration.thumbnail': thumbnail, **calibration.values}),
        first.image)
