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

"""Which profile of Fast DDS gives a process enough of its shared memory."""

from typing import Dict, Mapping

_PROFILES = 'FASTRTPS_DEFAULT_PROFILES_FILE'
# With one of these, users choose profiles or transports of their own.
_CHOICES = {_PROFILES, 'FASTDDS_DEFAULT_PROFILES_FILE', 'FASTDDS_BUILTIN_TRANSPORTS'}


def shared_memory_environment(
    profiles_file: str, environment: Mapping[str, str]
) -> Dict[str, str]:
    """
    Give a process the shared memory of a profile; other middleware ignores the variable.

    :param profiles_file: Path of the profile for Fast DDS.
    :param environment: The environment of the process.
    :returns: The variables to add; none where the user has chosen.
    """
    return {} if _CHOICES & set(environment) else {_PROFILES: profiles_file}
