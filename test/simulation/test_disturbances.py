# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.simulation.disturbances import BoardConditions, BoardDisturbances
import numpy as np
import pytest


@pytest.mark.parametrize('rounds, level', [(0.1, 200), (0.3, 150), (0.6, 200), (0.8, 150)])
def test_exposure_steps_to_and_fro_each_quarter_of_a_round(rounds, level):
    conditions = BoardConditions(exposure_step=0.75, noise=0.0)
    picture = np.full((48, 64, 3), 200, np.float32)
    BoardDisturbances((64, 48), conditions, 0).disturb(picture, 0, rounds)
    assert picture == pytest.approx(level)
