# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Writes the parameter tables of docs/parameters.md, see make_docs; it needs no ROS."""

import argparse
from itertools import groupby
from pathlib import Path
import re
import sys
from typing import Any, Iterable, List, Optional

from camera_to_base.dashboard.specs import DASHBOARD_SPECS
from camera_to_base.fusion import FUSION_SPECS
from camera_to_base.parameters import ParameterSpec, TRANSFORM_SPECS
from camera_to_base.settings import CAMERA_SPECS

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'parameters.md'
BEGIN, END = '<!-- generated: begin -->', '<!-- generated: end -->'
NODES = {'camera_publisher': CAMERA_SPECS, 'robot_base_publisher': TRANSFORM_SPECS,
         'camera_fusion': FUSION_SPECS, 'dashboard': DASHBOARD_SPECS}
HEAD = ('| parameter | default | unit | limits | meaning | at run time |\n'
        '| --- | --- | --- | --- | --- | --- |')


def main(args: Optional[List[str]] = None) -> int:
    """Run the script; return its exit code."""
    parser = argparse.ArgumentParser(prog='make_docs', description=__doc__)
    parser.add_argument('--check', action='store_true', help='change nothing, only compare')
    check = parser.parse_args(args).check
    text = PAGE.read_text(encoding='utf-8')
    page = with_tables(text)
    if check and page != text:
        print(f'{PAGE} is not up to date: run scripts/make_docs', file=sys.stderr)
        return 1
    if not check:
        PAGE.write_text(page, encoding='utf-8')
    return 0


def with_tables(page: str) -> str:
    """Put the tables between the marks of a page."""
    begin, end = page.index(BEGIN) + len(BEGIN), page.index(END)
    return f'{page[:begin]}\n{tables()}\n{page[end:]}'


def tables() -> str:
    """Make the tables of all nodes, one for each group of names."""
    parts = []
    for node, specs in NODES.items():
        parts.append(f'## {node}')
        for group, members in groupby(sorted(specs, key=_group), _group):
            parts += [f'### {group}', table(members)] if group else [table(members)]
    return '\n\n'.join(parts)


def table(specs: Iterable[ParameterSpec]) -> str:
    """Make one table."""
    return '\n'.join([HEAD, *map(_row, specs)])


def _row(spec: ParameterSpec) -> str:
    cells = [f'`{spec.name}`', _value(spec.default), spec.unit, _limits(spec), spec.description,
             'fixed' if spec.fixed else 'can be changed']
    return f'| {" | ".join(cells)} |'.replace('  ', ' ')


def _group(spec: ParameterSpec) -> str:
    prefix, dot, _ = spec.name.partition('.')
    return f'{prefix}.*' if dot else ''


def _limits(spec: ParameterSpec) -> str:
    # The unit has a separate column.
    text = spec.constraint_text
    if spec.unit:
        text = re.sub(rf' ?(in )?{re.escape(spec.unit)}(?= in steps|;|$)(; )?', '', text)
    return text


def _value(value: Any) -> str:
    if value == '':
        return 'empty'
    if isinstance(value, bool):
        return f'`{str(value).lower()}`'
    return f'`{value}`'


if __name__ == '__main__':
    sys.exit(main())
