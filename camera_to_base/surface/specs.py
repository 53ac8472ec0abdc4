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

"""The parameters that describe how the camera looks at the work surface."""

from typing import Any, Mapping

from camera_to_base.coordinate_transform import TUTORIAL_WIDTH_CM
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE, LARGEST_SIDE
from camera_to_base.parameters import default_values, ParameterSpec
from camera_to_base.surface.distortion import LARGEST_COEFFICIENT

# An outline needs few.
MOST_CORNERS = 1000
SURFACE_MODELS = ('parallel', 'polynomial', 'homography')
_CM_PER_PX = TUTORIAL_WIDTH_CM / DEFAULT_IMAGE_SIZE[0]
_CENTRE = [(side - 1) / 2 for side in DEFAULT_IMAGE_SIZE]

SURFACE_SPECS = [
    ParameterSpec('surface.model', 'parallel',
                  'How the camera looks at the surface.', choices=SURFACE_MODELS),
    ParameterSpec('surface.image_size', list(DEFAULT_IMAGE_SIZE),
                  'Width and height of the pictures that the calibration holds for; a camera '
                  'device is asked for it when it is opened.',
                  (1, LARGEST_SIDE), unit='px', lengths=(2,)),
    ParameterSpec('surface.hull', [],
                  'The area of the picture that the calibration was measured in, for an object '
                  'outside it the node warns: u and v of one corner after the other; empty for '
                  'everywhere.', unit='px',
                  constraints=f'u and v in turn, at most {MOST_CORNERS} corners'),
    ParameterSpec('surface.reject_outside_hull', False,
                  'Leave out objects outside surface.hull instead of warning of them.'),
    ParameterSpec('surface.parallel.width_cm', TUTORIAL_WIDTH_CM,
                  "parallel: what the picture's width sees of the surface.",
                  (0.001, 100000), unit='cm'),
    ParameterSpec('surface.polynomial.y_of_v', [0.00006, -0.0833, 25.848],
                  'polynomial: coefficients of v², v and 1 (v in px), for y in cm.', lengths=(3,)),
    ParameterSpec('surface.polynomial.px_per_cm_of_y', [0.0625, -1.6393, 29.071],
                  'polynomial: coefficients of y², y and 1 (y in cm), for the scale in px/cm.',
                  lengths=(3,)),
    ParameterSpec('surface.polynomial.centre_u', 292.0,
                  'polynomial: u of the line x = 0.', (-100000, 100000), unit='px'),
    ParameterSpec('surface.homography.surface_from_pixel',
                  [_CM_PER_PX, 0.0, 0.0, 0.0, _CM_PER_PX, 0.0, 0.0, 0.0, 1.0],
                  'homography: the 3 x 3 matrix from undistorted px to cm, row by row.',
                  lengths=(9,)),
    ParameterSpec('surface.homography.distortion_coefficient', 0.0,
                  "homography: the lens's radial distortion; an undistorted pixel lies at "
                  'centre + offset / (1 + coefficient r²), r being the distance to the centre in '
                  "halves of the picture's diagonal; 0 for none.",
                  (-LARGEST_COEFFICIENT, LARGEST_COEFFICIENT)),
    ParameterSpec('surface.homography.distortion_centre', _CENTRE,
                  'homography: the centre of the distortion, u and v.', unit='px', lengths=(2,)),
    ParameterSpec('surface.camera_height_cm', 0.0,
                  'How far above the surface the camera is; 0 for not known.', (0, 100000),
                  unit='cm'),
    ParameterSpec('surface.camera_foot_cm', [],
                  'The point of the surface below the camera, x and y, in the camera frame; empty '
                  "for not known: parallel then takes what the picture's centre looks at.",
                  unit='cm', lengths=(0, 2)),
    ParameterSpec('object_height_cm', 0.0,
                  'How far above the surface the face is whose outline is seen: the '
                  "object's height, or about 0.6 of it where its sides stand out from the "
                  'surface, too; 0 for flat objects; others need surface.camera_height_cm.',
                  (0, 10000), unit='cm'),
]
SURFACE_DEFAULTS: Mapping[str, Any] = default_values(SURFACE_SPECS)
