# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Parameter files of the last release give the positions that they gave with it."""

from pathlib import Path

from camera_to_base.parameters import default_values, read_parameter_file
from camera_to_base.settings import camera_settings, CAMERA_SPECS
import numpy as np
import pytest

CONFIG = Path(__file__).parents[2] / 'config'
PIXELS = [[10, 10], [630, 20], [320, 240], [60, 470], [500, 333]]
# The surface that the README's recipe gave for the simulated camera, before tilted pictures.
HOMOGRAPHY = """
/**:
  ros__parameters:
    surface:
      model: homography
      image_size: [640, 480]
      homography:
        surface_from_pixel: [0.056250090795184206, 4.110012859944297e-07, -8.000166663064725,
          5.979574634591954e-08, 0.05622742031287336, -7.244617522079433, -1.730139800587814e-08,
          1.116001411442746e-08, 1.0000028580439744]
        distortion_coefficient: -0.0008964538746750174
        distortion_centre: [319.50052717630746, 239.50703932975486]
"""
# What the last release printed for each.
STRAIGHT = [[0.5625, 0.5625], [35.4375, 1.125], [18.0, 13.5], [3.375, 26.4375],
            [28.125, 18.73125]]
POSITIONS = {
    'homography': [[-7.45213, -6.69307], [27.45177, -6.13009], [9.99996, 6.24998],
                   [-4.63479, 19.19089], [20.12741, 11.48038]],
    'overhead_camera.yaml': STRAIGHT, 'simulated_camera.yaml': STRAIGHT,
    'tilted_camera.yaml': [[-10.37443, 25.021], [12.99462, 24.206], [1.4564, 9.312],
                           [-7.95843, -0.049], [9.17048, 4.76244]],
    'simulated_tilted_camera.yaml': [[-1.91699, -3.56315], [37.79461, -2.72099], [18.0, 13.5],
                                     [4.99412, 26.78507], [27.63976, 19.25103]]}


@pytest.mark.parametrize('name', POSITIONS)
def test_file_of_the_last_release_gives_the_same_positions(name, tmp_path):
    path = CONFIG / name
    if name == 'homography':
        path = tmp_path / 'cell.yaml'
        path.write_text(HOMOGRAPHY)
    known = {spec.name for spec in CAMERA_SPECS}
    values = {key: value for key, value in read_parameter_file(str(path)).values.items()
              if key in known}
    settings = camera_settings({**default_values(CAMERA_SPECS), **values})
    np.testing.assert_allclose(
        settings.surface.locate(np.array(PIXELS, float)), POSITIONS[name], atol=1e-5)
