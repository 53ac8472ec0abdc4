# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.parameters.spec import (
    all_names, meant_name, name_warnings, ParameterSpec, with_new_names)
from camera_to_base.parameters.transform import TRANSFORM_SPECS
from camera_to_base.settings import CAMERA_SPECS
import pytest

NAMES = all_names([*CAMERA_SPECS, *TRANSFORM_SPECS])
RENAMED = [ParameterSpec('view.check_period', 2.0, '', old_names=('check_period', 'period_s')),
           ParameterSpec('reach_cm', 1.0, '')]


@pytest.mark.parametrize('name, meant', [
    ('detector.treshold', 'detector.threshold'), ('reach', 'reach_cm'),
    ('threshold', 'detector.threshold'), ('width_cm', 'surface.parallel.width_cm'),
    ('width', 'surface.parallel.width_cm'), ('surface', 'surface.model'),
    ('view.threshold', 'detector.threshold'), ('treshold', 'detector.threshold'),
    ('foo', None), ('pixel_format', None), ('', None)])
def test_the_name_that_was_meant_is_found(name, meant):
    assert meant_name(name, NAMES) == meant


def test_parameter_of_the_other_node_is_not_taken_for_a_similar_one():
    assert meant_name('surface.pinhole.rotation', all_names(TRANSFORM_SPECS)) is None


def test_no_name_of_ours_and_of_every_ros_node_is_warned_of():
    ros = ['use_sim_time', 'start_type_description_service', 'qos_overrides./mask.publisher.depth']
    assert name_warnings([*NAMES, *ros], NAMES) == []
    assert name_warnings(['use_sim_times'], NAMES) == [
        "there is no parameter 'use_sim_times', it is left out"]


def test_renamed_parameter_is_taken_under_its_old_names_with_a_warning():
    values, warnings = with_new_names(RENAMED, {'check_period': 3.0, 'reach_cm': 2.0, 'foo': 1})
    assert values == {'view.check_period': 3.0, 'reach_cm': 2.0, 'foo': 1}
    warning, = warnings
    assert warning.startswith("parameter 'check_period' is called 'view.check_period' now")


def test_new_name_holds_where_both_are_given():
    values, warnings = with_new_names(RENAMED, {'view.check_period': 4.0, 'period_s': 3.0})
    assert values == {'view.check_period': 4.0} and len(warnings) == 1


def test_old_name_is_none_of_another_parameter():
    # Both nodes take the placement, the camera frame's name and the record of the calibration.
    assert len(NAMES) == len(set(NAMES)) + 6
