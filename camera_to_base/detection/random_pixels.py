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

"""The tutorial's stand-in for a camera: random pixels."""

import random

from camera_to_base.detection.detection import Pixel

# The tutorial draws them from this range in both directions.
_LOWEST, _HIGHEST = 250, 450


def random_pixel() -> Pixel:
    """Draw a pixel from the tutorial's range."""
    return Pixel(*(random.randint(_LOWEST, _HIGHEST) for _ in 'uv'))
