# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate board`: the surface from pictures of a chessboard that lies on it."""

import argparse
from typing import Any, Dict, List, Optional, Tuple

from camera_to_base.calibration import (
    calibrate_placements, make_placement, map_lines, Placement, PrintedBoard, read_camera_info,
    refuse_unlike, Report, shares_of, SURFACE, uncovered)
from camera_to_base.checks import DEFAULT_IMAGE_SIZE
from camera_to_base.commands.calibrate.files import camera_values, check_outputs, write_part
from camera_to_base.commands.calibrate.live_camera import FreshFrames
from camera_to_base.commands.calibrate.prompts import ask, tell, until_right
from camera_to_base.commands.calibrate.tilted import take_tilted
from camera_to_base.commands.calibrate.topic import TopicFrames
from camera_to_base.errors import CameraToBaseError, InputEndedError, InvalidValueError
from camera_to_base.parameters import ParameterFile, Values
from camera_to_base.simulation import CameraMove, move_parameters, SimulatedChessboard
from camera_to_base.sources import (
    FrameSource, kind_of, median_frame, open_frame_source, read_picture, SIMULATED)
from camera_to_base.surface import LensModel

_TILTED_PLACEMENTS = 4


def run_board(options: argparse.Namespace) -> Report:
    """Calibrate the surface, and write the file."""
    _check_options(options)
    outputs = check_outputs(
        options, SURFACE, *options.pictures, *options.tilted, options.intrinsics)
    lens = read_camera_info(options.intrinsics) if options.intrinsics else None
    board, source_values = _printed_board(options), {}
    if options.image_topic is not None:
        placements, tilted, lens = _from_topic(board, options, lens)
    elif options.camera is None:
        says_name = len(options.pictures) + len(options.tilted) > 1
        placements = [_from_file(board, path, number, says_name)
                      for number, path in enumerate(options.pictures)]
        tilted = [_from_file(board, path, number, says_name)
                  for number, path in enumerate(options.tilted, len(placements))]
        refuse_unlike([*placements, *tilted])
    else:
        source, source_values = _open_camera(options, outputs.old)
        placements, tilted = _taken_from(source, board, options, options.tilted_placements)
    calibration = calibrate_placements(board, placements, lens, tilted)
    return write_part(calibration, outputs, SURFACE, source_values)


def _check_options(options: argparse.Namespace) -> None:
    is_live = options.camera is not None or options.image_topic is not None
    if bool(options.pictures) + sum(
            one is not None for one in (options.camera, options.image_topic)) != 1:
        raise InvalidValueError(
            'expected pictures of the board, --camera, or --image-topic: calibrate board '
            'board.png -o cell.yaml, or calibrate board --camera 0 -o cell.yaml')
    for name, least in (('placements', 1), ('tilted_placements', 0)):
        count = getattr(options, name)
        if count is not None and not least <= count <= 20:
            raise InvalidValueError(
                f'--{name.replace("_", "-")} must be {least}..20, got {count}')
        if count is not None and not is_live:
            raise InvalidValueError(
                f'--{name.replace("_", "-")} needs --camera: of pictures, give one for each '
                'place' + (', and --tilted' if least == 0 else ''))
    if options.tilted and is_live:
        raise InvalidValueError('--tilted names pictures: with --camera, --tilted-placements '
                                'says how many are taken')
    _fill_counts(options)
    if options.charuco and options.camera == 'simulated':
        raise InvalidValueError(
            'the simulated camera shows a chessboard without markers: leave out --charuco')


def _fill_counts(options: argparse.Namespace) -> None:
    """Take four flat and four tilted pictures, unless one number or the lens is given."""
    kind = kind_of(options.camera or '')
    # A video shows one placement.
    is_topic = options.image_topic is not None
    is_single = not is_topic and (
        options.camera is None or not (kind.is_live or kind == SIMULATED))
    is_told = options.placements is not None or options.intrinsics is not None
    # A topic's camera_info may tell the lens.
    if options.tilted_placements is None and (is_told or not is_topic):
        options.tilted_placements = 0 if is_told or is_single else _TILTED_PLACEMENTS
    if options.placements is None:
        options.placements = 1 if is_single else 4


def _printed_board(options: argparse.Namespace) -> PrintedBoard:
    return PrintedBoard(
        options.corners, options.square_mm, options.charuco, options.origin_corner,
        options.origin_mm, options.yaw_deg)


