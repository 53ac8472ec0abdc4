# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""README's animated picture is small, and its script makes it."""

import importlib.util
from pathlib import Path

from PIL import Image
import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope='module')
def make_animation():
    spec = importlib.util.spec_from_file_location(
        'make_animation', ROOT / 'scripts' / 'make_animation.py')
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_picture_of_the_readme_is_small_and_moves(make_animation):
    assert make_animation.PICTURE.stat().st_size < 2_000_000
    with Image.open(make_animation.PICTURE) as animation:
        assert animation.n_frames == make_animation.FRAMES


@pytest.mark.slow
def test_script_shows_each_position_to_a_tenth_of_a_millimetre(make_animation, tmp_path):
    base = make_animation.BASE
    shots = list(make_animation.shots(3, base))
    assert [len(shot.objects) for shot in shots][-1] == 3
    assert all(shot.largest_error_cm < 0.01 for shot in shots if shot.objects)
    path = tmp_path / 'cell.gif'
    assert make_animation.main(['-o', str(path), '--frames', '3']) == 0
    with Image.open(path) as animation:
        assert animation.n_frames == 3
