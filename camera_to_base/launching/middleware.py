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

"""Settings of the middleware for the camera drivers that the launch file starts."""

from typing import Dict, Mapping

_PROFILES = 'FASTRTPS_DEFAULT_PROFILES_FILE'
# With one of these, users choose profiles or transports of their own.
_CHOICES = {_PROFILES, 'FASTDDS_DEFAULT_PROFILES_FILE', 'FASTDDS_BUILTIN_TRANSPORTS'}


def driver_environment(profiles_file: str, environment: Mapping[str, str]) -> Dict[str, str]:
    """
    Give a driver enough shared memory for raw pictures; other middleware ignores the variable.

    :param profiles_file: Path of the profile for Fast DDS.
    :param environment: The environment of the launch.
    :returns: The variables to add; none where the user has chosen.
    """
    return {} if _CHOICES & set(environment) else {_PROFILES: profiles_file}
