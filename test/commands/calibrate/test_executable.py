# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The installed executable of `calibrate`."""

import subprocess
import sys

COUNT_THREADS = """
import os
import sys
from camera_to_base.executables import calibrate
sys.argv = ['calibrate', 'check', 'no_file.yaml', 'no_table.txt']
code = calibrate()
print(len(os.listdir('/proc/self/task')), 'numpy' in sys.modules)
sys.exit(code)
"""


def test_fits_start_no_threads_which_a_busy_machine_makes_slow(monkeypatch):
    monkeypatch.delenv('OPENBLAS_NUM_THREADS', raising=False)
    monkeypatch.delenv('OMP_NUM_THREADS', raising=False)
    child = subprocess.run([sys.executable, '-c', COUNT_THREADS], capture_output=True, text=True)
    assert child.returncode == 1 and 'no_file.yaml' in child.stderr
    assert child.stdout == '1 True\n'
