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

"""The standard output of the commands, which may be a closed pipe or a file on a full disk."""

import os
import sys
from typing import TextIO

BOLD, RED, GREEN, YELLOW = '1', '31', '32', '33'


def styled(text: str, style: str, stream: TextIO) -> str:
    """Return a text in a style for a terminal; as it is for a pipe, or if NO_COLOR is set."""
    if os.environ.get('NO_COLOR') or os.environ.get('TERM') == 'dumb' or not stream.isatty():
        return text
    return f'\x1b[{style}m{text}\x1b[0m'


def drop_output() -> None:
    """Drop what cannot be printed; otherwise Python prints an error when it flushes at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
