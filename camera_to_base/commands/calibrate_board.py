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

"""`calibrate board`: the surface from pictures of a chessboard that lies on it."""

import argparse
from typing import Any, Dict, List, NamedTuple, Tuple

from camera_to_base.calibration import (
    add_camera_pose, board_points, calibrate_surface, covered_shares, find_board, map_lines,
    read_camera_info, Report, SURFACE, uncovered)
from camera_to_base.commands.calibrate_files import check_outputs, write_part
from camera_to_base.commands.prompts import ask, tell, until_right
from camera_to_base.errors import CalibrationError
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE
from camera_to_base.simulation import SimulatedChessboard
from camera_to_base.sources import (
    DEVICE, FrameSource, kind_of, lasting_name, median_frame, open_frame_source, read_picture)
from camera_to_base.surface import Hull, MatchedPoints
from camera_to_base.trust import view_thumbnail
import numpy as np

# Mean distance of the corners of two placements below which the board was not moved.
_LEAST_MOVE_PX = 5.0


class _Placement(NamedTuple):
    """A picture of the board, the points that it shows, and what is doubtful about it."""

    image: np.ndarray
    name: str
    matched: MatchedPoints
    outline: np.ndarray
    doubts: List[str]


def run_board(options: argparse.Namespace) -> Report:
    """Calibrate the surface, and write the file."""
    outputs = check_outputs(options, SURFACE, *options.pictures, options.intrinsics)
    intrinsics = read_camera_info(options.intrinsics) if options.intrinsics else None
    source_values: Dict[str, Any] = {}
    if options.camera is None:
        placements = [_from_file(options, path, number)
                      for number, path in enumerate(options.pictures)]
        _refuse_unlike(placements)
    else:
        placements, source_values = _from_camera(options)
    first, *further = placements
    height, width = first.image.shape[:2]
    columns, rows = options.corners
    calibration = calibrate_surface(
        first.matched, (width, height), image=first.image,
        lattice=first.matched.points.reshape(rows, columns, 2), points_are='corner',
        further=[placement.matched for placement in further],
        source=f'a chessboard of {columns} x {rows} inner corners, {options.square_mm:g} mm '
               f'apart, in {", ".join(dict.fromkeys(one.name for one in placements))}'
               + (f', in {len(placements)} places' if further else ''))
    if intrinsics is not None:
        calibration = add_camera_pose(calibration, first.matched, intrinsics)
    report = calibration.report
    report['warnings'] += [doubt for placement in placements for doubt in placement.doubts]
    report['covered_map'] = map_lines(_shares(placements))
    report['not_covered'] = uncovered(_shares(placements))
    thumbnail = view_thumbnail(first.image, [_outer_edge(first)])
    return write_part(calibration, outputs, SURFACE,
                      {**source_values, 'calibration.thumbnail': thumbnail})


def _from_file(options: argparse.Namespace, path: str, number: int) -> _Placement:
    picture = read_picture(path)
    placement = _placement(options, picture.frame, path, number)
    if picture.is_shown_turned:
        placement.doubts.append(
            'the EXIF orientation of the picture asks viewers to turn or mirror it; it was used '
            "as it is stored, as the node gets a camera's frames: if that is another program's "
            'picture, take one with --camera')
    return placement


def _from_camera(options: argparse.Namespace) -> Tuple[List[_Placement], Dict[str, Any]]:
    """Take the pictures, guided from one placement to the next; return the source's values."""
    source, values = _open_camera(options)
    placements: List[_Placement] = []
    try:
        while len(placements) < options.placements:
            number = len(placements)
            if number:
                _guide(placements, options.placements, source)

            def take() -> _Placement:
                found = _placement(options, median_frame(source), f'camera {options.camera}',
                                   number)
                _refuse_unlike([*placements, found])
                return found

            placements.append(take() if options.placements == 1 else until_right(
                take, 'Press Enter to take the picture again, q to stop:'))
    finally:
        source.release()
    return placements, values


def _guide(placements: List[_Placement], wanted: int, source: FrameSource) -> None:
    shares = _shares(placements)
    tell(f'{len(placements)} of {wanted} taken. The picture so far, # is covered, + in part:')
    for line in map_lines(shares):
        tell(f'    {line}')
    missing = ' or '.join(uncovered(shares)[:2]) or 'anywhere'
    if isinstance(source, SimulatedChessboard):
        pixel, yaw_deg = source.free_place(len(placements))
        source.lay(pixel, yaw_deg)
        tell('The simulated board was laid elsewhere.')
    else:
        ask(f'Lay the board elsewhere, best {missing}, without moving the camera; turn it a '
            'little. Then press Enter:')


def _placement(
    options: argparse.Namespace, image: np.ndarray, name: str, number: int
) -> _Placement:
    columns, rows = options.corners
    try:
        board = find_board(image, columns, rows)
    except CalibrationError as error:
        if number == 0 and len(options.pictures) < 2:
            raise
        raise CalibrationError(f'{name}: {error}') from error
    # The first placement defines the camera frame. The others lie anyhow; the origin's corner
    # tells on which side of the surface z is.
    place = {'origin_mm': options.origin_mm, 'yaw_deg': options.yaw_deg} if number == 0 else {}
    points = board_points(
        columns, rows, options.square_mm, origin_corner=options.origin_corner, **place)
    doubts = ['another such board is in the picture: this is the larger one'
              ] if board.second_board else []
    return _Placement(image, name, MatchedPoints(points, board.pixels),
                      Hull(board.pixels).corners, doubts)


def _refuse_unlike(placements: List[_Placement]) -> None:
    """Refuse pictures of another size, and placements that are the same."""
    *before, last = placements
    for one in before:
        if one.image.shape != last.image.shape:
            raise CalibrationError(
                '{1} x {0} px in {2}, but {4} x {3} px in {5}: use pictures of one size, from one '
                'camera'.format(*one.image.shape[:2], one.name, *last.image.shape[:2], last.name))
        apart = np.linalg.norm(one.matched.pixels - last.matched.pixels, axis=1).mean()
        if apart < _LEAST_MOVE_PX:
            raise CalibrationError(
                f'the board lies in the same place twice, in {one.name} and in {last.name}: lay '
                'it elsewhere')
    if len(before) > 1:
        _refuse_unlike(before)


def _shares(placements: List[_Placement]) -> np.ndarray:
    height, width = placements[0].image.shape[:2]
    return covered_shares([placement.outline for placement in placements], (width, height))


def _outer_edge(placement: _Placement) -> np.ndarray:
    """Return about where the board's white margin ends, shape (n, 2), in px."""
    centre = placement.outline.mean(axis=0)
    return centre + 1.6 * (placement.outline - centre)


def _open_camera(options: argparse.Namespace) -> Tuple[FrameSource, Dict[str, Any]]:
    size = options.image_size or DEFAULT_IMAGE_SIZE
    if options.camera != 'simulated':
        device = lasting_name(options.camera)
        values: Dict[str, Any] = {'calibration.device': device}
        if kind_of(options.camera).is_live:
            values['source'] = device if kind_of(device) == DEVICE else options.camera
        return open_frame_source(options.camera, size), values
    chessboard = SimulatedChessboard(
        *options.corners, options.square_mm / 10, image_size=size,
        tilt_deg=options.simulated_tilt_deg)
    return chessboard, {'source': 'simulated', 'calibration.device': 'simulated',
                        'simulated.tilt_deg': options.simulated_tilt_deg}
