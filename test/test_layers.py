# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The order of the rooms, and what each of them may import."""

import ast
import graphlib
import importlib
import os
from pathlib import Path
import subprocess
import sys

import camera_to_base
import pytest

PACKAGE = Path(camera_to_base.__file__).parent
# A module imports from its own room and from the faces of the rooms before it. The ground floor is
# the modules beside the rooms.
GROUND = 'ground'
ROOMS = [GROUND, 'parameters', 'uncertainty', 'surface', 'markers', 'sources', 'simulation',
         'detection', 'trust', 'drawing', 'calibration', 'settings', 'cell', 'ros', 'nodes',
         'commands', 'dashboard', 'launching']
WITH_ROS = {'ros', 'nodes', 'dashboard'}
NUMPY_AND_OPENCV_ALONE = ['surface', 'markers', 'simulation', 'detection', 'trust']
NEITHER_LOG_NOR_PRINT = ROOMS[:ROOMS.index('ros')]
# Their inner rooms are not yet entered through the faces alone.
INNER_ROOMS_ARE_OPEN = {'detection', 'trust'}
# Names of two classes each, which are still to be renamed.
NOT_YET_UNIQUE = {'Found', 'Limits'}
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


class Module:

    def __init__(self, path):
        self.path = path
        parts = path.relative_to(PACKAGE).with_suffix('').parts
        self.room = parts[0] if len(parts) > 1 or parts[0] in ROOMS else GROUND
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
FACES = {f'camera_to_base.{room}': room for room in ROOMS[1:]}
# A large room has rooms of its own.
INNER_ROOMS = [module.name for module in MODULES
               if module.path.name == '__init__.py' and module.name not in FACES]


def room_of(name):
    parts = name.split('.')
    return parts[1] if parts[1] in ROOMS else GROUND


def of_rooms(rooms):
    return [module for module in MODULES if module.room in rooms]


def test_every_folder_is_a_room_of_the_order():
    assert {module.room for module in MODULES} == set(ROOMS)


def test_a_module_imports_nothing_from_a_room_after_its_own():
    wrong = [(module.name, name) for module in MODULES for name in module.own()
             if ROOMS.index(room_of(name)) > ROOMS.index(module.room)]
    assert wrong == []


def test_other_rooms_are_entered_through_their_faces():
    wrong = [(module.name, name) for module in MODULES for name in module.own()
             if room_of(name) not in (GROUND, module.room) and name not in FACES]
    assert wrong == []


def test_no_module_enters_its_own_room_through_the_face():
    wrong = [module.name for module in MODULES if f'camera_to_base.{module.room}' in module.own()]
    assert wrong == []


def test_imports_never_go_in_a_circle():
    names = {module.name for module in MODULES}
    imports = {module.name: module.own() & names for module in MODULES}
    assert len(list(graphlib.TopologicalSorter(imports).static_order())) == len(MODULES)


def test_inner_rooms_are_entered_through_their_faces_where_these_name_something():
    faces = [name for name in INNER_ROOMS if importlib.import_module(name).__all__]
    others = [module for module in MODULES if module.room not in INNER_ROOMS_ARE_OPEN]
    wrong = [(module.name, name) for module in others for face in faces for name in module.own()
             if name.startswith(f'{face}.') and not f'{module.name}.'.startswith(f'{face}.')]
    assert wrong == []


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
    assert {name for name in names if names.count(name) > 1} <= NOT_YET_UNIQUE


def test_the_face_for_python_loads_opencv_only_where_it_is_asked_for():
    child = run_python(
        '-c', 'import sys; import camera_to_base; assert "Cell" in dir(camera_to_base); '
        'assert "cv2" not in sys.modules; from camera_to_base import Cell, Seen, SeenObject; '
        "assert 'cv2' in sys.modules and 'rclpy' not in sys.modules")
    assert child.returncode == 0, child.stderr


def test_the_core_neither_logs_nor_prints():
    for module in of_rooms(NEITHER_LOG_NOR_PRINT):
        functions = [node for node in module.tree.body
                     if not (isinstance(node, ast.FunctionDef) and node.name == 'main')]
        called = {node.func.id for function in functions for node in ast.walk(function)
                  if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
        assert 'print' not in called, module.name
        assert not module.foreign() & {'logging', 'warnings'}, module.name
        assert not {'sys.stdout', 'sys.stderr'} & {
            ast.unparse(node) for node in ast.walk(module.tree)
            if isinstance(node, ast.Attribute)}, module.name
