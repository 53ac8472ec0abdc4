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

"""`calibrate base`: the transform into the base frame, from a table or from objects one by one."""

import argparse
from typing import Optional

from camera_to_base.calibration import (
    BASE, calibrate_base, calibrate_touches, Calibration, parts_of, point_pairs, read_pairs,
    Report, SURFACE)
from camera_to_base.commands.calibrate.files import (
    base_outputs, check_outputs, Outputs, read_cell_file, write_part)
from camera_to_base.commands.calibrate.live import (
    collect, KeptPairs, measure_again, open_positions, open_robot, Positions, Robot)
from camera_to_base.commands.calibrate.marker_base import run_marker_base
from camera_to_base.commands.calibrate.prompts import tell, until_it_fits
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface import PointPairs


def run_base(options: argparse.Namespace) -> Report:
    """Calibrate the base frame, and write the file."""
    if options.live is not None:
        return _run_live(options)
    if options.markers is not None:
        return run_marker_base(options)
    if options.table is None or options.output is None:
        raise InvalidValueError(
            'expected a table and a file to write, as in calibrate base PAIRS.csv --surface '
            'cell.yaml -o cell.yaml, or --live cell.yaml or --markers cell.yaml without a table')
    outputs = check_outputs(options, BASE, options.table, may_picture=False)
    pairs = read_pairs(options.table)
    outputs = _with_surface(outputs, options.surface)
    return _write(_fit(pairs, outputs, options), outputs)


def _with_surface(outputs: Outputs, path: Optional[str]) -> Outputs:
    """Return the outputs with the content of the surface file instead of the old one."""
    return outputs if path is None else outputs._replace(old=read_cell_file(path))


def _fit(pairs: PointPairs, outputs: Outputs, options: argparse.Namespace) -> Calibration:
    has_surface = outputs.old is not None and (
        options.surface is not None or SURFACE in parts_of(outputs.old.values))
    return calibrate_base(
        pairs, source=options.table, base_z=options.base_z,
        surface_values=outputs.old.values if has_surface else None)


def _write(calibration: Calibration, outputs: Outputs, thumbnail: str = '') -> Report:
    values = {'calibration.thumbnail': thumbnail} if thumbnail else {}
    return write_part(calibration, outputs, BASE, values)


def _run_live(options: argparse.Namespace) -> Report:
    outputs = base_outputs(
        options, '--live', SURFACE, {'a table': options.table, '--surface': options.surface})
    if options.places < 3:
        raise InvalidValueError(f'--places must be 3 or more, got {options.places}')
    kept = KeptPairs(outputs.file, str(outputs.old.values.get('calibration.surface', '')))
    robot = open_robot(options.robot_topic)
    try:
        positions = open_positions(options.live, options.namespace, options.camera)
        try:
            collect(positions, robot, options.places, kept)
            calibration = _agreed(kept, positions, robot, outputs, options)
            report = _write(calibration, outputs, positions.thumbnail)
            kept.remove()
            return report
        finally:
            positions.close()
    except BaseException:
        if kept.pairs:
            tell(f'\nThe pairs so far are kept in {kept.path}: the same command goes on with '
                 'them.')
        raise
    finally:
        robot.close()


def _agreed(
    kept: KeptPairs, positions: Positions, robot: Robot, outputs: Outputs,
    options: argparse.Namespace,
) -> Calibration:
    """Fit the pairs; where they do not fit, let single ones be measured again."""
    return until_it_fits(
        lambda: calibrate_touches(point_pairs(kept.pairs), outputs.old.values, options.base_z),
        'pairs', 'a pair to measure it again', range(1, len(kept.pairs) + 1),
        lambda number: measure_again(kept, number - 1, positions, robot))
