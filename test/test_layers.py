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

import ast
import graphlib
import os
from pathlib import Path
import subprocess
import sys

import camera_to_base
import pytest

PACKAGE = Path(camera_to_base.__file__).parent
MODULES = sorted(path.stem for path in PACKAGE.glob('*.py') if path.stem != '__init__')
# The design's arrows, from left to right: a module imports from its own room or from one
# before it; nothing imports a node or a command.
NODES_AND_COMMANDS = {'camera_publisher', 'robot_base_publisher', 'calibrate', 'locate'}
# What is installed: nothing imports it, and it imports the nodes.
EXECUTABLES = {'executables'}
ROOMS = [
    {'errors', 'health', 'interrupt', 'node_help', 'parameter_spec', 'surface_specs'},
    {'checks'},
    {'absolute_difference', 'background', 'board_conditions', 'board_disturbances',
     'board_drawing', 'board_view', 'cameras', 'coordinate_transform', 'detection', 'distortion',
     'frame_sources', 'ghosts', 'hull', 'image_decoding', 'precise_difference', 'raised_surface',
     'shape', 'simulated_board', 'simulated_chessboard', 'surface', 'video_capture', 'yaw'},
    {'background_taker', 'damage_check', 'detector_settings', 'files', 'frame_blocks', 'freshness',
     'jump_filter', 'matched_points', 'object_locator', 'overlay', 'reader_status',
     'surface_parameters', 'view_check'},
    {'background_file', 'camera_pose', 'figures', 'frame_reader', 'held_back', 'homography_fit',
     'least_squares', 'picture_keeper', 'polynomial_fit', 'position_gate', 'random_pixels',
     'recording', 'rigid_fit', 'silence_limit'},
    {'annotated_video', 'bag_file', 'board', 'board_frame', 'board_squares', 'calibrate_options',
     'camera_info_file', 'camera_pipeline', 'command_parser', 'parameter_file', 'report_picture',
     'report_text', 'simulation_parameters', 'still_picture', 'tables', 'top_view'},
    {'calibration', 'camera_health', 'camera_parameters', 'launch_arguments', 'launch_cameras',
     'locate_options', 'named_source', 'node_settings', 'position_table', 'sighting_counter',
     'sweep', 'sweep_picture', 'transform_parameters'},
    {'heartbeat', 'image_messages', 'lifetime', 'messages', 'parameters'},
    {'background_keeper', 'background_service', 'debug_images', 'diagnostics', 'frame_feeds',
     'image_topic', 'name_check', 'position_topics', 'qos_check', 'true_positions'},
    {'camera_watch'},
    NODES_AND_COMMANDS,
    EXECUTABLES,
]
# Free of ROS, but it reads YAML or bags, or is the command line.
COMMAND_LINE = ['bag_file', 'calibrate', 'calibrate_options', 'camera_info_file',
                'launch_arguments', 'launch_cameras', 'locate', 'locate_options',
                'node_settings', 'parameter_file']
PURE = sorted((set.union(*ROOMS[:7]) - {*COMMAND_LINE}) & set(MODULES))
ROS = {'rclpy', 'std_msgs', 'rcl_interfaces', 'sensor_msgs', 'geometry_msgs', 'diagnostic_msgs',
       'std_srvs', 'builtin_interfaces'}

IMPORT_WITHOUT_ROS = f"""
import importlib
import sys


class Blocker:

    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {ROS}:
            raise ImportError(name + ' is blocked')


sys.meta_path.insert(0, Blocker())
importlib.import_module(sys.argv[1])
"""


def import_without_ros(module):
    environment = {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    return subprocess.run(
        [sys.executable, '-c', IMPORT_WITHOUT_ROS, f'camera_to_base.{module}'],
        env=environment, capture_output=True, text=True, timeout=60)


def tree_of(module):
    return ast.parse((PACKAGE / f'{module}.py').read_text())


def imports_of(module):
    """Give the full names that a module imports, wherever in the file it does so."""
    for node in ast.walk(tree_of(module)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            origin = 'camera_to_base' if node.level else node.module
            if node.level and node.module:
                origin += f'.{node.module}'
            if origin == 'camera_to_base':
                yield from (f'{origin}.{alias.name}' for alias in node.names)
            else:
                yield origin


def own_imports_of(module):
    return {name.split('.')[1] for name in imports_of(module)
            if name.startswith('camera_to_base.')}


def foreign_imports_of(module):
    return {name.split('.')[0] for name in imports_of(module)} - {'camera_to_base'}


def room_of(module):
    return next(number for number, room in enumerate(ROOMS) if module in room)


@pytest.mark.parametrize('module', PURE + COMMAND_LINE)
def test_module_without_ros_imports_where_there_is_none(module):
    child = import_without_ros(module)
    assert child.returncode == 0, child.stderr


def test_module_of_messages_does_not_import_where_there_is_no_ros():
    child = import_without_ros('messages')
    assert child.returncode == 1
    assert '_msgs is blocked' in child.stderr


@pytest.mark.parametrize('module', PURE)
def test_pure_module_imports_numpy_opencv_and_pure_modules_only(module):
    assert foreign_imports_of(module) <= {'numpy', 'cv2'} | sys.stdlib_module_names
    assert own_imports_of(module) <= set(PURE)


@pytest.mark.parametrize('module', PURE)
def test_pure_module_neither_logs_nor_prints(module):
    functions = [node for node in tree_of(module).body
                 if not (isinstance(node, ast.FunctionDef) and node.name == 'main')]
    called = {node.func.id for function in functions for node in ast.walk(function)
              if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert 'print' not in called
    assert not foreign_imports_of(module) & {'logging', 'warnings', 'sys'}


def test_every_module_has_a_room():
    assert set(MODULES) <= set.union(*ROOMS)


@pytest.mark.parametrize('module', MODULES)
def test_module_imports_nothing_from_a_room_after_its_own(module):
    assert [name for name in own_imports_of(module) if room_of(name) > room_of(module)] == []


@pytest.mark.parametrize('module', sorted(set(MODULES) - EXECUTABLES))
def test_nothing_imports_a_node_or_a_command(module):
    assert not own_imports_of(module) & (NODES_AND_COMMANDS | EXECUTABLES)


def test_imports_never_go_in_a_circle():
    imports = {module: own_imports_of(module) for module in MODULES}
    assert len(list(graphlib.TopologicalSorter(imports).static_order())) == len(MODULES)


def test_only_the_modules_of_ros_import_ros():
    assert not set(PURE) & {module for module in MODULES
                            if foreign_imports_of(module) & ROS}
    assert foreign_imports_of('messages') & ROS == {'geometry_msgs', 'std_msgs'}
    assert foreign_imports_of('image_messages') & ROS == {'sensor_msgs', 'std_msgs'}
