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

"""`calibrate keep`: the correction of a running node, written into its parameter file."""

import argparse
from datetime import datetime
from typing import Any

from camera_to_base.calibration import (
    corrected_file_text, file_status, OfferedCorrection, Report)
from camera_to_base.commands.calibrate.files import next_command, read_cell_file
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import regular_target, write_files
from camera_to_base.parameters import read_parameter_file, read_sections
from camera_to_base.shell_commands import full_command

# A hand that crosses the view, or a picture that comes late, does not end the command.
_PATIENCE_S = 2.0


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
