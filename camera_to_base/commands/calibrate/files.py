# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The files that `calibrate` writes, and what they say next; `calibrate keep` and `status`."""

import argparse
from datetime import datetime
import os
import shlex
from typing import Any, Dict, Mapping, NamedTuple, Optional

from camera_to_base.calibration import (
    BASE, Calibration, cell_text, corrected_file_text, file_status, grown, MARKERS, next_step,
    OfferedCorrection, part_values, parts_of, parts_to_lose, Report, report_lines, SURFACE, TITLE,
    without_report)
from camera_to_base.drawing import check_picture_path, encoded_picture
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import (
    check_folder, refuse_existing, refuse_same_file, regular_target, write_files)
from camera_to_base.parameters import ParameterFile, read_parameter_file, read_sections
from camera_to_base.shell_commands import full_command, run_command
from camera_to_base.sources import DEVICE, kind_of, lasting_name

# Name of a part, and the step that gives it.
_EARLIER = {SURFACE: ('surface', 'calibrate board --camera {} -o {}'),
            MARKERS: ('markers', 'calibrate markers --camera {} -o {}')}

# A hand that crosses the view, or a picture that comes late, does not end the command.
_PATIENCE_S = 2.0


class Outputs(NamedTuple):
    """
    The files to write.

    :param file: The parameter file.
    :param picture: The report picture; None for none.
    :param old: What the file holds already; None if it is new, or is replaced as a whole.
    """

    file: str
    picture: Optional[str]
    old: Optional[ParameterFile]


def read_cell_file(path: str) -> ParameterFile:
    """
    Read the file that an earlier step of the calibration has written.

    :raises InvalidValueError: If there is no such file, or it is no parameter file.
    """
    if not os.path.lexists(path):
        raise InvalidValueError(
            f"there is no file '{path}': first make it with " + _made_by(SURFACE, path, {}))
    return read_parameter_file(path)


def refuse_without(part: str, path: str, values: Mapping[str, Any]) -> None:
    """
    Refuse the parameters of a file without a part that an earlier step gives.

    :param part: SURFACE or MARKERS.
    :raises InvalidValueError: If it is not there.
    """
    if part not in parts_of(values):
        raise InvalidValueError(
            f"'{path}' holds no {_EARLIER[part][0]}: first add it with "
            + _made_by(part, path, values))


def _made_by(part: str, path: str, values: Mapping[str, Any]) -> str:
    return _EARLIER[part][1].format(
        *map(shlex.quote, (str(values.get('source', '0')), path)))


def base_outputs(
    options: argparse.Namespace, option: str, part: str, others: Mapping[str, Optional[str]]
) -> Outputs:
    """
    Check the file with a surface or with markers that gets the base frame, and that is read.

    :param option: The option that names it, such as --live.
    :param part: What it must hold, SURFACE or MARKERS.
    :param others: By name, what cannot be given, too.
    :raises InvalidValueError: If something else is given, or the file cannot be read or written.
    """
    for name, value in others.items():
        if value is not None:
            raise InvalidValueError(f'{option} takes the file with {part} alone, not {name}')
    path = getattr(options, option.lstrip('-'))
    options.output = options.output or path
    file = read_cell_file(path)
    refuse_without(part, path, file.values)
    return check_outputs(options, BASE, may_picture=False)._replace(old=file)


def sheet_output(options: argparse.Namespace) -> str:
    """
    Check the path of a file that is written as a whole.

    :raises InvalidValueError: If it cannot be written, or exists without --force.
    """
    check_folder(options.output, 'file')
    regular_target(options.output)
    if not options.force:
        refuse_existing([options.output])
    return options.output


def check_outputs(
    options: argparse.Namespace, part: str, *sources: Optional[str], may_picture: bool = True
) -> Outputs:
    """
    Check the paths of the files to write, before anything is measured.

    :param part: The part of the calibration that the file gets.
    :param sources: The paths of the files that are read.
    :raises InvalidValueError: If one cannot be written, or something would be lost and --force
        is not given.
    """
    file, picture = options.output, None
    if may_picture:
        picture = options.picture or f'{os.path.splitext(file)[0]}_report.png'
        check_picture_path(picture)
    written = list(filter(None, (file, picture)))
    refuse_same_file([*sources, *written])
    for path in written:
        check_folder(path, 'file')
        regular_target(path)
    old = _old_file(file)
    if not options.force:
        _refuse_loss(file, old, part)
        refuse_existing(written[1:])
    return Outputs(file, picture, old)


