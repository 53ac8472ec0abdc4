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

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameter_spec import checked_values, meant_name, ParameterSpec
from camera_to_base.settings.camera import CAMERA_SPECS
import pytest

SPECS = [
    ParameterSpec('count', 1, '', (1, 9)),
    ParameterSpec('odd', 5, '', (1, 99), step=2),
    ParameterSpec('length', 3.0, '', (0.5, 10)),
    ParameterSpec('source', 'auto', ''),
    ParameterSpec('on', False, ''),
    ParameterSpec('corner', [1.0, 2.0], ''),
    ParameterSpec('hull', [], '')]


def test_what_is_not_given_has_its_default_and_other_names_are_left_out():
    assert checked_values(SPECS, {'other': 1}) == {spec.name: spec.default for spec in SPECS}


@pytest.mark.parametrize('given, value', [
    ({'length': 2}, 2.0), ({'source': 0}, '0'), ({'corner': [3, 4]}, [3.0, 4.0]),
    ({'hull': None}, []), ({'hull': [1.5, 2.5]}, [1.5, 2.5]), ({'odd': 99}, 99), ({'odd': 1}, 1),
    ({'corner': '[6e-05, -3]'}, [6e-05, -3.0]), ({'hull': '[1, 2.5]'}, [1.0, 2.5])])
def test_what_is_given_is_converted_as_the_nodes_do(given, value):
    (name, _), = given.items()
    found = checked_values(SPECS, given)[name]
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize('given, said', [
    ({'count': 10}, 'parameter count must be 1 to 9, got 10'),
    ({'count': 0}, 'parameter count must be 1 to 9, got 0'),
    ({'odd': 4}, 'parameter odd must be 1 to 99 in steps of 2, got 4'),
    ({'length': float('nan')}, 'parameter length must be 0.5 to 10, got nan'),
    ({'count': 1.0}, 'parameter count must be of type integer, got 1.0 of type double'),
    ({'length': 10**400}, 'parameter length must be of type double, got a whole number of more'),
    ({'corner': [0, 10**400]}, 'parameter corner must be of type list of double, got a whole'),
    ({'on': 1}, 'parameter on must be of type bool, got 1 of type integer'),
    ({'corner': 'left'}, 'parameter corner must be of type list of double')])
def test_what_a_node_would_refuse_is_refused(given, said):
    with pytest.raises(InvalidValueError, match=said):
        checked_values(SPECS, given)


def test_defaults_of_the_camera_node_pass_their_own_check():
    defaults = {spec.name: spec.default for spec in CAMERA_SPECS}
    assert checked_values(CAMERA_SPECS, defaults) == defaults


def test_misspelt_name_is_recognized_and_a_foreign_one_is_not():
    names = [spec.name for spec in CAMERA_SPECS]
    assert meant_name('detector.treshold', names) == 'detector.threshold'
    assert meant_name('pixel_format', names) is None
