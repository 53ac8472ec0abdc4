# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import ast
import inspect
from pathlib import Path

import camera_to_base
from camera_to_base import errors
from camera_to_base.errors import CameraToBaseError, InvalidValueError
import pytest

FAMILY = {name: one for name, one in inspect.getmembers(errors, inspect.isclass)
          if issubclass(one, CameraToBaseError)}
# What the dashboard answers to a page, and what a node has answered to the dashboard.
ANSWERS = {'Refused', 'RefusedError'}
# What the type of an option raises; argparse makes the command's one sentence of it.
TO_ARGPARSE = {'argparse.ArgumentError', 'argparse.ArgumentTypeError'}
# The package's own `__getattr__` raises AttributeError, as Python asks for.
SOURCES = sorted({*Path(camera_to_base.__file__).parent.rglob('*.py')}
                 - {Path(camera_to_base.__file__)})


def raised_calls(source):
    return [node.exc for node in ast.walk(ast.parse(source.read_text()))
            if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)]


def raised_names(source):
    # A name in lower case is a caught error that is raised again.
    return [node.exc.id for node in ast.walk(ast.parse(source.read_text()))
            if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Name)
            and not node.exc.id.islower()]


@pytest.mark.parametrize('error', FAMILY.values(), ids=FAMILY)
def test_one_except_catches_every_error_of_the_package(error):
    with pytest.raises(CameraToBaseError, match='what failed'):
        raise error('what failed')


def test_value_that_cannot_be_used_is_a_value_error_too():
    with pytest.raises(ValueError):
        raise InvalidValueError('what failed')


@pytest.mark.slow
def test_modules_raise_errors_of_the_family_with_a_text():
    for source in SOURCES:
        for call in raised_calls(source):
            assert ast.unparse(call.func) in {*FAMILY, *ANSWERS, *TO_ARGPARSE}, source
            assert call.args, source
        assert set(raised_names(source)) <= {'NotImplementedError'}, source


def test_package_raises_something_at_all():
    assert sum(len(raised_calls(source)) for source in SOURCES) > 10