def write_part(
    calibration: Calibration, outputs: Outputs, part: str,
    values: Optional[Mapping[str, Any]] = None,
) -> Report:
    """
    Write the parameter file with a new part, and the picture; return the report.

    :param values: Further parameters by full name.
    """
    growth = grown(outputs.old.values if outputs.old else {},
                   {**(values or {}), **part_values(calibration)}, part)
    report = calibration.report
    report['warnings'] += growth.warnings
    kept = []
    if outputs.old is not None and part != SURFACE:
        kept = without_report(
            [line for line in outputs.old.comments if line != TITLE], report['model'])
    text = cell_text(growth.values, report_lines(report), kept)
    contents = {outputs.file: text.encode()}
    if outputs.picture is not None:
        contents[outputs.picture] = encoded_picture(outputs.picture, calibration.picture)
    backups = write_files(contents, keep_old=True)
    names = {'file': outputs.file, 'picture': outputs.picture}
    return {**report, **{name: path for name, path in names.items() if path}, 'kept': backups,
            'next': next_command(outputs.file, growth.values)}


def next_command(path: str, values: Mapping[str, Any]) -> str:
    """Return the command that comes next for a parameter file, as it can be pasted."""
    step = next_step(path, values)
    if step.arguments:
        return full_command('calibrate', *step.arguments)
    return run_command(path, step.source)


def camera_values(camera: str) -> Dict[str, Any]:
    """Return the parameters that say which camera a surface was calibrated with."""
    device = lasting_name(camera)
    values: Dict[str, Any] = {'calibration.device': device}
    if kind_of(camera).is_live:
        values['source'] = device if kind_of(device) == DEVICE else camera
    return values


def _old_file(path: str) -> Optional[ParameterFile]:
    """Read the file that is there already; None if it is not one for all nodes alone."""
    if not os.path.isfile(path):
        return None
    try:
        sections = {section.node for section in read_sections(path)}
        return read_parameter_file(path) if sections == {'/**'} else None
    except CameraToBaseError:
        return None


def _refuse_loss(path: str, old: Optional[ParameterFile], part: str) -> None:
    if old is None:
        refuse_existing([path])
        return
    lost = parts_to_lose(old.values, part)
    if lost:
        raise InvalidValueError(
            f"'{path}' exists already with {' and '.join(lost)}: name another file, or replace "
            f'{"them" if len(lost) > 1 else "it"} with --force')


def run_keep(options: argparse.Namespace) -> Report:
    """Write the file, and let the node use it."""
    single = [one.node for one in read_sections(options.file) if one.node != '/**']
    if single:
        raise InvalidValueError(
            f"'{options.file}' has parameters for single nodes ({', '.join(single)}), which would "
            'be lost: put all of them under /**')
    file = read_parameter_file(options.file)
    regular_target(options.file)
    listener = _listener(options.namespace)
    try:
        offer = OfferedCorrection(**listener.offer(_PATIENCE_S))
        text = corrected_file_text(options.file, file, offer)
        # The file first: a background that is older than its surface is not trusted.
        kept = write_files({options.file: text.encode()}, keep_old=True)
        warnings = _used(listener, offer)
    finally:
        listener.close()
    return {'kept_correction': offer.values['calibration.surface'], 'file': options.file,
            'kept': kept, 'warnings': warnings,
            'next': full_command('calibrate', 'status', '--live', options.file)}


def run_status(options: argparse.Namespace) -> Report:
    """Tell what a file holds, and what the running node offers to keep."""
    file = read_cell_file(options.file)
    report = file_status(options.file, file.values, file.comments, datetime.now().astimezone())
    report['next'] = next_command(options.file, file.values)
    if not options.live:
        return report
    listener = _listener(options.namespace)
    try:
        offer = listener.offer()
    except CameraToBaseError as error:
        return {**report, 'offer': str(error)}
    finally:
        listener.close()
    return {**report, 'offer': offer['sentence'],
            'next': full_command('calibrate', 'keep', options.file)}


def _used(listener: Any, offer: OfferedCorrection) -> list:
    try:
        listener.use(offer.values)
    except CameraToBaseError as error:
        return [f'the file is written, but {error}: restart the node with it']
    return []


def _listener(namespace: str) -> Any:
    try:
        from camera_to_base.ros import CorrectionListener
    except ModuleNotFoundError as error:
        raise InvalidValueError(
            'a running node is asked by ROS 2: source /opt/ros/jazzy/setup.bash') from error
    return CorrectionListener(namespace)
