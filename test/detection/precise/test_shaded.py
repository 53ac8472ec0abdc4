# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Whole objects in the shadow of an arm are found on their own, and shadows are not."""

import math
from pathlib import Path
import sys

from camera_to_base.detection import PreciseDifferenceDetector
import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[3] / 'benchmarks'))
import attack_scenes as scenes  # noqa: E402, I100, I202

AT = 330.0, 250.0


def whole_objects(surface, colour, coin, tip):
    table = scenes.Table(surface, np.random.default_rng(3))
    cover = scenes.arm_cover((-80, 180), tip, 50)
    detector = PreciseDifferenceDetector(table.shoot())
    frame = table.shoot(draw=[
        scenes.coin(AT, colour=coin), scenes.shadow(cover), scenes.arm(cover, colour)])
    return [one for one in detector.detect(frame) if not one.cut_off]


@pytest.mark.parametrize('surface', ['plain', 'wood', 'tiles'])
@pytest.mark.parametrize('colour', [scenes.SKINS[0], scenes.SKINS[3], (40, 42, 45)])
@pytest.mark.parametrize('coin', [(20, 24, 28), (30, 70, 200)])
def test_coin_in_the_shadow_of_an_arm_is_found_on_its_own(surface, colour, coin):
    found = whole_objects(surface, colour, coin, (262, 222))
    distances = [math.dist(one.centre, AT) for one in found]
    assert len(distances) == 1 and distances[0] < 2


@pytest.mark.parametrize('colour', [scenes.SKINS[0], (230, 235, 240), (40, 42, 45)])
def test_shadow_of_an_arm_is_no_object(colour):
    found = whole_objects('wood', colour, (20, 24, 28), (150, 200))
    assert [round(math.dist(one.centre, AT)) for one in found] == [0]
