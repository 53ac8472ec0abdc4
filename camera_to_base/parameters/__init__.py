# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Parameters: what a parameter is, and parameter files.

In: lists of `ParameterSpec`, which each room has for its own parameters, and values from ROS, a
YAML file or the command line. Out: checked values by name, the text of a parameter file, warnings
of misspelt names, and the settings of the transform, which has no room of its own.

Callers: see the arrows in CONTRIBUTING. It does not import OpenCV: the transform node starts
without it.
"""

from camera_to_base.parameters.command_line import (
    argument_problem, file_warnings, given_warnings, gives_other_values, value_in_files)
from camera_to_base.parameters.file import (
    age_text, calibration_date, calibration_record, calibration_summary, changed_record,
    load_yaml, node_namespaces, OWN_CAMERA_SPECS, parameter_text, ParameterFile,
    read_node_parameters, read_parameter_file, read_sections, RECORD_SPECS)
from camera_to_base.parameters.spec import (
    all_names, checked_values, default_values, grouped, misspelt_name, name_warnings,
    ParameterSpec, unknown_name_text, Values, with_new_names)
from camera_to_base.parameters.transform import (
    CAMERA_FRAME_SPEC, PLACEMENT_SPECS, transform_node_settings, transform_settings,
    TRANSFORM_SETUP_SPECS, TRANSFORM_SPECS, TransformSettings)

__all__ = [
    'age_text', 'all_names', 'argument_problem', 'calibration_date', 'calibration_record',
    'calibration_summary', 'CAMERA_FRAME_SPEC', 'changed_record', 'checked_values',
    'default_values', 'file_warnings', 'given_warnings', 'gives_other_values', 'grouped',
    'load_yaml', 'misspelt_name', 'name_warnings', 'node_namespaces', 'OWN_CAMERA_SPECS',
    'parameter_text', 'ParameterFile', 'ParameterSpec', 'PLACEMENT_SPECS', 'read_node_parameters',
    'read_parameter_file', 'read_sections', 'RECORD_SPECS', 'transform_node_settings',
    'transform_settings', 'TRANSFORM_SETUP_SPECS', 'TRANSFORM_SPECS', 'TransformSettings',
    'unknown_name_text', 'value_in_files', 'Values', 'with_new_names',
]