def _from_file(
    board: PrintedBoard, path: str, number: int, says_name: bool
) -> Placement:
    picture = read_picture(path)
    tell(f'looking for the board in {path} ...')
    placement = make_placement(board, picture.frame, path, number, says_name)
    if picture.is_shown_turned:
        placement.doubts.append(
            'the EXIF orientation of the picture asks viewers to turn or mirror it; it was used '
            "as it is stored, as the node gets a camera's frames: if that is another program's "
            'picture, take one with --camera')
    return placement


def _from_topic(
    board: PrintedBoard, options: argparse.Namespace, lens: Optional[LensModel]
) -> Tuple[List[Placement], List[Placement], Optional[LensModel]]:
    """Take the pictures from a driver: flat ones, tilted ones; and its lens, where it is known."""
    source = TopicFrames(options.image_topic)
    try:
        source.read()
        lens = lens or source.lens()
    except CameraToBaseError:
        source.release()
        raise
    tilted_count = options.tilted_placements
    if tilted_count is None:
        tilted_count = 0 if lens is not None else _TILTED_PLACEMENTS
    return (*_taken_from(source, board, options, tilted_count), lens)


def _taken_from(
    source: FrameSource, board: PrintedBoard, options: argparse.Namespace, tilted_count: int
) -> Tuple[List[Placement], List[Placement]]:
    """Take the pictures, guided from one to the next: flat ones, and tilted ones."""
    placements: List[Placement] = []
    try:
        while len(placements) < options.placements:
            if placements and not _guide(placements, options.placements, source):
                break
            placement = _taken(board, source, options, placements)
            if placement is None:
                break
            placements.append(placement)
        tilted = take_tilted(board, source, placements, tilted_count)
    finally:
        source.release()
    return placements, tilted


def _taken(
    board: PrintedBoard, source: FrameSource, options: argparse.Namespace,
    placements: List[Placement],
) -> Optional[Placement]:
    """Take a picture until it shows the board; None to end with the placements so far."""
    number = len(placements)

    def take() -> Placement:
        if isinstance(source, FreshFrames):
            source.drop()
        picture = median_frame(source)
        tell('looking for the board ...')
        found = make_placement(
            board, picture, _name(options, number), number, says_name=number > 0)
        refuse_unlike([*placements, found])
        return found

    if options.placements == 1:
        return take()
    end = 'to end with those so far' if placements else 'to stop'
    try:
        return until_right(take, f'Press Enter to take the picture again, q {end}:')
    except InputEndedError:
        raise
    except CameraToBaseError:
        if not placements:
            raise
        return None


def _name(options: argparse.Namespace, number: int) -> str:
    name = options.image_topic or f'camera {options.camera}'
    return name if options.placements == 1 else f'{name}, placement {number + 1}'


def _guide(placements: List[Placement], wanted: int, source: FrameSource) -> bool:
    """Say where to lay the board next; return whether the person goes on."""
    shares = shares_of(placements)
    tell(f'{len(placements)} of {wanted} taken. The picture so far, # is covered, + in part:')
    for line in map_lines(shares):
        tell(f'    {line}')
    missing = ' or '.join(uncovered(shares)[:2]) or 'anywhere'
    if isinstance(source, SimulatedChessboard):
        pixel, yaw_deg = source.free_place(len(placements))
        source.lay(pixel, yaw_deg)
        tell('The simulated board was laid elsewhere.')
        return True
    return ask(f'Lay the board elsewhere, best {missing}, without moving the camera; turn it a '
               'little. Then press Enter, or q to end with those so far:').lower() != 'q'


def _open_camera(
    options: argparse.Namespace, old: Optional[ParameterFile]
) -> Tuple[FrameSource, Dict[str, Any]]:
    size = options.image_size or DEFAULT_IMAGE_SIZE
    if options.camera != 'simulated':
        source = open_frame_source(options.camera, size)
        if source.kind.is_live:
            source = FreshFrames(source, f"the camera '{options.camera}'")
        return source, camera_values(options.camera)
    _refuse_moved_camera(options.output, {} if old is None else old.values)
    chessboard = SimulatedChessboard(
        *options.corners, options.square_mm / 10, image_size=size,
        tilt_deg=options.simulated_tilt_deg)
    return chessboard, {'source': 'simulated', 'calibration.device': 'simulated',
                        'simulated.tilt_deg': options.simulated_tilt_deg}


def _refuse_moved_camera(path: str, values: Values) -> None:
    # The surface would be that of another pose than the one from which the node then looks.
    moved = [name for name, still in move_parameters(CameraMove()).items()
             if values.get(name, still) != still]
    if moved:
        raise InvalidValueError(
            f"'{path}' moves the simulated camera ({', '.join(moved)}), and calibrate board "
            '--camera simulated looks from where it was not moved: take these lines out, or '
            'calibrate on the dashboard, which sees what the node sees')
