# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the pages tell to type exists: executables, options, parameters, arguments, files."""

import csv
from pathlib import Path
import re
import shlex
from xml.etree import ElementTree

from camera_to_base.commands.calibrate.command import main as calibrate
from camera_to_base.commands.calibrate.options import parse
from camera_to_base.commands.locate import main as locate
from camera_to_base.fusion import FUSION_SPECS
from camera_to_base.parameters.transform import TRANSFORM_SPECS
from camera_to_base.settings import CAMERA_SPECS, read_node_settings
from camera_to_base.simulation import SimulatedBoard, SimulatedChessboard
import pytest

ROOT = Path(__file__).parents[1]
DOCS = ROOT / 'docs'
USER_PAGES = sorted(set(DOCS.glob('*.md')) - {DOCS / 'README.md'})
ALL_DOCS = sorted(DOCS.glob('**/*.md'))
PAGES = [*ROOT.glob('*.md'), *ALL_DOCS]
LAUNCH_FILE = (ROOT / 'launch' / 'camera_to_base.launch.py').read_text()
NODES = {'camera_publisher', 'robot_base_publisher', 'robotic_arm_publishing_subscriber'}

each_page = pytest.mark.parametrize('page', PAGES, ids=lambda page: str(page.relative_to(ROOT)))


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


def test_contents_list_each_page_of_both_shelves():
    contents = (DOCS / 'README.md').read_text()
    for page in set(ALL_DOCS) - {DOCS / 'README.md'}:
        assert f']({page.relative_to(DOCS)})' in contents, page


def test_pages_for_users_are_about_ten_and_short():
    # Of the parameters, the tables are generated: they are looked up, not read.
    pages = [page for page in USER_PAGES if page.name != 'parameters.md']
    assert len(pages) <= 13
    assert not [page.name for page in pages if len(page.read_text().split()) > 1200]


def test_all_pages_together_stay_short():
    pages = [page for page in ALL_DOCS if page.name != 'parameters.md']
    assert sum(len(page.read_text().split()) for page in pages) <= 19000


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
    page = (DOCS / 'topics_and_frames.md').read_text()
    kinds = {kind for module in (ROOT / 'camera_to_base').glob('**/*.py') for kind in re.findall(
        r"(?:[Rr]eason|_waiting|_damage|_left_out)\(\s*'(\w+)'", module.read_text())}
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
    declared = {spec.name for spec in [*CAMERA_SPECS, *TRANSFORM_SPECS, *FUSION_SPECS]}
    example = set(re.findall(r"(?:_length|number)\('(\w+)'", ''.join(
        (ROOT / 'examples' / name).read_text()
        for name in ('two_link_arm.py', 'pick_and_place.py'))))
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


def test_readme_shows_the_example_as_it_is():
    readme = (ROOT / 'README.md').read_text()
    example = (ROOT / 'examples' / 'print_positions.py').read_text()
    code = example.partition('"""\n\n')[2]
    shown = re.search(r'^ {4}from geometry_msgs.*?^ {12}raise\n', readme, re.M | re.S).group()
    assert re.sub('^    ', '', shown, flags=re.MULTILINE) == code


def test_launch_file_of_the_readme_gives_declared_arguments():
    readme = (ROOT / 'README.md').read_text()
    launch = ElementTree.fromstring(re.search(r'<launch>.*?</launch>', readme, re.S).group())
    include, = launch
    _, _, path = include.get('file').partition('$(find-pkg-share camera_to_base)/')
    assert (ROOT / path).exists()
    declared = re.findall(r"DeclareLaunchArgument\(\s*'(\w+)'", LAUNCH_FILE)
    assert {argument.get('name') for argument in include} <= set(declared)


def test_maintainer_fills_in_addresses_and_none_is_made_up():
    for path in [*PAGES, ROOT / 'package.xml', ROOT / 'setup.py']:
        assert 'example.org' not in path.read_text(), path


# What README says to write in the place of a camera.
CAMERA, PRACTICE = '--camera 0', '--camera simulated'


def block_below(page, first_line):
    """Give an indented block of a page, its first line included."""
    block = re.search(rf'^( {{4,}}){re.escape(first_line)}\n(?:\1.*\n)*', page, re.MULTILINE)
    return [line.strip() for line in block.group().splitlines()]


def run_calibrate(page, words):
    command = re.search(rf'ros2 run camera_to_base (calibrate {words}.*)', page).group(1)
    assert calibrate(shlex.split(command.replace(CAMERA, PRACTICE))[1:]) == 0


class Reader:
    """Somebody who types what the simulated robot's display shows, as README says."""

    def __init__(self, capsys):
        self._capsys = capsys

    def isatty(self):
        return False

    def readline(self):
        shown = re.findall(r'shows: x (\S+), y (\S+) cm', self._capsys.readouterr().err)
        return '{} {}\n'.format(*shown[-1])


@pytest.fixture
def practised(tmp_path, monkeypatch, capsys):
    """Follow README's calibration as it says to practise it."""
    page = (ROOT / 'README.md').read_text()
    assert f'`{CAMERA}`' in page and f'`{PRACTICE}`' in page
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr('sys.stdin', Reader(capsys))
    for words in ('sheet', 'board', 'base --live'):
        run_calibrate(page, words)


@pytest.fixture
def walked(tmp_path, monkeypatch, capsys):
    """Follow the calibration by hand without a camera, and its table; give the output."""
    page = (DOCS / 'calibration_by_hand.md').read_text()
    monkeypatch.chdir(tmp_path)
    run_calibrate(page, 'board --camera simulated')
    pairs = block_below(page, 'x_cam_cm,y_cam_cm,x_base_cm,y_base_cm')
    (tmp_path / 'pairs.csv').write_text('\n'.join(pairs))
    run_calibrate(page, 'base pairs.csv')
    return page, capsys.readouterr().out


@pytest.mark.slow
def test_readme_calibrates_the_simulated_camera_to_half_a_millimetre(practised):
    settings = read_node_settings('cell.yaml')
    view = SimulatedChessboard(9, 6, 2.5, image_size=(640, 480)).view
    for x, y in ((9.0, 8.0), (27.0, 8.0), (27.0, 19.0), (9.0, 19.0), (18.0, 13.5)):
        u, v, w = view.pixel_from_surface @ (x, y, 1.0)
        point, = settings.camera.surface.locate([[u / w, v / w]])
        assert settings.transform.base_point(*point)[:2] == pytest.approx(
            (x - 17.8, 24.4 - y), abs=0.05)


@pytest.mark.slow
def test_readme_locates_the_simulated_objects_to_half_a_millimetre(practised):
    assert locate(['simulated', '--params-file', 'cell.yaml', '--every', '50',
                   '--csv', 'positions.csv']) == 0
    board = SimulatedBoard(image_size=(640, 480))
    truth = []
    for _ in range(600):
        board.read()
        truth.append(board.true_point)
    rows = list(csv.DictReader(Path('positions.csv').open()))
    assert len(rows) > 8
    for row in rows:
        x, y = truth[int(row['frame'])]
        assert float(row['x_base_cm']) == pytest.approx(x - 17.8, abs=0.05)
        assert float(row['y_base_cm']) == pytest.approx(24.4 - y, abs=0.05)


def test_page_of_pairs_shows_what_calibrate_prints(walked):
    page, printed = walked
    shown = block_below(page, re.search('camera frame in the base frame: .*', page).group())
    assert len(shown) == 3
    assert '\n'.join(shown) in printed
    assert re.search('error at 216 points: rms [0-9.]+ mm', page).group() in printed
