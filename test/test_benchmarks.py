# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The benchmarks run; what they measure is no test's business."""

import json
from pathlib import Path
import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

BENCHMARKS = Path(__file__).parents[1] / 'benchmarks'


@pytest.mark.parametrize('name, columns', [
    ('detection_accuracy', {'method', 'scene', 'precision', 'recall', 'mean_px', 'max_px'}),
    ('detection_speed', {'method', 'scene', 'width', 'height', 'ratio'}),
    ('damage', {'stream', 'quality', 'damage', 'wrong', 'wrong published', 'damage check ms'}),
    ('view_shift', {'surface', 'move', 'disturbance', 'true_px', 'told_px'}),
    ('attack', {'surface', 'what', 'frames', 'wrong'}),
    ('nudges', {'surface', 'case', 'wrong', 'is_corrected'}),
    ('camera_place', {'camera', 'height %'}),
    ('markers', {'what'}),
    ('marker_days', {'day', 'wrong', 'ends well'}),
    ('uncertainty', {'what', 'contained'}),
    ('nodes', {'node'}),
    ('dashboard_load', {'what', 'pages'}),
    ('whole_way', {'table', 'scene', 'ratio', 'damage_ms', 'detection_ms', 'location_ms'}),
    ('camera_node', {'picture', 'p50_ms', 'p99_ms', 'cpu_percent', 'lost', 'resident_mb'})])
def test_benchmark_runs_and_writes_its_rows(tmp_path, name, columns):
    file = tmp_path / 'rows.json'
    run = subprocess.run(
        [sys.executable, BENCHMARKS / f'{name}.py', '--quick', '--json', file],
        capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    rows = json.loads(file.read_text())
    assert rows and all(columns <= set(row) for row in rows)
