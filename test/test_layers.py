# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The arrows between the rooms, and what each of them may import."""

import ast
import graphlib
import importlib
import os
from pathlib import Path
import re
import subprocess
import sys

import camera_to_base
import pytest

PACKAGE = Path(camera_to_base.__file__).parent
CONTRIBUTING = Path(__file__).parents[1] / 'CONTRIBUTING.md'
WITH_ROS = {'ros', 'nodes', 'dashboard'}
NUMPY_AND_OPENCV_ALONE = {
    'surface', 'markers', 'simulation', 'detection', 'pipeline', 'fusion'}
MAY_LOG_AND_PRINT = {'ros', 'nodes', 'commands', 'dashboard', 'launching', 'executables'}
# Each is imported within the functions that need it.
HEAVY = {'matplotlib', 'rosbags', 'scipy', 'tqdm'}
ROS = {'rclpy', 'std_msgs', 'rcl_interfaces', 'sensor_msgs', 'geometry_msgs', 'diagnostic_msgs',
       'std_srvs', 'builtin_interfaces', 'visualization_msgs'}

IMPORT_WITHOUT_ROS = f"""
import importlib
import sys


class Blocker:

    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {ROS}:
            raise ImportError(name + ' is blocked')


sys.meta_path.insert(0, Blocker())
for name in sys.argv[1:]:
    importlib.import_module(name)
"""


