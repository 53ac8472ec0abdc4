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


"""The command `calibrate`: calibrates from a chessboard or a table, and reports the errors."""

import argparse
from datetime import datetime
import json
import os
import sys
from typing import Any, Dict, Iterable, List, Optional, Tuple

from camera_to_base.calibration import (
    add_camera_pose, board_points, calibrate_base, calibrate_surface, Calibration, check_surface,
    file_status, find_board, has_one_origin, read_camera_info, read_pairs, read_points,
    refuse_other_size, Report, report_lines, sheet_content, without_base)
from camera_to_base.commands.calibrate_options import parse
from camera_to_base.drawing import check_picture_path, encoded_picture
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import (
    check_folder, refuse_existing, refuse_same_file, regular_target, write_files)
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE
from camera_to_base.interrupt import serve_signals
from camera_to_base.parameters import parameter_text, read_parameter_file
from camera_to_base.simulation import SimulatedChessboard
from camera_to_base.sources import FrameSource, median_frame, open_frame_source, read_picture
from camera_to_base.surface import MatchedPoints
import numpy as np


def main(args: Optional[List[str]] = None) -> int:
    """Run the command; return its exit code."""
    try:
        serve_signals()
        options = parse(args)
        report = _COMMANDS[options.command](options)
    except CameraToBaseError as error:
        print(f'calibrate: {error}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    print(json.dumps(report) if options.json else '\n'.join(_lines(report)))
    return 0


def _run_sheet(options: argparse.Namespace) -> Report:
    _outputs(options)
    columns, rows = options.corners
    ending = os.path.splitext(options.output)[1].lower()
    if ending not in ('.pdf', '.svg', '.png'):
        raise InvalidValueError(
            f"a sheet's name must end in .pdf, .svg or .png, got '{options.output}'")
    content = sheet_content(options.paper, columns, rows, options.square_mm, ending[1:])
    doubts = [] if has_one_origin(columns, rows) else [
        f'a board of {columns} x {rows} inner corners looks the same when it is turned: where the '
        'camera frame starts depends on how it lies; with one even and one odd count it does not']
    kept = write_files({options.output: content}, keep_old=True)
    return {'file': options.output, 'paper': options.paper, 'corners': [columns, rows],
            'square_mm': options.square_mm, 'warnings': doubts, 'kept': kept}


def _run_board(options: argparse.Namespace) -> Report:
    columns, rows = options.corners
    points = board_points(columns, rows, options.square_mm, origin_corner=options.origin_corner,
                          origin_mm=options.origin_mm, yaw_deg=options.yaw_deg)
    outputs = _outputs(options, options.picture_file, options.intrinsics)
    intrinsics = read_camera_info(options.intrinsics) if options.intrinsics else None
    image, name, source_values, doubts = _board_picture(options)
    board = find_board(image, columns, rows)
    matched = MatchedPoints(points, board.pixels)
    calibration = calibrate_surface(
        matched, (image.shape[1], image.shape[0]), image=image,
        lattice=points.reshape(rows, columns, 2), points_are='corner',
        source=f'a chessboard of {columns} x {rows} inner corners, {options.square_mm:g} mm '
               f'apart, in {name}')
    if intrinsics is not None:
        calibration = add_camera_pose(calibration, matched, intrinsics)
    if board.second_board:
        doubts.append('another such board is in the picture: this is the larger one')
    calibration.report['warnings'] += doubts
    return _write(calibration, outputs, source_values)


def _run_points(options: argparse.Namespace) -> Report:
    outputs = _outputs(options, options.table)
    matched, table_size = read_points(options.table)
    if options.image_size is not None:
        refuse_other_size(table_size, options.image_size)
    image_size = options.image_size or table_size
    calibration = calibrate_surface(
        matched, image_size or DEFAULT_IMAGE_SIZE, source=options.table, model=options.model)
    if image_size is None:
        calibration.report['warnings'].append(
            'assumed: the points were measured in a picture of {} x {} px; say it with '
            '--image-size'.format(*DEFAULT_IMAGE_SIZE))
    return _write(calibration, outputs)


def _run_base(options: argparse.Namespace) -> Report:
    outputs = _outputs(options, options.table)
    pairs = read_pairs(options.table)
    if options.surface is None:
        return _write(calibrate_base(pairs, source=options.table), outputs)
    surface = read_parameter_file(options.surface)
    calibration = calibrate_base(
        pairs, source=options.table, surface_values=surface.values, base_z=options.base_z)
    return _write(calibration, outputs, surface.values,
                  ['', f'The surface, from {options.surface}:', *without_base(surface.comments)])


def _run_check(options: argparse.Namespace) -> Report:
    values = read_parameter_file(options.file).values
    return {'checked': options.file, **check_surface(values, *read_points(options.table))}


def _run_status(options: argparse.Namespace) -> Report:
    file = read_parameter_file(options.file)
    return file_status(options.file, file.values, file.comments, datetime.now().astimezone())


_COMMANDS = {'sheet': _run_sheet, 'board': _run_board, 'points': _run_points, 'base': _run_base,
             'check': _run_check, 'status': _run_status}


def _board_picture(
    options: argparse.Namespace
) -> Tuple[np.ndarray, str, Dict[str, Any], List[str]]:
    """Get the picture, what to call it, its source's parameters, and what is doubtful."""
    if options.camera is None:
        picture = read_picture(options.picture_file)
        doubts = [
            'the EXIF orientation of the picture asks viewers to turn or mirror it; it was used '
            "as it is stored, as the node gets a camera's frames: if that is another program's "
            'picture, take one with --camera'] if picture.is_shown_turned else []
        return picture.frame, options.picture_file, {}, doubts
    source, values = _open_camera(options)
    try:
        return median_frame(source), f'camera {options.camera}', values, []
    finally:
        source.release()


def _open_camera(options: argparse.Namespace) -> Tuple[FrameSource, Dict[str, Any]]:
    size = options.image_size or DEFAULT_IMAGE_SIZE
    if options.camera != 'simulated':
        return open_frame_source(options.camera, size), {}
    chessboard = SimulatedChessboard(
        *options.corners, options.square_mm / 10, image_size=size,
        tilt_deg=options.simulated_tilt_deg)
    return chessboard, {'simulated.tilt_deg': options.simulated_tilt_deg}


def _outputs(options: argparse.Namespace, *sources: Optional[str]) -> List[str]:
    """Return the paths of the files to write, after checking them."""
    outputs = [options.output]
    if 'picture' in options:
        outputs.append(options.picture or f'{os.path.splitext(options.output)[0]}_report.png')
    refuse_same_file([*sources, *outputs])
    for picture in outputs[1:]:
        check_picture_path(picture)
    for output in outputs:
        check_folder(output, 'file')
        regular_target(output)
    if not options.force:
        refuse_existing(outputs)
    return outputs


def _write(
    calibration: Calibration, outputs: List[str], values: Optional[Dict[str, Any]] = None,
    comments: Iterable[str] = (),
) -> Report:
    """Write the parameter file and the picture, if there is one; return the report."""
    text = parameter_text(
        {**(values or {}), **calibration.values},
        ['Written by `calibrate` of camera_to_base.', *report_lines(calibration.report),
         *comments])
    contents = {outputs[0]: text.encode()}
    for path in outputs[1:]:
        contents[path] = encoded_picture(path, calibration.picture)
    kept = write_files(contents, keep_old=True)
    return {**calibration.report, **dict(zip(('file', 'picture'), outputs)), 'kept': kept}


def _lines(report: Report) -> List[str]:
    written = [f'{name}: {report[name]}' for name in ('file', 'picture') if name in report]
    written += [f'the old one is kept: {path}' for path in report.get('kept', ())]
    advice = ['look at the picture before you trust the figures'] if 'picture' in report else []
    if 'paper' in report:
        advice = ['print it at 100 %, and measure the ruler: it must be 100 mm long']
    return [*report_lines(report), *written, *advice]


if __name__ == '__main__':
    sys.exit(main())
