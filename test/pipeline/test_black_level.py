# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.pipeline.damage import DamageCheck
import numpy as np
import pytest


@pytest.mark.parametrize('level, is_black', [(5, True), (6, False)])
def test_frame_is_black_where_no_block_is_brighter_than_level_5(level, is_black):
    reason = DamageCheck().reason(np.full((48, 64, 3), level, np.uint8))
    assert (reason is not None and reason.kind == 'black') == is_black