def run_python(*arguments):
    environment = {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    return subprocess.run([sys.executable, *arguments], env=environment, capture_output=True,
                          text=True, timeout=120)


def declared_arrows():
    """Read the picture of the house: which rooms everybody may use, and each room's arrows."""
    picture = CONTRIBUTING.read_text().split('## The house')[1].split('## ')[0]
    everybody = re.search(r'^ {4}everybody +→ (.*)$', picture, re.MULTILINE).group(1)
    arrows = dict(re.findall(r'^ {4}(?!everybody)(\w+) +→ (.*)$', picture, re.MULTILINE))
    return set(everybody.split(', ')), {
        room: set(targets.split(', ')) - {'nothing else'} for room, targets in arrows.items()}


EVERYBODY, ARROWS = declared_arrows()


class Module:

    def __init__(self, path):
        self.path = path
        parts = path.relative_to(PACKAGE).with_suffix('').parts
        self.room = parts[0]
        self.name = '.'.join(['camera_to_base', *parts]).removesuffix('.__init__')
        self.tree = ast.parse(path.read_text())

    def imports(self, nodes=None):
        for node in nodes or ast.walk(self.tree):
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f'{self.name} has a relative import'
                yield node.module

    def foreign(self, nodes=None):
        return {name.split('.')[0] for name in self.imports(nodes)} - {'camera_to_base'}

    def own(self):
        return {name for name in self.imports() if name.startswith('camera_to_base.')}


MODULES = [Module(path) for path in sorted(PACKAGE.rglob('*.py'))
           if path != PACKAGE / '__init__.py']
FACES = {module.name: module.room for module in MODULES
         if module.name == f'camera_to_base.{module.room}' and module.path.name == '__init__.py'}
# A large room has rooms of its own.
INNER_ROOMS = [module.name for module in MODULES
               if module.path.name == '__init__.py' and module.name not in FACES]


def room_of(name):
    return name.split('.')[1]


def of_rooms(rooms):
    return [module for module in MODULES if module.room in rooms]


def used_rooms(room):
    return {room_of(name) for module in of_rooms({room}) for name in module.own()} - {room}


def test_picture_of_the_house_shows_every_room():
    assert {module.room for module in MODULES} == {*ARROWS, *EVERYBODY}


@pytest.mark.parametrize('room', sorted(ARROWS))
def test_a_room_imports_where_its_arrows_lead(room):
    assert used_rooms(room) - EVERYBODY == ARROWS[room]


@pytest.mark.parametrize('room', sorted(EVERYBODY))
def test_what_everybody_uses_uses_nothing_else(room):
    assert used_rooms(room) <= EVERYBODY


def test_other_rooms_are_entered_through_their_faces():
    faces = {*FACES, *(f'camera_to_base.{room}' for room in {*ARROWS, *EVERYBODY})}
    wrong = [(module.name, name) for module in MODULES for name in module.own()
             if room_of(name) != module.room and name not in faces
             and module.room != 'executables']
    assert wrong == []


def test_no_module_enters_its_own_room_through_the_face():
    wrong = [module.name for module in MODULES if f'camera_to_base.{module.room}' in module.own()]
    assert wrong == []


def test_imports_never_go_in_a_circle():
    names = {module.name for module in MODULES}
    imports = {module.name: module.own() & names for module in MODULES}
    assert len(list(graphlib.TopologicalSorter(imports).static_order())) == len(MODULES)


@pytest.mark.parametrize('room', [*FACES, *INNER_ROOMS])
def test_a_room_says_what_it_is_for_and_names_its_face(room):
    face = importlib.import_module(room)
    for part in ('In: ', 'Out: ', 'Caller'):
        assert part in face.__doc__
    modules = {module.path.stem for module in MODULES if module.name.startswith(f'{room}.')}
    assert not set(face.__all__) & modules, 'a module hides the name of the face'
    assert all(hasattr(face, name) for name in face.__all__)


def test_ros_is_imported_in_its_rooms_only():
    wrong = [module.name for module in MODULES
             if module.room not in WITH_ROS and module.foreign() & ROS]
    assert wrong == []


def test_rooms_without_ros_import_where_there_is_none():
    names = [module.name for module in MODULES if module.room not in WITH_ROS]
    child = run_python('-c', IMPORT_WITHOUT_ROS, *names)
    assert child.returncode == 0, child.stderr


def test_a_room_with_ros_does_not_import_where_there_is_none():
    child = run_python('-c', IMPORT_WITHOUT_ROS, 'camera_to_base.ros.messages')
    assert child.returncode == 1
    assert 'is blocked' in child.stderr


def test_the_web_server_is_in_the_dashboard_only():
    assert {module.room for module in MODULES if 'tornado' in module.foreign()} == {'dashboard'}


def test_the_core_imports_numpy_and_opencv_alone():
    allowed = {'numpy', 'cv2'} | sys.stdlib_module_names
    wrong = [(module.name, module.foreign() - allowed)
             for module in of_rooms(NUMPY_AND_OPENCV_ALONE) if module.foreign() - allowed]
    assert wrong == []


def test_heavy_libraries_are_imported_where_they_are_needed():
    wrong = [(module.name, name) for module in MODULES
             for name in module.foreign(module.tree.body) & HEAVY]
    assert wrong == []


def test_the_transform_node_starts_without_opencv():
    child = run_python(
        '-c', 'import sys; import camera_to_base.nodes.robot_base_publisher; '
        "sys.exit('cv2' in sys.modules)")
    assert child.returncode == 0, child.stderr


def test_no_two_classes_have_one_name():
    names = [node.name for module in MODULES for node in module.tree.body
             if isinstance(node, ast.ClassDef)]
    assert {name for name in names if names.count(name) > 1} == set()


def test_the_face_for_python_loads_opencv_only_where_it_is_asked_for():
    child = run_python(
        '-c', 'import sys; import camera_to_base; assert "Cell" in dir(camera_to_base); '
        'assert "cv2" not in sys.modules; from camera_to_base import Cell, Seen, SeenObject; '
        "assert 'cv2' in sys.modules and 'rclpy' not in sys.modules")
    assert child.returncode == 0, child.stderr


def test_the_core_neither_logs_nor_prints():
    for module in MODULES:
        if module.room in MAY_LOG_AND_PRINT:
            continue
        functions = [node for node in module.tree.body
                     if not (isinstance(node, ast.FunctionDef) and node.name == 'main')]
        called = {node.func.id for function in functions for node in ast.walk(function)
                  if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
        assert 'print' not in called, module.name
        assert not module.foreign() & {'logging', 'warnings'}, module.name
        assert not {'sys.stdout', 'sys.stderr'} & {
            ast.unparse(node) for node in ast.walk(module.tree)
            if isinstance(node, ast.Attribute)}, module.name
