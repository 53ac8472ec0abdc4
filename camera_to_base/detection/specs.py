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

"""The parameters of the detector, and of the background that it compares with."""

from typing import Any, Mapping

from camera_to_base.parameters import default_values, grouped, ParameterSpec

METHODS = ('tutorial', 'precise')
_LARGEST_AREA_CM2 = 1e6

BACKGROUND_SPECS = [
    ParameterSpec(
        'background_frames', 1,
        'The background is the median of this many frames; 1 takes the first one, as the '
        'tutorial does (of a camera, the first one that the next one confirms). No more are '
        'gathered than fit into 200 MB: 32 of 1920 x 1080 px.', (1, 1000)),
    ParameterSpec(
        'background_retake', 'never',
        'Whether a new background is taken when markers show that the camera stands elsewhere. '
        'never: the node waits for ~/capture_background. auto: it is taken when all markers are '
        'seen and nothing moves; what lies on the surface then is not found. Cameras only.',
        choices=('never', 'auto')),
]
DETECTOR_SPECS = [
    ParameterSpec('detector.method', 'precise',
                  "tutorial: the tutorial's result, to the pixel; precise: right to a tenth of a "
                  'pixel, also in changing light.', choices=METHODS),
    ParameterSpec('detector.threshold', 95,
                  "tutorial: a pixel whose grey level differs from the background's by more than "
                  'this belongs to an object.', (0, 255), unit='grey levels'),
    ParameterSpec('detector.closing_size', 20,
                  'tutorial: edge of the square kernel that closes gaps.', (1, 500), unit='px'),
    ParameterSpec('detector.median_size', 5,
                  "tutorial: edge of the median filter's window, odd.", (1, 99), step=2,
                  unit='px'),
    ParameterSpec('detector.faintest', 13.0,
                  'precise: least difference of an object from the surface, in one of the '
                  'colours. It must also be at least ten times the noise.',
                  (0, 255), unit='grey levels', old_names=('detector.precise_threshold',)),
    ParameterSpec('detector.min_area_cm2', 0.0,
                  'Smaller objects are not published; their area on the surface.',
                  (0, _LARGEST_AREA_CM2), unit='cm²'),
    ParameterSpec('detector.max_area_cm2', _LARGEST_AREA_CM2,
                  'Larger objects (a hand) are not published; their area on the surface.',
                  (0, _LARGEST_AREA_CM2), unit='cm²'),
    ParameterSpec('detector.split_touching', False,
                  'precise: whether convex objects that touch (coins, nuts) come as one each; '
                  'where false, nothing is taken apart.'),
    ParameterSpec('detector.publish_cut_off', False,
                  "precise: whether an object that touches the picture's edge is published; the "
                  'tutorial publishes it.'),
]
AREA_SPECS = [
    ParameterSpec(
        'work_area', [],
        'Only objects whose centre lies in this polygon are published: x and y of one corner '
        'after the other; empty for everywhere.', unit='cm', constraints='x and y in turn'),
    ParameterSpec(
        'ignored_areas', '',
        'Objects whose centre lies in one of these polygons are not published (a rail, a cable, '
        "the robot's foot): in cm, corners with , between them, polygons with ; between them.",
        constraints="such as '0 0, 5 0, 5 3; 30 0, 36 0, 36 27'"),
]
# By their names without 'detector.'.
DETECTOR_DEFAULTS: Mapping[str, Any] = grouped(default_values(DETECTOR_SPECS), 'detector.')
