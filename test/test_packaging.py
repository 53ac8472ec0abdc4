# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The package as pip and colcon install it; nothing is downloaded."""

import ast
from configparser import ConfigParser
from email.parser import Parser
import importlib.util
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[1]
INSTALLED = ['LICENSE', 'camera_to_base', 'config', 'examples', 'launch', 'package.xml',
             'resource', 'setup.cfg', 'setup.py']
EXECUTABLES = {'calibrate', 'camera_fusion', 'camera_publisher', 'dashboard', 'locate',
               'robot_base_publisher', 'robotic_arm_publishing_subscriber'}
MODULES = sorted(
    '.'.join(path.relative_to(ROOT).with_suffix('').parts).removesuffix('.__init__')
    for path in (ROOT / 'camera_to_base').rglob('*.py'))
# The distribution that brings what is imported; those of ROS 2 bring rclpy and the messages.
# Used where a user has installed it; there is no wheel.
OPTIONAL = {'vision_msgs'}
DISTRIBUTIONS = {
    'cv2': 'opencv-python-headless', 'matplotlib': 'matplotlib', 'numpy': 'numpy',
    'rosbags': 'rosbags', 'scipy': 'scipy', 'tornado': 'tornado', 'tqdm': 'tqdm',
    'yaml': 'PyYAML'}
ROS = {'builtin_interfaces', 'diagnostic_msgs', 'geometry_msgs', 'rcl_interfaces', 'rclpy',
       'sensor_msgs', 'std_msgs', 'std_srvs', 'visualization_msgs'}

IMPORT_ALL = """
import importlib
import sys

place = sys.argv[1]
for name in sys.argv[2:]:
    module = importlib.import_module(name)
    assert module.__file__.startswith(place), module.__file__
"""

WITHOUT_ROS = """
import sys

from camera_to_base import executables


class Blocker:

    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in %s:
            raise ModuleNotFoundError(f'No module named {name!r}', name=name)


sys.meta_path.insert(0, Blocker())
sys.argv = sys.argv[1:]
sys.exit(getattr(executables, sys.argv[0])())
""" % ROS

needs_wheel = pytest.mark.skipif(
    not any(map(importlib.util.find_spec, ('wheel', 'setuptools.command.bdist_wheel'))),
    reason='wheel is not installed')
needs_colcon = pytest.mark.skipif(not shutil.which('colcon'), reason='colcon is not installed')


def run(*command, **options):
    child = subprocess.run(command, capture_output=True, text=True, timeout=300, **options)
    assert child.returncode == 0, child.stdout + child.stderr
    return child.stdout


@pytest.fixture(scope='module')
def source(tmp_path_factory):
    """Copy what is installed: a build writes beside it."""
    source = tmp_path_factory.mktemp('source') / 'camera_to_base'
    source.mkdir()
    for name in INSTALLED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, source / name,
                            ignore=shutil.ignore_patterns('__pycache__'))
        else:
            shutil.copy(ROOT / name, source)
    return source


@pytest.fixture(scope='module')
def wheel(source, tmp_path_factory):
    """Build the wheel with the function that `pip install .` calls."""
    place = tmp_path_factory.mktemp('wheel')
    run(sys.executable, '-c', 'import sys; from setuptools.build_meta import __legacy__; '
        '__legacy__.build_wheel(sys.argv[1])', place, cwd=source)
    path, = place.glob('*.whl')
    with ZipFile(path) as wheel:
        yield wheel


def content(wheel, name):
    """Read a file of the wheel's .dist-info."""
    path, = (path for path in wheel.namelist() if path.endswith(f'.dist-info/{name}'))
    return wheel.read(path).decode()


def requirements(wheel):
    """Give the names of the required distributions by the extra that asks for them, or None."""
    required = {}
    for line in Parser().parsestr(content(wheel, 'METADATA')).get_all('Requires-Dist'):
        name, _, condition = line.partition(';')
        extra = re.search('extra == ["\'](.*)["\']', condition)
        required.setdefault(extra and extra[1], set()).add(name.strip())
    return required


