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

"""Launch arguments: misspelt names, yes or no, and the packages that they need."""

from typing import Collection, Iterable, List

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import misspelt_name, unknown_name_text

# Arguments that launch and launch_ros use themselves.
_OF_LAUNCH = {'emulate_tty', 'launch-prefix', 'launch-prefix-filter', 'ros_namespace'}


def unknown_arguments(
        given: Iterable[str], known: Collection[str], ours_alone: bool) -> List[str]:
    """
    List unknown arguments, which launch ignores: a default would be used instead.

    :param given: The names of all arguments of the launch.
    :param known: The names of ours.
    :param ours_alone: Whether all arguments are meant for this launch file; otherwise only names
        that look misspelt are listed.
    """
    unknown = (name for name in given if name not in {*known, *_OF_LAUNCH})
    return [name for name in unknown if ours_alone or misspelt_name(name, known)]


def argument_warnings(
        given: Iterable[str], known: Collection[str], ours_alone: bool) -> List[str]:
    """Warn of unknown arguments, see `unknown_arguments`."""
    return [unknown_name_text(name, misspelt_name(name, known), 'launch argument')
            for name in unknown_arguments(given, known, ours_alone)]


def is_wanted(name: str, value: str) -> bool:
    """
    Read a launch argument that is true or false.

    :raises InvalidValueError: If it is neither.
    """
    if value.lower() not in ('true', 'false'):
        raise InvalidValueError(f"{name} must be true or false, got '{value}'")
    return value.lower() == 'true'


def not_installed(package: str, argument: str, distribution: str) -> str:
    """
    Say that a package is missing, and what to do.

    :param argument: The launch argument that asks for it, as it was written.
    :param distribution: The ROS distribution, 'jazzy'.
    """
    return (f'{argument} needs the package {package}, which is not installed: '
            f"sudo apt install ros-{distribution}-{package.replace('_', '-')}")
