# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate base`: the transform into the base frame, from a table, objects or markers."""

import argparse
from typing import Any, Dict, Optional, Tuple

from camera_to_base.calibration import (
    BASE, calibrate_base, calibrate_touches, Calibration, MARKERS, parts_of, point_pairs,
    read_pairs, Report, SURFACE, TouchedPair)
from camera_to_base.commands.calibrate.files import (
    base_outputs, check_outputs, Outputs, read_cell_file, write_part)
from camera_to_base.commands.calibrate.from_camera import run_base_from
from camera_to_base.commands.calibrate.live import (
    collect, KeptPairs, measure_again, open_positions, open_robot, Positions, Robot,
    touch_elsewhere)
from camera_to_base.commands.calibrate.live_camera import display_text
from camera_to_base.commands.calibrate.prompts import tell, until_it_fits
from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import known_markers, MARKER_SPECS
from camera_to_base.parameters import checked_values
from camera_to_base.settings import read_node_settings
from camera_to_base.simulation import SimulatedTouchTable
from camera_to_base.sources import kind_of, SIMULATED
from camera_to_base.surface import PointPairs, SURFACE_SPECS
import numpy as np

_Point = Tuple[float, float]


def run_marker_base(options: argparse.Namespace) -> Report:
    """Calibrate the base frame by touched markers, and write the file."""
    outputs = base_outputs(options, '--markers', MARKERS, {
        'a table': options.table, '--surface': options.surface, '--camera': options.camera})
    values = outputs.old.values
    middles = {number: tuple(corners.mean(axis=0).tolist()) for number, corners in known_markers(
        checked_values([*MARKER_SPECS, *SURFACE_SPECS], values)).items()}
    robot = open_robot(options.robot_topic)
    table = _simulated_table(options.markers)
    try:
        touched = {}
        for number in sorted(middles):
            touched[number] = _touch(number, middles, touched, robot, table)
        return write_part(
            _agreed_touches(middles, touched, robot, table, values, options), outputs, BASE)
    finally:
        robot.close()


def touch_marker(number: int, robot: Robot) -> _Point:
    """Ask for the touch of a marker; return x and y, in cm, in the base frame."""
    return _touch(number, {number: (0.0, 0.0)}, {}, robot, None)


def _touch(
    number: int, middles: Dict[int, _Point], touched: Dict[int, _Point], robot: Robot,
    table: Optional[SimulatedTouchTable],
) -> _Point:
    """Ask for the touch of a marker; return x and y, in cm, in the base frame."""
    tell(f'Marker {number}: the small cross in its middle')
    shown = table and table.robot_position_at(number)
    if shown:
        tell(f'  {display_text(shown)}')
    return touch_elsewhere(robot, middles[number], [
        TouchedPair(None, middles[other], touched[other])
        for other in sorted(touched) if other != number])


def _simulated_table(path: str) -> Optional[SimulatedTouchTable]:
    """Return the simulated table with its robot, if the file names the simulated camera."""
    camera = read_node_settings(path).camera
    if kind_of(camera.source) != SIMULATED:
        return None
    return camera.simulated.touch_table(camera.image_size)


def _agreed_touches(
    middles: Dict[int, _Point], touched: Dict[int, _Point], robot: Robot,
    table: Optional[SimulatedTouchTable], values: Dict[str, Any], options: argparse.Namespace,
) -> Calibration:
    """Fit the pairs; where they do not fit, let single markers be touched again."""
    def touch_again(number: int) -> None:
        touched[number] = _touch(number, middles, touched, robot, table)

    return until_it_fits(
        lambda: marker_base(middles, touched, values, options.base_z),
        'touches', 'a marker to touch it again', touched, touch_again)


def marker_base(
    middles: Dict[int, _Point], touched: Dict[int, _Point], values: Dict[str, Any], base_z: str
) -> Calibration:
    """
    Fit the base frame to touched markers.

    :param middles: By number, in cm, in the camera frame.
    :param touched: By number, in cm, in the base frame.
    :param values: The surface's parameters, by full name.
    """
    numbers = sorted(touched)
    pairs = PointPairs(np.array([(*middles[number], 0.0) for number in numbers]),
                       np.array([(*touched[number], 0.0) for number in numbers]), tuple(numbers))
    return calibrate_base(pairs, source='markers that the robot touched', base_z=base_z,
                          surface_values=values, points_are='marker')


def run_base(options: argparse.Namespace) -> Report:
    """Calibrate the base frame, and write the file."""
    if options.live == '':  # As in `base cell.yaml --live`.
        options.live, options.table = options.table, None
    if options.other is not None:
        if options.live is None:
            raise InvalidValueError(
                '--from takes the file of the camera that has no base frame, too, as in '
                'calibrate base --from /left --live right.yaml')
        return run_base_from(options)
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
