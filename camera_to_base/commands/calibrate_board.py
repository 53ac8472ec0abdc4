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
from typing import Any, Dict, List, Tuple

from camera_to_base.calibration import (
    add_camera_pose, calibrate_surface, map_lines, read_camera_info, Report, SURFACE, uncovered)
from camera_to_base.commands.board_placements import (
    first_points, make_placement, outer_edge, Placement, refuse_unlike, shares_of)
from camera_to_base.commands.calibrate_files import check_outputs, write_part
from camera_to_base.commands.calibrate_markers import markers_beside
from camera_to_base.commands.prompts import ask, tell, until_right
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE
from camera_to_base.simulation import SimulatedChessboard
from camera_to_base.sources import (
    DEVICE, FrameSource, kind_of, lasting_name, median_frame, open_frame_source, read_picture)
from camera_to_base.trust import view_thumbnail


def run_board(options: argparse.Namespace) -> Report:
    """Calibrate the surface, and write the file."""
    outputs = check_outputs(options, SURFACE, *options.pictures, options.intrinsics)
    intrinsics = read_camera_info(options.intrinsics) if options.intrinsics else None
    source_values: Dict[str, Any] = {}
    if options.camera is None:
        placements = [_from_file(options, path, number)
                      for number, path in enumerate(options.pictures)]
        refuse_unlike(placements)
    else:
        placements, source_values = _from_camera(options)
    first, *further = placements
    height, width = first.image.shape[:2]
    columns, rows = options.corners
    kind = 'a ChArUco board' if options.charuco else 'a chessboard'
    calibration = calibrate_surface(
        first.matched, (width, height), image=first.image,
        lattice=first_points(options).reshape(rows, columns, 2), points_are='corner',
        further=[placement.matched for placement in further],
        source=f'{kind} of {columns} x {rows} inner corners, {options.square_mm:g} mm apart, in '
               f'{", ".join(dict.fromkeys(one.name for one in placements))}'
               + (f', in {len(placements)} places' if further else ''))
    if intrinsics is not None:
        calibration = add_camera_pose(calibration, first.matched, intrinsics)
    report = calibration.report
    report['warnings'] += [doubt for placement in placements for doubt in placement.doubts]
    report['covered_map'] = map_lines(shares_of(placements))
    report['not_covered'] = uncovered(shares_of(placements))
    thumbnail = view_thumbnail(first.image, [outer_edge(first)])
    markers = markers_beside(first.image, calibration.values)
    if markers is not None:
        report['markers'] = markers.report['markers']
        report['warnings'] += markers.report['warnings']
    return write_part(calibration, outputs, SURFACE, {
        **source_values, 'calibration.thumbnail': thumbnail,
        **({} if markers is None else markers.values)})


def _from_file(options: argparse.Namespace, path: str, number: int) -> Placement:
    picture = read_picture(path)
    placement = make_placement(options, picture.frame, path, number)
    if picture.is_shown_turned:
        placement.doubts.append(
            'the EXIF orientation of the picture asks viewers to turn or mirror it; it was used '
            "as it is stored, as the node gets a camera's frames: if that is another program's "
            'picture, take one with --camera')
    return placement


def _from_camera(options: argparse.Namespace) -> Tuple[List[Placement], Dict[str, Any]]:
    """Take the pictures, guided from one placement to the next; return the source's values."""
    source, values = _open_camera(options)
    placements: List[Placement] = []
    try:
        while len(placements) < options.placements:
            number = len(placements)
            if number:
                _guide(placements, options.placements, source)

            def take() -> Placement:
                found = make_placement(
                    options, median_frame(source), f'camera {options.camera}', number)
                refuse_unlike([*placements, found])
                return found

            placements.append(take() if options.placements == 1 else until_right(
                take, 'Press Enter to take the picture again, q to stop:'))
    finally:
        source.release()
    return placements, values


def _guide(placements: List[Placement], wanted: int, source: FrameSource) -> None:
    shares = shares_of(placements)
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
