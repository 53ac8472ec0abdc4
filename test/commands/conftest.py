# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the tests of the commands share: a folder of their own, and a way to run a command."""

import re

from camera_to_base.commands.calibrate.command import main as calibrate
import pytest


@pytest.fixture(scope='session')
def simulated_surface(tmp_path_factory):
    """Give the content of a file with the simulated camera's surface, which is fitted once."""
    path = tmp_path_factory.mktemp('surface') / 'cell.yaml'
    assert calibrate(['board', '--camera', 'simulated', '-o', str(path)]) == 0
    return path.read_text()


@pytest.fixture(scope='session')
def simulated_markers(simulated_surface, tmp_path_factory):
    """Give the same with the simulated markers."""
    path = tmp_path_factory.mktemp('markers') / 'cell.yaml'
    path.write_text(simulated_surface)
    assert calibrate(['markers', '--camera', 'simulated', '-o', str(path)]) == 0
    return path.read_text()


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def run_main(capsys):
    """
    Run a command's main; give exit code, standard output and standard error.

    What was captured is printed at the end, so that the report of a failed test has it.
    """
    told = []

    def run_it(main, *arguments):
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = end.code
        output, error = capsys.readouterr()
        # It is said of every picture, and is no error.
        error = re.sub(r'(?m)^looking for the board .*\n', '', error)
        told.append(f'{arguments} ended with {code}:\n{output}{error}')
        return code, output, error
    yield run_it
    print('\n'.join(told))
