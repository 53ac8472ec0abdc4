# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import array

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.spec import checked_values, ParameterSpec
from camera_to_base.settings import CAMERA_SPECS
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


@pytest.mark.parametrize('options, text', [
    ({}, ''), ({'limits': (0.5, 1e6)}, '0.5 to 1000000'), ({'unit': 'cm'}, 'in cm'),
    ({'limits': (1, 99), 'step': 2, 'unit': 'px'}, '1 to 99 px in steps of 2'),
    ({'lengths': (0, 2), 'unit': 'cm'}, '0 or 2 numbers in cm'), ({'lengths': (9,)}, '9 numbers'),
    ({'lengths': (2,), 'limits': (1, 10000), 'unit': 'px'}, '2 numbers, each 1 to 10000 px'),
    ({'choices': ('camera', 'base')}, 'one of camera, base'),
    ({'unit': 'px', 'constraints': 'u and v in turn'}, 'in px; u and v in turn')])
def test_what_a_value_must_be_is_one_text(options, text):
    assert ParameterSpec('any', 0, '', **options).constraint_text == text


@pytest.mark.parametrize('spec, value, said', [
    (ParameterSpec('size', [1, 1], '', (1, 9), lengths=(2,)), [1, 10], 'each 1 to 9, got'),
    (ParameterSpec('size', [1, 1], '', (1, 9), lengths=(2,)), [1], 'must be 2 numbers, each'),
    (ParameterSpec('size', [1, 1], '', (1, 9), lengths=(2,)), [], 'must be 2 numbers, each'),
    (ParameterSpec('size', [1, 1], '', (1, 9), lengths=(2,)), None, 'must be 2 numbers, each'),
    (ParameterSpec('lengths', [1], ''), [], 'of type list of integer'),
    (ParameterSpec('axis', [1.0], ''), [float('inf')], 'axis must be finite, got'),
    (ParameterSpec('hull', [], '', unit='px'), [float('nan')], 'hull must be finite, got'),
    (ParameterSpec('hull', [], ''), ['left'], 'hull must be of type list of double'),
    (ParameterSpec('model', 'a', '', choices=('a', 'b')), 'c', "one of a, b, got 'c'")])
def test_lists_and_texts_are_checked_as_numbers_are(spec, value, said):
    with pytest.raises(InvalidValueError, match=said):
        spec.checked(value)


@pytest.mark.parametrize('value', [array.array('d', [1.0, 2.0]), array.array('q', [1, 2]),
                                   (1, 2.0), '[1, 2.0]'])
def test_numbers_come_out_as_a_list_of_doubles_however_they_were_sent(value):
    found = ParameterSpec('hull', [], '').checked(value)
    assert found == [1.0, 2.0] and list(map(type, found)) == [float, float]


@pytest.mark.parametrize('value', [array.array('d'), array.array('q'), (), [], None])
def test_empty_list_stays_empty_however_it_was_sent(value):
    assert ParameterSpec('hull', [], '').checked(value) == []
