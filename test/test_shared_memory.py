# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.files import shared_memory_environment
import pytest


def test_process_uses_the_profile_of_the_package():
    environment = {'PATH': '/usr/bin', 'ROS_DOMAIN_ID': '3'}
    assert shared_memory_environment('/opt/large.xml', environment) == {
        'FASTRTPS_DEFAULT_PROFILES_FILE': '/opt/large.xml'}


@pytest.mark.parametrize('variable', [
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
    'FASTDDS_BUILTIN_TRANSPORTS'])
def test_users_own_choice_is_left_alone(variable):
    assert shared_memory_environment('/opt/large.xml', {variable: 'chosen'}) == {}
