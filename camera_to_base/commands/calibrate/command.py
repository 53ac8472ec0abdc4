# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The command `calibrate`: calibrates from a chessboard or a table, and reports the errors."""

import argparse
import json
import os
import sys
from typing import List, Optional

from camera_to_base.calibration import (
    calibrate_surface, check_surface, has_one_origin, marker_sheet_content, read_points,
    refuse_other_size, Report, report_lines, sheet_content, SURFACE)
from camera_to_base.checks import DEFAULT_IMAGE_SIZE
from camera_to_base.commands.calibrate.base import run_base
from camera_to_base.commands.calibrate.board import run_board
from camera_to_base.commands.calibrate.files import (
    check_outputs, next_command, read_cell_file, run_keep, run_status, sheet_output, write_part)
from camera_to_base.commands.calibrate.markers import run_markers
from camera_to_base.commands.calibrate.options import (
    BOLD, drop_output, GREEN, parse, RED, styled, YELLOW)
from camera_to_base.commands.calibrate.prompts import tell
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import serve_signals, write_files
from camera_to_base.shell_commands import full_command, with_full_commands


def main(args: Optional[List[str]] = None) -> int:
    """Run the command; return its exit code."""
    try:
        serve_signals()
        options = parse(args)
        _tell_step(options.command)
        report = _COMMANDS[options.command](options)
    except CameraToBaseError as error:
        text = styled(f'calibrate: {with_full_commands(str(error))}', RED, sys.stderr)
        print(text, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    try:
        print(json.dumps(report) if options.json else
              '\n'.join(_lines(report, options.verbose)), flush=True)
    except BrokenPipeError:
        drop_output()  # the reader has closed the pipe
    except OSError as error:
        print(f'calibrate: cannot print the report: {error.strerror or error}', file=sys.stderr)
        drop_output()
        return 1
    return 0


def _tell_step(command: str) -> None:
    """Say on a terminal which of the steps to a running cell this is."""
    if command in _STEPS and sys.stderr.isatty():
        number, purpose = _STEPS[command]
        tell(styled(f'step {number} of 4: {purpose}', BOLD, sys.stderr))


def _run_sheet(options: argparse.Namespace) -> Report:
    output = sheet_output(options)
    columns, rows = options.corners
    ending = os.path.splitext(output)[1].lower()
    if ending not in ('.pdf', '.svg', '.png'):
        raise InvalidValueError(
            f"a sheet's name must end in .pdf, .svg or .png, got '{output}'")
    if options.markers:
        content = marker_sheet_content(options.paper, options.marker_mm, ending[1:])
        kept = write_files({output: content}, keep_old=True)
        return {'file': output, 'paper': options.paper, 'marker_mm': options.marker_mm,
                'warnings': [], 'kept': kept, 'next': full_command(
                    'calibrate', 'markers', '--camera', '0', '-o', 'cell.yaml')}
    content = sheet_content(options.paper, columns, rows, options.square_mm, ending[1:],
                            with_markers=options.charuco)
    doubts = [] if options.charuco or has_one_origin(columns, rows) else [
        f'a board of {columns} x {rows} inner corners looks the same when it is turned: where the '
        'camera frame starts depends on how it lies; with one even and one odd count it does not']
    kept = write_files({output: content}, keep_old=True)
    return {'file': output, 'paper': options.paper, 'corners': [columns, rows],
            'square_mm': options.square_mm, 'warnings': doubts, 'kept': kept,
            'next': full_command(
                'calibrate', 'board', '--camera', '0',
                '--corners', f'{columns}x{rows}', '--square-mm', f'{options.square_mm:g}',
                *(['--charuco'] if options.charuco else []), '-o', 'cell.yaml')}


def _run_points(options: argparse.Namespace) -> Report:
    outputs = check_outputs(options, SURFACE, options.table)
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
    return write_part(calibration, outputs, SURFACE)


def _run_check(options: argparse.Namespace) -> Report:
    values = read_cell_file(options.file).values
    return {'checked': options.file, **check_surface(values, *read_points(options.table)),
            'next': next_command(options.file, values)}


_COMMANDS = {'sheet': _run_sheet, 'board': run_board, 'markers': run_markers,
             'points': _run_points, 'base': run_base, 'check': _run_check, 'status': run_status,
             'keep': run_keep}


# The last one is the launch.
_STEPS = {'sheet': (1, 'print a board'), 'board': (2, 'measure the surface'),
          'points': (2, 'measure the surface'), 'base': (3, 'measure where the robot is')}
_STYLES = {'good: ': GREEN, 'fair: ': YELLOW, 'poor: ': RED, 'warning: ': YELLOW, 'next: ': BOLD}
_VERDICTS = ('good: ', 'fair: ', 'poor: ')
_WITH_COMMANDS = ('warning: ', 'running node: ')


def _lines(report: Report, with_map: bool) -> List[str]:
    written = [f'{name}: {report[name]}' for name in ('file', 'picture') if name in report]
    written += [f'the old one is kept: {path}' for path in report.get('kept', ())]
    advice = ['look at the picture before you trust the figures'] if 'picture' in report else []
    if 'paper' in report:
        advice = ['print it at 100 %, and measure the ruler: it must be 100 mm long']
    lines = report_lines(report, with_map)
    verdict = [line for line in lines if line.startswith(_VERDICTS)]
    lines = [*(line for line in lines if line not in verdict), *written, *advice, *verdict]
    return [_styled(line) for line in [*lines, f'next: {report["next"]}']]


def _styled(line: str) -> str:
    if line.startswith(_WITH_COMMANDS):
        line = with_full_commands(line)
    style = next((style for start, style in _STYLES.items() if line.startswith(start)), None)
    return line if style is None else styled(line, style, sys.stdout)


if __name__ == '__main__':
    sys.exit(main())
