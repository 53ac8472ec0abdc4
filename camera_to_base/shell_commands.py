# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Commands that a user can paste into a shell, for this user's way of running the package.

Sentences of all rooms name a command in short: `calibrate board`, `~/capture_background`. Where
they are shown, :func:`with_full_commands` puts the full ones in.
"""

import os
import re
import shlex
import shutil
import sys
from typing import Optional

_PACKAGE = 'camera_to_base'
_RUN = f'ros2 run {_PACKAGE}'
_LAUNCH = f'ros2 launch {_PACKAGE} {_PACKAGE}.launch.py params_file:='
_STEPS = 'sheet|board|markers|points|base|check|status|keep'
# Not where it is full already, as after a path or `ros2 run`.
_SHORT = re.compile(rf'(?<![\w/.-])(?<!{_PACKAGE} )calibrate (?=(?:{_STEPS})\b)')
_RETAKE = '~/capture_background'
_MODULES = {'calibrate': 'calibrate.command', 'locate': 'locate'}


def full_command(executable: str, *arguments: str) -> str:
    """
    Return a command line with one of this package's executables.

    :param executable: Such as `calibrate`.
    """
    return ' '.join([_start(executable), *map(shlex.quote, arguments)])


def run_command(params_file: str, source: str) -> str:
    """
    Return the command that runs a calibrated cell: the launch, or `locate` without ROS.

    :param params_file: The file that `calibrate` has written.
    :param source: The camera.
    """
    if _has_ros2():
        return f'{_LAUNCH}{shlex.quote(params_file)}'
    return full_command('locate', source, '--params-file', params_file)


def with_full_commands(text: str, camera_node: Optional[str] = None) -> str:
    """
    Put full commands into a sentence that names them in short.

    :param camera_node: The full name of the node whose service takes a background, as in
        /camera_publisher; None where no node runs.
    """
    if camera_node is None:
        text = text.replace(f'call {_RETAKE}', 'take the background again')
    else:
        call = f'ros2 service call {camera_node}/capture_background std_srvs/srv/Trigger'
        text = text.replace(f'call {_RETAKE}', f'run: {call}').replace(_RETAKE, call)
    # A node's reader has ROS 2, wherever the node's own executable is.
    start = f'{_RUN} calibrate' if camera_node is not None else None
    return _SHORT.sub(lambda _: f'{start or _start("calibrate")} ', text)


def _has_ros2() -> bool:
    """Return whether the command `ros2` is there, and finds this package."""
    folders = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    return shutil.which('ros2') is not None and any(
        os.path.isdir(os.path.join(folder, 'lib', _PACKAGE)) for folder in folders if folder)


def _start(executable: str) -> str:
    if _has_ros2():
        return f'{_RUN} {executable}'
    started = sys.argv[0] if sys.argv else ''
    if os.path.basename(started) not in ('calibrate', 'locate'):
        return _module(executable)
    path = os.path.join(os.path.dirname(started), executable)
    found = shutil.which(executable)
    if found is not None and os.path.realpath(found) == os.path.realpath(path):
        return executable
    return shlex.quote(path)


def _module(executable: str) -> str:
    """Return how the executable is started as a module, where the package is only importable."""
    return f'{shlex.quote(sys.executable)} -m {_PACKAGE}.commands.{_MODULES[executable]}'
