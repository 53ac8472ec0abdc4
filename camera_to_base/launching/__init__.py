# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What the launch file asks: which cameras to start, and with which arguments.

In: launch arguments, and the parameter file that they name. Out: parameters, remappings, command
lines and environment of the processes to start, and warnings of arguments that do not exist.

Caller: `launch/camera_to_base.launch.py`.
"""

from camera_to_base.launching.cameras import (
    choose_cameras, DRIVERS, is_fused, LaunchedCamera, make_params_file, read_cameras)
from camera_to_base.launching.nodes import (
    argument_warnings, check_frames, driver_parameters, Frames, frames, fusion_parameters,
    given_parameters, image_input, ImageInput, is_wanted, kept_background, not_installed,
    parameter, plays_recording, recording_failure, transform_arguments, unknown_arguments)

__all__ = [
    'argument_warnings', 'check_frames', 'choose_cameras', 'driver_parameters', 'DRIVERS',
    'Frames', 'frames', 'fusion_parameters', 'given_parameters', 'image_input', 'ImageInput',
    'is_fused', 'is_wanted', 'kept_background', 'LaunchedCamera', 'make_params_file',
    'not_installed', 'parameter', 'plays_recording', 'read_cameras', 'recording_failure',
    'transform_arguments', 'unknown_arguments',
]
