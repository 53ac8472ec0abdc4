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

"""The board session's parts as JSON."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.calibration import (
    BoardLook, Calibration, covered_shares, NINTHS, Placement, report_lines, shares_of, uncovered)
import numpy as np


def look_data(image: np.ndarray, look: BoardLook) -> Dict[str, Any]:
    """Describe what the newest picture shows."""
    height, width = image.shape[:2]
    covered = 0.0
    if look.is_found:
        covered = float(covered_shares([_outline(look.corners)], (width, height)).mean())
    return {'found': look.is_found, 'sentence': look.sentence,
            'corners': np.round(look.corners, 1).tolist(), 'covered': round(covered, 2),
            'sharp_px': None if look.edge_px is None else round(look.edge_px, 1),
            'sharpness': look.sharpness}


def placement_data(number: int, placement: Placement) -> Dict[str, Any]:
    """Describe a placement."""
    return {'number': number, 'corners': len(placement.numbers),
            'outline': np.round(placement.outline, 1).tolist(), 'doubts': placement.doubts}


def covered_data(placements: Sequence[Placement]) -> Dict[str, Any]:
    """Describe how much of the picture the placements cover."""
    shares = shares_of(placements) if placements else np.zeros((3, 3))
    return {'share': round(float(shares.mean()), 2), 'missing': uncovered(shares)}


def suggestion(placements: Sequence[Placement]) -> Optional[Dict[str, Any]]:
    """Suggest where the board is best laid next; None before the first placement."""
    if not placements:
        return None
    missing = uncovered(shares_of(placements))
    if not missing:
        return {'sentence': 'The whole picture is covered.', 'pixel': None}
    row, column = divmod(NINTHS.index(missing[0]), 3)
    height, width = placements[0].image.shape[:2]
    return {'sentence': f'Lay the board elsewhere, best {" or ".join(missing[:2])}, without '
                        'moving the camera; turn it a little.',
            'pixel': [(column + 0.5) * width / 3, (row + 0.5) * height / 3]}


def report_data(calibration: Calibration, placement_count: int) -> Dict[str, Any]:
    """Describe a fit; its pictures are named as the server serves them."""
    report = calibration.report
    return {
        'held_out_mm': report['leave_one_out_rms_mm'], 'rms_mm': report['rms_mm'],
        'largest_mm': report['max_mm'], 'points': report['points'],
        'placements': placement_count, 'covered': report['coverage'],
        'lines': [line for line in report_lines(report) if not line.startswith('warning: ')],
        'warnings': list(report['warnings']), 'error_map_mm': report['error_map_mm'],
        'pictures': [{'title': panel.title, 'url': f'/api/report/{name}.png?{report["date"]}'}
                     for name, panel in zip(PANEL_NAMES, calibration.panels)],
        'text_url': f'/api/report/board.txt?{report["date"]}'}


# Of the panels of a report picture, in their order.
PANEL_NAMES: List[str] = ['fit', 'above', 'errors']


def _outline(corners: np.ndarray) -> np.ndarray:
    import cv2
    return cv2.convexHull(corners.astype(np.float32)).reshape(-1, 2)
