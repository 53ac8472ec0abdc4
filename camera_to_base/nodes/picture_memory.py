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

"""Shared memory for the pictures that the camera node publishes."""

import os
from typing import Optional

from camera_to_base.shared_memory import shared_memory_environment

_PROFILE = 'share/camera_to_base/config/fastdds/camera_node.xml'


def use_picture_memory() -> None:
    """
    Let Fast DDS use 8 MB of shared memory for this process, unless the user has chosen a profile.

    What a killed subscriber has not read stays in the shared memory. Of the 0.5 MB that are usual,
    it can leave no gap of the size of a JPEG picture: nobody receives another picture until the
    publisher is started again (see also issue 5469 of eProsima/Fast-DDS).
    """
    profile = _installed_profile()
    if profile is not None:
        os.environ.update(shared_memory_environment(profile, os.environ))


def _installed_profile() -> Optional[str]:
    prefixes = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    paths = (os.path.join(prefix, _PROFILE) for prefix in prefixes)
    return next(filter(os.path.isfile, paths), None)
