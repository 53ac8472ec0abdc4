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

"""Lasting names of cameras: /dev/video0 may be another camera after the next start."""

import os
import re

from camera_to_base.sources.source_kind import AUTO, DEVICE, kind_of, STREAM, TOPIC

LINKS = '/dev/v4l/by-id'


def lasting_name(name: str, links: str = LINKS) -> str:
    """
    Return a camera's lasting name.

    :param name: A device's index or path, a stream's URL, or another source.
    :param links: The folder with the links to devices.
    :returns: For a device its link there, or its path if it has none; others as they are, without
        the password of a URL.
    """
    kind = kind_of(name)
    if kind == STREAM:
        return re.sub(r'(?<=://)[^/@]*@', '', name)
    if kind != DEVICE:
        return name
    path = f'/dev/video{name}' if name.isdecimal() else name
    if path.startswith('/dev/v4l/'):
        return path
    found = [os.path.join(links, link) for link in sorted(_listed(links))]
    target = os.path.realpath(path)
    return next((link for link in found if os.path.realpath(link) == target), path)


def is_other_camera(name: str, calibrated: str) -> bool:
    """
    Return whether a source is certainly another camera than the one that was calibrated.

    A driver's topic, a recording and `auto` may show the same camera.

    :param name: The source.
    :param calibrated: The lasting name of the calibrated one.
    """
    kinds = kind_of(name), kind_of(calibrated)
    if not calibrated or any(kind == AUTO or kind == TOPIC or kind.ends for kind in kinds):
        return False
    if kinds == (DEVICE, DEVICE):
        here, there = lasting_name(name), calibrated
        return here != there and os.path.realpath(here) != os.path.realpath(there)
    return lasting_name(name) != calibrated


def _listed(folder: str) -> list:
    try:
        return os.listdir(folder)
    except OSError:
        return []
