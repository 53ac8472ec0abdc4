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

"""What the pages tell to type exists: executables, options, parameters, arguments, files."""

from pathlib import Path
import re
import shlex

from camera_to_base.commands.calibrate_options import parse
from camera_to_base.settings.camera import CAMERA_SPECS
from camera_to_base.transform_parameters import TRANSFORM_SPECS
import pytest

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob('*.md'), *(ROOT / 'docs').glob('*.md')]
LAUNCH_FILE = (ROOT / 'launch' / 'camera_to_base.launch.py').read_text()
NODES = {'camera_publisher', 'robot_base_publisher', 'robotic_arm_publishing_subscriber'}

each_page = pytest.mark.parametrize('page', PAGES, ids=lambda page: page.name)


def commands_of(page):
    """Give the commands of a page: what is indented by four or more and starts as one."""
    return re.findall(r'^ {4,}((?:ros2|python3|sudo|export|fastdds) .*)$', page.read_text(),
                      re.MULTILINE)


def test_pages_have_commands():
    assert sum(len(commands_of(page)) for page in PAGES) > 40


def anchors_of(page):
    """Give the anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r'^#+ (.*)$', page.read_text(), re.MULTILINE)
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-') for heading in headings}


def test_readme_is_read_in_one_sitting():
    assert len((ROOT / 'README.md').read_text().split()) <= 1800


def test_contents_list_each_page():
    contents = (ROOT / 'docs' / 'README.md').read_text()
    for page in (ROOT / 'docs').glob('*.md'):
        assert page.name == 'README.md' or f']({page.name})' in contents, page.name


@each_page
def test_links_lead_to_a_file(page):
    for target in re.findall(r'\]\((?!https?:)([^)#]+)', page.read_text()):
        assert (page.parent / target).exists(), target


@each_page
def test_links_lead_to_a_heading(page):
    for target, anchor in re.findall(r'\]\((?!https?:)([^)#]*)#([^)]+)\)', page.read_text()):
        assert anchor in anchors_of(page.parent / target if target else page), anchor


@each_page
def test_user_pages_name_no_tests(page):
    if page.name not in ('CONTRIBUTING.md', 'QUALITY_DECLARATION.md'):
        assert not re.findall(r'test_\w+', page.read_text())


@each_page
def test_scripts_are_there(page):
    for script, name in re.findall(r'^ {4,}(?:\w+=\S+ )?(scripts/\w+)(?: ([a-z_]+))?',
                                   page.read_text(), re.MULTILINE):
        assert (ROOT / script).exists(), script
        if script == 'scripts/benchmark':
            assert (ROOT / 'benchmarks' / f'{name}.py').exists(), name


@each_page
def test_files_of_the_package_are_there(page):
    for path in re.findall(r'--share camera_to_base\)/(\S+)', page.read_text()):
        assert (ROOT / path).exists(), path


def test_each_kind_of_reason_is_listed():
    page = (ROOT / 'docs' / 'topics_and_frames.md').read_text()
    kinds = {kind for module in (ROOT / 'camera_to_base').glob('**/*.py') for kind in re.findall(
        r"(?:Reason|_waiting|_damage|_left_out)\(\s*'(\w+)'", module.read_text())}
    assert len(kinds) > 20
    assert not sorted(kind for kind in kinds if f'`{kind}`' not in page)


@each_page
def test_executables_are_installed(page):
    installed = set(re.findall(r"'(\w+) = ", (ROOT / 'setup.py').read_text())) | NODES
    for command in commands_of(page):
        for name in re.findall(r'ros2 run camera_to_base (\w+)', command):
            assert name in installed, command


@each_page
def test_options_of_calibrate_are_understood(page):
    for command in commands_of(page):
        if 'camera_to_base calibrate' in command:
            parse(shlex.split(command)[4:])


@each_page
def test_parameters_are_declared(page):
    declared = {spec.name for spec in [*CAMERA_SPECS, *TRANSFORM_SPECS]}
    example = set(re.findall(
        r"_length\('(\w+)'", (ROOT / 'examples' / 'two_link_arm.py').read_text()))
    for command in commands_of(page):
        for name in re.findall(r'-p ([\w.]+):=', command):
            assert name in declared | example, command


@each_page
def test_launch_arguments_are_declared(page):
    declared = re.findall(r"DeclareLaunchArgument\(\s*'(\w+)'", LAUNCH_FILE)
    for command in commands_of(page):
        if command.startswith('ros2 launch camera_to_base '):
            for name in re.findall(r' (\w+):=', command):
                assert name in declared, command
