# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.detection import random_pixel
import numpy as np


def test_random_pixels_fill_the_tutorials_range_to_both_ends():
    pixels = np.array([random_pixel() for _ in range(20_000)])
    assert (pixels.min(axis=0) == 250).all() and (pixels.max(axis=0) == 450).all()
