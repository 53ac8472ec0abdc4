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

import cv2
import numpy as np
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
    ('busy_table', {'width', 'part', 'found', 'p50_ratio'}),
    ('light_patches', {'table', 'kind', 'published', 'said', 'coins', 'found', 'lost'}),
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


def test_real_pictures_that_are_not_there_are_named_with_the_way_to_get_them(tmp_path):
    run = subprocess.run(
        [sys.executable, BENCHMARKS / 'real_pictures.py', '--json', tmp_path / 'rows.json'],
        capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert 'git clone https://github.com/chriskjou/poolallenhamilton' in run.stdout
    assert json.loads((tmp_path / 'rows.json').read_text()) == []


def test_real_pictures_count_what_is_right_missed_merged_and_false(tmp_path):
    scene = tmp_path / 'somebody_coins'
    scene.mkdir()
    table = np.full((240, 320, 3), 120, np.uint8)
    frame = table.copy()
    for u, v in (60, 60), (160, 120), (250, 180):
        cv2.circle(frame, (u, v), 20, (30, 40, 200), -1)
    cv2.imwrite(str(scene / 'empty.png'), table)
    cv2.imwrite(str(scene / 'three coins.png'), frame)
    labels = tmp_path / 'coins.txt'
    labels.write_text('repository somebody/coins\ncommit 0\nbackground empty.png\n'
                      'frame three coins.png\n60 60 20\n155 120 20\n165 120 20\n20 200 20\n')
    code = ('import sys, pathlib; sys.path.insert(0, sys.argv[1]); import real_pictures as one; '
            'scene = one.read_scene(pathlib.Path(sys.argv[2])); '
            'print([*one.compare(scene, pathlib.Path(sys.argv[3]), 1)][0])')
    run = subprocess.run(
        [sys.executable, '-c', code, BENCHMARKS, labels, tmp_path],
        capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "'right': 1, 'missed': 3, 'merged': 1, 'false': 1" in run.stdout
