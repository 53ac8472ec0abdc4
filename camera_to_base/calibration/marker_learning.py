# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Learns where the corners of markers lie on a calibrated surface."""

from dataclasses import replace
from typing import Any, Dict, List, Mapping, Optional, Sequence

from camera_to_base.calibration.figures import MM_PER_CM
from camera_to_base.calibration.result import Calibration, origin_fields
from camera_to_base.errors import CalibrationError, CameraToBaseError
from camera_to_base.markers import (
    Corners, has_markers, LEAST_MARKERS, lens_of_values, marker_surface, marker_values,
    refuse_polynomial, see_markers, TABLE_MARKERS)
from camera_to_base.parameters import checked_values
from camera_to_base.surface import Hull, make_hull, on_one_line, SURFACE_SPECS
import numpy as np

# Of the frames, a marker is seen in this share.
_LEAST_SHARE = 0.7
# Markers at rest are seen to 0.02 to 0.1 px from frame to frame.
_LARGEST_SPREAD_PX = 0.5
# On a calibrated surface, markers of one print have the same size to this share.
_SIZE_TOLERANCE = 0.03


def learned_markers(
    frames: Sequence[Corners], values: Mapping[str, Any], *, source: str,
    marker_mm: Optional[float] = None,
) -> Calibration:
    """
    Learn the markers' corners.

    :param frames: For each frame the markers in it: by number, shape (4, 2), in px.
    :param values: The parameters of the surface, by full name.
    :param source: The frames' origin, for the report.
    :param marker_mm: Edge of a marker as printed; None for not known.
    :raises CalibrationError: If there are too few markers, they move, or lie in one line.
    """
    refuse_polynomial(values)
    surface = marker_surface(values)
    steady = steady_corners(frames)
    corners = {number: surface.locate(pixels) for number, pixels in steady.items()}
    edges_mm = {number: _edge_mm(found) for number, found in corners.items()}
    report = {**origin_fields('markers', source),
              'markers': [[number, *(corners[number].mean(axis=0).round(3) + 0.0).tolist(),
                           round(edges_mm[number], 2)] for number in sorted(corners)],
              'warnings': [*_doubts(edges_mm, marker_mm), *_outside(steady, make_hull(values))]}
    return Calibration(report, marker_values(corners))


def with_markers(calibration: Calibration, image: np.ndarray) -> Calibration:
    """
    Add the markers that a board's picture shows; nothing where there are too few.

    :param calibration: A surface's calibration.
    :param image: Shape (h, w, 3), uint8, BGR, the picture it was made from.
    """
    if not has_markers():
        return calibration
    values = checked_values(SURFACE_SPECS, calibration.values)
    try:
        seen = see_markers(image, lens_of_values(values)).corners
        learned = learned_markers([seen], values, source='the picture of the board')
    except CameraToBaseError:
        return calibration
    report = {**calibration.report, 'markers': learned.report['markers'], 'warnings': [
        *calibration.report['warnings'], *learned.report['warnings']]}
    return replace(calibration, report=report, values={**calibration.values, **learned.values})


def steady_corners(frames: Sequence[Corners]) -> Corners:
    """
    Take the mean of the corners in several frames.

    :raises CalibrationError: If there are too few markers, they move, or lie in one line.
    """
    seen = sorted({number for frame in frames for number in frame})
    found: Dict[int, np.ndarray] = {}
    for number in seen:
        shown = np.array([frame[number] for frame in frames if number in frame])
        if len(shown) < _LEAST_SHARE * len(frames):
            continue
        spread = float(shown.std(axis=0).max())
        if spread > _LARGEST_SPREAD_PX:
            raise CalibrationError(
                f'marker {number} moves by {spread:.1f} px from frame to frame: keep camera and '
                'markers still')
        found[number] = shown.mean(axis=0)
    if len(found) < LEAST_MARKERS:
        raise CalibrationError(
            f'{len(found)} of the markers {TABLE_MARKERS[0]} to {TABLE_MARKERS[-1]} are seen'
            + (f' ({", ".join(map(str, found))})' if found else '')
            + f', at least {LEAST_MARKERS} are needed: print them with calibrate sheet --markers, '
            'and show them larger, sharper and not covered')
    centres = np.array([corners.mean(axis=0) for corners in found.values()])
    if on_one_line(np.column_stack([centres, np.zeros(len(centres))])):
        raise CalibrationError('the markers lie in one line: lay them near the corners of the '
                               'working area')
    return found


def _outside(pixels: Corners, hull: Optional[Hull]) -> List[str]:
    """Warn of markers that lie where no board was measured."""
    beyond = [] if hull is None else [
        number for number in sorted(pixels) if not hull.contains(pixels[number].mean(axis=0))]
    if not beyond:
        return []
    return [f'marker(s) {", ".join(map(str, beyond))} lie outside the area that the board '
            'covered: their places, and what is computed from them, may be off by millimetres; '
            'calibrate with the board beside the markers, too']


def _edge_mm(corners: np.ndarray) -> float:
    sides = np.roll(corners, -1, axis=0) - corners
    return MM_PER_CM * float(np.linalg.norm(sides, axis=1).mean())


def _doubts(edges_mm: Mapping[int, float], marker_mm: Optional[float]) -> List[str]:
    smallest, largest = min(edges_mm.values()), max(edges_mm.values())
    if largest > (1 + _SIZE_TOLERANCE) * smallest:
        return [f"the markers' edges are {smallest:.1f} to {largest:.1f} mm long on this surface: "
                'are they of one print, and has the camera not moved since the surface was '
                'calibrated?']
    middle = (smallest + largest) / 2
    if marker_mm is not None and abs(middle / marker_mm - 1) > _SIZE_TOLERANCE:
        return [f"the markers' edges are {middle:.1f} mm long on this surface, not "
                f'{marker_mm:g} mm: were they printed at 100 %, and is the surface that of this '
                'camera in this place?']
    return []
