# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The page of the parameters is made from the parameters."""

import importlib.util
from pathlib import Path

from camera_to_base.parameters.spec import ParameterSpec
import pytest

SCRIPT = Path(__file__).parents[1] / 'scripts' / 'make_docs.py'


@pytest.fixture(scope='module')
def make_docs():
    spec = importlib.util.spec_from_file_location('make_docs', SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_page_of_the_parameters_is_up_to_date(make_docs):
    text = make_docs.PAGE.read_text(encoding='utf-8')
    assert make_docs.with_tables(text) == text, 'run scripts/make_docs'


def test_every_parameter_of_both_nodes_has_one_row(make_docs):
    sections = make_docs.tables().split('## robot_base_publisher')
    for specs, section in zip(make_docs.NODES.values(), sections):
        for spec in specs:
            assert section.count(f'\n| `{spec.name}` |') == 1


@pytest.mark.parametrize('spec, row', [
    (ParameterSpec('a.b', 5, 'Odd.', (1, 99), step=2, unit='px'),
     '| `a.b` | `5` | px | 1 to 99 in steps of 2 | Odd. | can be changed |'),
    (ParameterSpec('file', '', 'A file.', fixed=True), '| `file` | empty | | | A file. | fixed |'),
    (ParameterSpec('hull', [], 'An area.', unit='px', constraints='u and v in turn'),
     '| `hull` | `[]` | px | u and v in turn | An area. | can be changed |'),
    (ParameterSpec('foot', [], 'A point.', unit='cm', lengths=(0, 2)),
     '| `foot` | `[]` | cm | 0 or 2 numbers | A point. | can be changed |'),
    (ParameterSpec('on', True, 'Whether.'), '| `on` | `true` | | | Whether. | can be changed |')])
def test_row_says_all_of_a_parameter(make_docs, spec, row):
    assert make_docs.table([spec]).splitlines()[-1] == row


def test_text_around_the_tables_stays(make_docs):
    page = make_docs.with_tables(
        f'# Before\n{make_docs.BEGIN}\nold\n{make_docs.END}\nafter\n')
    assert page.startswith(f'# Before\n{make_docs.BEGIN}\n## camera_publisher\n')
    assert page.endswith(f'\n{make_docs.END}\nafter\n') and '\nold\n' not in page


def test_check_tells_a_page_that_is_not_up_to_date_and_changes_nothing(
        make_docs, tmp_path, monkeypatch, capsys):
    page = tmp_path / 'parameters.md'
    page.write_text(f'{make_docs.BEGIN}\n{make_docs.END}\n')
    monkeypatch.setattr(make_docs, 'PAGE', page)
    assert make_docs.main(['--check']) == 1
    assert 'run scripts/make_docs' in capsys.readouterr().err
    assert page.read_text() == f'{make_docs.BEGIN}\n{make_docs.END}\n'
    assert make_docs.main([]) == 0 and make_docs.main(['--check']) == 0
