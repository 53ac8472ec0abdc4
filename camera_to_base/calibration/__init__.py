# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Calibration: from measured points to parameters and a report.

In: pictures of a chessboard, tables of points, or pairs of points in both frames. Out: the values
of `surface.*` or of the transform, their errors in mm, and a picture of them. The room
`boards` within finds and draws what is printed.

Callers: `commands` and `dashboard`. The nodes do not import it.
"""

from camera_to_base.calibration.base import (
    calibrate_base, calibrate_touches, FRAMES, measured_place, pairs_text, Place, point_pairs,
    read_kept_pairs, read_typed_position, same_touch, suggested_places, Suggestion, TouchedPair)
from camera_to_base.calibration.board_tilt import (
    held_tilt, HeldTilt, missing_side, rough_surface, tilt_suggestion, tilt_trouble)
from camera_to_base.calibration.boards.placement import (
    BoardLook, covered_shares, look_for, make_placement, map_lines, NINTHS, Placement,
    PrintedBoard, refuse_unlike, renumbered, shares_of, uncovered)
from camera_to_base.calibration.boards.sheets import (
    has_one_origin, marker_sheet_content, PAPERS, sheet_content)
from camera_to_base.calibration.cell_file import (
    BASE, camera_fields, cell_text, corrected_file_text, file_status, grown, MARKERS, next_step,
    OfferedCorrection, part_values, parts_of, parts_to_lose, report_of, SURFACE, TITLE,
    without_report)
from camera_to_base.calibration.common_objects import (
    resting_places, shared_places, SharedPlace)
from camera_to_base.calibration.marker_learning import learned_markers
from camera_to_base.calibration.report import Report, report_lines
from camera_to_base.calibration.result import Calibration
from camera_to_base.calibration.rigid_fit import pair_figures, PairFigures
from camera_to_base.calibration.surface import (
    calibrate_placements, calibrate_surface, check_surface)
from camera_to_base.calibration.tables import (
    lens_of_camera_info, read_camera_info, read_pairs, read_points, refuse_other_size)

__all__ = [
    'BASE', 'BoardLook', 'calibrate_base', 'calibrate_placements', 'calibrate_surface',
    'calibrate_touches', 'Calibration', 'camera_fields', 'cell_text', 'check_surface',
    'corrected_file_text', 'covered_shares', 'file_status', 'FRAMES', 'grown',
    'has_one_origin', 'held_tilt', 'HeldTilt', 'learned_markers', 'lens_of_camera_info',
    'look_for', 'make_placement', 'map_lines', 'marker_sheet_content', 'MARKERS',
    'measured_place', 'missing_side', 'next_step', 'NINTHS', 'OfferedCorrection',
    'pair_figures', 'PairFigures', 'pairs_text', 'PAPERS', 'part_values', 'parts_of',
    'parts_to_lose', 'Place', 'Placement', 'point_pairs', 'PrintedBoard', 'read_camera_info',
    'read_kept_pairs', 'read_pairs', 'read_points', 'read_typed_position', 'refuse_other_size',
    'refuse_unlike', 'renumbered', 'Report', 'report_lines', 'report_of', 'resting_places',
    'rough_surface', 'same_touch', 'shared_places', 'SharedPlace', 'shares_of',
    'sheet_content', 'suggested_places', 'Suggestion', 'SURFACE', 'tilt_suggestion',
    'tilt_trouble', 'TITLE', 'TouchedPair', 'uncovered', 'without_report',
]