def imported():
    """Give the packages that are imported anywhere and come from other distributions."""
    names = set()
    for path in (ROOT / 'camera_to_base').rglob('*.py'):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split('.')[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add(node.module.split('.')[0])
    return names - sys.stdlib_module_names - {'camera_to_base'} - OPTIONAL


@pytest.mark.slow
@needs_wheel
def test_wheel_requires_what_is_imported_and_nothing_else(wheel):
    required = requirements(wheel)
    assert required['ros'] == {'ros-jazzy-rclpy[fastrtps]', 'ros-jazzy-common-interfaces'}
    assert required['bags'] == {'rosbags'}
    assert imported() - DISTRIBUTIONS.keys() == ROS
    assert required[None] | required['bags'] == {
        DISTRIBUTIONS[name] for name in imported() - ROS}


@needs_wheel
def test_wheel_holds_each_module_and_what_ros_looks_for(wheel):
    files = {name for name in wheel.namelist() if '.dist-info/' not in name}
    modules = {name for name in files if name.startswith('camera_to_base/')}
    page = [path for path in (ROOT / 'camera_to_base/dashboard/web').rglob('*') if path.is_file()]
    assert modules == {str(path.relative_to(ROOT)) for path in (
        *(ROOT / 'camera_to_base').rglob('*.py'), *page)}
    shared = {name.partition('.data/data/share/')[2] for name in files - modules}
    assert 'ament_index/resource_index/packages/camera_to_base' in shared
    for folder, pattern in (('config', '*.yaml'), ('config', '*.rviz'), ('config', 'sros2/*.xml'),
                            ('examples', '*.py'), ('launch', '*.py')):
        paths = list((ROOT / folder).glob(pattern))
        assert paths
        assert {f'camera_to_base/{path.relative_to(ROOT)}' for path in paths} <= shared
    # In particular no script in lib/camera_to_base, where colcon wants them: pip makes its own.
    assert all(name.startswith(('ament_index/', 'camera_to_base/')) for name in shared)


@needs_wheel
def test_licences_of_what_others_wrote_are_there_and_in_package_xml(wheel):
    manifest = (ROOT / 'package.xml').read_text()
    folders = list((ROOT / 'camera_to_base/dashboard/web/vendor').iterdir())
    assert folders
    for folder in folders:
        licence = str((folder / 'LICENSE').relative_to(ROOT))
        assert licence in wheel.namelist() and f'file="{licence}"' in manifest


@needs_wheel
def test_wheel_has_all_executables_for_pip_to_make(wheel):
    parser = ConfigParser()
    parser.read_string(content(wheel, 'entry_points.txt'))
    assert set(parser['console_scripts']) == EXECUTABLES


@needs_wheel
def test_wheel_has_the_version_and_description_of_package_xml(wheel):
    metadata = Parser().parsestr(content(wheel, 'METADATA'))
    manifest = (ROOT / 'package.xml').read_text()
    for key, tag in (('Version', 'version'), ('Summary', 'description'), ('License', 'license')):
        assert re.search(f'<{tag}[^>]*>(.*)</{tag}>', manifest)[1] == metadata[key]
    assert metadata['Requires-Python'] == '>=3.10'


@pytest.fixture(scope='module')
def installed(source, tmp_path_factory):
    """Build the package with colcon, as a user's workspace does, and give the install space."""
    place = tmp_path_factory.mktemp('workspace')
    assert 'ros.ament_python' in run('colcon', 'list', '--base-paths', source, cwd=place)
    run('colcon', '--log-base', place / 'log', 'build', '--base-paths', source, cwd=place)
    return place / 'install/camera_to_base'


@needs_colcon
def test_each_module_can_be_imported_where_colcon_installs_it(installed):
    path, = installed.glob('**/camera_to_base/__init__.py')
    paths = [str(path.parents[1]), *filter(None, sys.path)]
    run(sys.executable, '-c', IMPORT_ALL, path.parent, *MODULES, cwd=installed,
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(paths)})


@needs_colcon
def test_ros_finds_the_executables_where_colcon_installs_them(installed):
    assert {path.name for path in (installed / 'lib/camera_to_base').iterdir()} == EXECUTABLES


@pytest.mark.parametrize('name', ['camera_publisher', 'robot_base_publisher'])
def test_node_without_ros_says_what_to_install(name):
    child = subprocess.run([sys.executable, '-c', WITHOUT_ROS, name], cwd=ROOT, text=True,
                           capture_output=True, timeout=60)
    assert child.returncode == 1
    assert 'ROS 2 is missing' in child.stderr and "pip install '.[ros]'" in child.stderr
    assert len(child.stderr.splitlines()) == 1
