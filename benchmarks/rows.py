# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Rows of figures: printed as they come, and written where --json asks for it."""

import json
from typing import Any, Dict, Iterable, Optional


def print_rows(rows: Iterable[Dict[str, Any]], path: Optional[str]) -> None:
    """
    Print each row, and write all of them.

    :param path: The file for a list of objects as JSON; None for none.
    """
    kept = []
    for row in rows:
        print('  '.join(f'{name} {value}' for name, value in row.items()), flush=True)
        kept.append(row)
    if path:
        with open(path, 'w', encoding='utf-8') as file:
            json.dump(kept, file, indent=1)
