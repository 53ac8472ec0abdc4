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


from pathlib import Path
import sys

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / 'benchmarks'))
import attack  # noqa: E402, I100

STRUCTURED = [name for name in attack.scenes.SURFACES if name not in ('parallel lines', 'plain')]


def play(seed, tell):
    """Play a day with a bump and one with a hand; both know the truth."""
    tell(f'random day {seed}')
    random = np.random.default_rng(seed)
    bumped = attack.day_with_bumps(random.choice(STRUCTURED), random)
    assert bumped['wrong'] == 0 and bumped['stopped'] == 0, (seed, bumped)
    touched = attack.day_with_hand(random)
    assert touched['wrong'] == 0, (seed, touched)
    # A coin that is free is published, but for the frames that confirm it and a second after.
    assert touched['free'] - touched['free seen'] <= attack.FRAMES_PER_S, (seed, touched)


@pytest.mark.parametrize('seed', range(2))
def test_random_day_publishes_nothing_wrong(seed, tell):
    play(seed, tell)


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(2, 40))
def test_many_random_days_publish_nothing_wrong(seed, tell):
    play(seed, tell)
