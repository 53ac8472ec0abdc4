# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The sessions know neither of ROS nor of the web server."""

import ast
from pathlib import Path

import camera_to_base.dashboard.sessions as sessions

ROOM = Path(sessions.__file__).parent
ALLOWED = ('camera_to_base.dashboard.sessions.', 'camera_to_base.calibration',
           'camera_to_base.checks', 'camera_to_base.detection', 'camera_to_base.errors',
           'camera_to_base.files', 'camera_to_base.markers', 'camera_to_base.parameters',
           'camera_to_base.settings', 'camera_to_base.sources', 'camera_to_base.surface', 'cv2',
           'numpy')
STANDARD = {'collections', 'concurrent.futures', 'datetime', 'io', 'itertools', 'json', 'math',
            'os', 're', 'threading', 'time', 'traceback', 'typing', 'zipfile'}


def test_sessions_import_what_calibrate_imports_and_nothing_of_ros_or_the_server():
    modules = list(ROOM.rglob('*.py'))
    assert len(modules) > 5
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text())):
            names = [node.module] if isinstance(node, ast.ImportFrom) else [
                alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                assert name in STANDARD or name.startswith(ALLOWED), f'{path.name} imports {name}'
