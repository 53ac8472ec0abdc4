# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The style that ament's linters check; where they are not installed, the same by PyPI's."""

import importlib.util
from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).parents[1]
PLACES = [str(ROOT / place) for place in (
    'benchmarks', 'camera_to_base', 'examples', 'launch', 'scripts', 'setup.py', 'test')]
SOURCES = sorted(
    path for place in PLACES for path in (Path(place).rglob('*.py') if Path(place).is_dir()
                                          else [Path(place)]))
# ament_pep257's convention, and the checks that pydocstyle has beyond the pep257 one.
NOT_CHECKED = 'D100,D101,D102,D103,D104,D105,D106,D107,D203,D212,D404'
HAS_AMENT = importlib.util.find_spec('ament_flake8') is not None

with_ament = pytest.mark.skipif(not HAS_AMENT, reason='the twin below checks the same rules')
without_ament = pytest.mark.skipif(HAS_AMENT, reason="ament's own linter checks it")


def run(module, *arguments):
    linter = subprocess.run([sys.executable, '-m', module, *arguments], cwd=ROOT,
                            capture_output=True, text=True)
    return linter.returncode, linter.stdout + linter.stderr


@with_ament
def test_ament_flake8_is_content():
    from ament_flake8.main import main_with_errors
    code, errors = main_with_errors(argv=PLACES)
    assert code == 0, '\n'.join(errors)


@with_ament
def test_ament_pep257_is_content():
    from ament_pep257.main import main
    assert main(argv=PLACES) == 0


@with_ament
def test_ament_copyright_is_content():
    from ament_copyright.main import main
    assert main(argv=PLACES) == 0


@without_ament
def test_flake8_is_content():
    code, output = run('flake8', '--config', 'test/flake8.ini', *PLACES)
    assert code == 0, output


@pytest.mark.slow
@without_ament
def test_pydocstyle_is_content():
    code, output = run('pydocstyle', '--ignore', NOT_CHECKED, '--match', r'.*\.py', *PLACES)
    assert code == 0, output


def test_source_files_name_their_licence():
    for path in SOURCES:
        head = path.read_text()[:700]
        assert head.startswith('# Copyright 2'), path
        assert 'Licensed under the Apache License, Version 2.0' in head, path


def test_shell_scripts_parse():
    for path in (ROOT / 'scripts').iterdir():
        if path.is_file() and path.suffix != '.py':
            shell = subprocess.run(['bash', '-n', path], capture_output=True, text=True)
            assert shell.returncode == 0, shell.stderr
