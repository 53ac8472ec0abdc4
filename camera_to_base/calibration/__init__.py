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
Calibration: from measured points to parameters and a report.

In: pictures of a chessboard, tables of points, or pairs of points in both frames. Out: the values
of `surface.*` or of the transform, their errors in mm, and a picture of them. Rooms within:
`boards`, `markers`, `fits`, `checks` and `touches`.

Callers: `commands` and `dashboard`. The nodes do not import it.
"""

from camera_to_base.calibration.base_calibration import calibrate_base
from camera_to_base.calibration.board_calibration import calibrate_placements
from camera_to_base.calibration.boards.board_look import BoardLook, look_for
from camera_to_base.calibration.boards.marker_sheet import marker_sheet_content
from camera_to_base.calibration.boards.placement import (
    make_placement, Placement, refuse_unlike, renumbered, shares_of)
from camera_to_base.calibration.boards.printed_board import PrintedBoard
from camera_to_base.calibration.boards.sheet import has_one_origin, PAPERS, sheet_content
from camera_to_base.calibration.camera_info import read_camera_info
from camera_to_base.calibration.cell_file import (
    BASE, cell_text, grown, MARKERS, part_values, parts_of, parts_to_lose, SURFACE, TITLE)
from camera_to_base.calibration.coverage_map import (
    covered_shares, map_lines, NINTHS, uncovered)
from camera_to_base.calibration.fits.rigid_fit import pair_figures, PairFigures
from camera_to_base.calibration.kept_correction import corrected_file_text, OfferedCorrection
from camera_to_base.calibration.markers.learning import learned_markers
from camera_to_base.calibration.report_text import Report, report_lines
from camera_to_base.calibration.result import Calibration
from camera_to_base.calibration.status import file_status, next_step, report_of, without_report
from camera_to_base.calibration.surface_calibration import (
    add_camera_pose, calibrate_surface, check_surface)
from camera_to_base.calibration.tables import read_pairs, read_points, refuse_other_size
from camera_to_base.calibration.touches.touch_plan import (
    read_typed_position, suggested_places, Suggestion)
from camera_to_base.calibration.touches.touched_pairs import (
    calibrate_touches, pairs_text, point_pairs, read_kept_pairs, same_touch, TouchedPair)
from camera_to_base.calibration.touches.touched_place import FRAMES, measured_place, Place

__all__ = [
    'add_camera_pose', 'BASE', 'BoardLook', 'calibrate_base', 'calibrate_placements',
    'calibrate_surface', 'calibrate_touches', 'Calibration',
    'cell_text', 'check_surface', 'corrected_file_text', 'covered_shares', 'file_status', 'FRAMES',
    'grown', 'has_one_origin', 'learned_markers', 'look_for', 'make_placement', 'map_lines',
    'marker_sheet_content', 'MARKERS', 'measured_place', 'next_step', 'NINTHS',
    'OfferedCorrection', 'pair_figures', 'PairFigures', 'pairs_text', 'PAPERS', 'part_values',
    'parts_of', 'parts_to_lose', 'Place', 'Placement', 'point_pairs', 'PrintedBoard',
    'read_camera_info', 'read_kept_pairs', 'read_pairs', 'read_points', 'read_typed_position',
    'refuse_other_size', 'refuse_unlike', 'renumbered', 'Report', 'report_lines', 'report_of',
    'same_touch', 'shares_of', 'sheet_content', 'suggested_places', 'Suggestion', 'SURFACE',
    'TITLE', 'TouchedPair', 'uncovered', 'without_report',
]
