# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The script that follows README: it finds the commands, and notices one that is gone."""

from pathlib import Path

import first_hour
from first_hour import commands_of, CONTROL_CODES, Failure, judge, STEPS
import pytest

README = Path(__file__).parents[1] / 'README.md'


def test_each_command_of_readme_is_known_and_in_its_order():
    commands = commands_of(README.read_text())
    assert commands[:2] == ['scripts/demo', 'scripts/test']
    assert all(any(one.startswith(start) for start, _ in STEPS) for one in commands)
    assert commands.index('colcon build') < commands.index('source install/setup.bash')


@pytest.mark.parametrize('start', [start for start, _ in STEPS])
def test_command_that_is_gone_from_readme_is_an_error(start, tmp_path, monkeypatch, capsys):
    lines = README.read_text().splitlines(True)
    (tmp_path / 'README.md').write_text(
        ''.join(line for line in lines if not line.strip().startswith(start)))
    monkeypatch.setattr(first_hour, 'ROOT', tmp_path)
    assert first_hour.main([]) == 1
    assert start in capsys.readouterr().err


@pytest.mark.parametrize('count, largest_mm', [(0, float('inf')), (9, 0.1), (100, 1.2)])
def test_few_or_wrong_positions_are_an_error(count, largest_mm):
    with pytest.raises(Failure):
        judge(count, largest_mm)
    judge(100, 0.1)


def test_colours_are_no_part_of_what_a_command_says():
    assert CONTROL_CODES.sub('', '\x1b[1mTouch\x1b[0m its middle: \x1b[K') == 'Touch its middle: '
