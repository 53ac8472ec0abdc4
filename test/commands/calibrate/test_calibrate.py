# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.


"""The command `calibrate`, on pictures and tables that the tests make themselves."""

from functools import partial
import json
from pathlib import Path
import re
import subprocess
import sys
import zlib

from camera_to_base.calibration.figures import ErrorFigures, warnings
from camera_to_base.commands.calibrate.command import main
from camera_to_base.parameters.file import parameter_text, read_parameter_file
from camera_to_base.parameters.transform import transform_settings, TRANSFORM_SPECS
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.shell_commands import full_command, run_command
from camera_to_base.surface.models import PolynomialSurface
import cv2
import numpy as np
import pytest
from rendered_board import camera_place, CENTRE, IMAGE_SIZE, pixel_from_surface, project, render
import yaml

DEFAULTS = {spec.name: spec.default for spec in CAMERA_SPECS + TRANSFORM_SPECS}
BOARD = ('--corners', '9x6', '--square-mm', '25')
# On the board and beside it, in cm.
POINTS = np.array([[2.0, 1.0], [18.5, 11.0], [-2.0, 6.0], [10.0, 14.0]])
NO_FILE = "there is no file 'none.yaml': first make it with .*calibrate.* board --camera 0 "
PAIRS = ('x_cam_cm,y_cam_cm,x_base_cm,y_base_cm\n'
         '0,0,-17.8,24.4\n36,0,18.2,24.4\n36,27,18.2,-2.6\n0,27,-17.8,-2.6\n')


# On the board; its frame's z points into the table, so that the base's y runs the other way.
TOUCHED = np.array([[1.0, 1.0], [18.5, 1.5], [17.0, 11.0], [2.0, 10.5], [9.0, 4.0], [11.0, 9.0]])


@pytest.fixture
def run(run_main):
    """Run the command; give exit code, standard output and standard error."""
    return partial(run_main, main)


@pytest.fixture
def report(run):
    """Run the command with --json; give its report."""
    def run_with_json(*arguments):
        code, output, error = run(*arguments, '--json')
        assert (code, error) == (0, '')
        return json.loads(output)
    return run_with_json


def board_picture(name='board.png', homography=None, **look):
    cv2.imwrite(name, render(pixel_from_surface() if homography is None else homography, **look))
    return name


def table(name='points.csv', points=None, surface=None, header='x_cm,y_cm,u_px,v_px'):
    if points is None:
        points = np.array([[x, y] for y in (-2.0, 4.0, 9.0, 14.0) for x in (-2.0, 10.0, 22.0)])
    pixels = project(pixel_from_surface(), points) if surface is None else surface.pixels(points)
    rows = [','.join(map(repr, row)) for row in np.hstack([points, pixels]).tolist()]
    Path(name).write_text('\n'.join([header, *rows]) + '\n')
    return name


def touched(camera=TOUCHED, base=TOUCHED * [1, -1] + [-17.8, 24.4], name='pairs.csv'):
    rows = [','.join(map(repr, row)) for row in np.hstack([camera, base]).tolist()]
    Path(name).write_text('\n'.join([PAIRS.split()[0], *rows]) + '\n')
    return name


def surface_file(name='board.yaml'):
    """Write the surface of the rendered board, as `calibrate points` does."""
    assert main(['points', table(), '-o', name, '--image-size', '640x480']) == 0
    return name


def settings_of(file):
    values = {**DEFAULTS, **read_parameter_file(file).values}
    assert set(values) == set(DEFAULTS)
    return camera_settings(values), transform_settings(values)


@pytest.mark.slow
@pytest.mark.parametrize('tilt, look, tolerance_cm', [
    (30, {}, 0.02), (45, {'coefficient': -0.2, 'noise': 2}, 0.04),
    (20, {'coefficient': -0.1, 'noise': 4, 'blur': 1.5}, 0.06), (0, {'noise': 2}, 0.02)])
def test_board_gives_a_file_with_which_the_node_locates_points(run, tilt, look, tolerance_cm):
    homography = pixel_from_surface(tilt)
    code, output, error = run(
        'board', board_picture(homography=homography, **look), *BOARD, '-o', 'surface.yaml')
    assert (code, error) == (0, '')
    settings, _ = settings_of('surface.yaml')
    pixels = project(homography, POINTS, look.get('coefficient', 0.0))
    surface = settings.surface.for_image_size(IMAGE_SIZE)
    np.testing.assert_allclose(surface.locate(pixels), POINTS, atol=tolerance_cm)
    assert settings.hull.contains(pixels[0]) and not settings.hull.contains(pixels[2])


def test_file_carries_source_date_and_figures_as_comments(run):
    code, output, _ = run('board', board_picture(), *BOARD, '-o', 'surface.yaml')
    comments = '\n'.join(read_parameter_file('surface.yaml').comments)
    for said in ('9 x 6 inner corners', 'board.png', 'rms', 'largest', 'left out of the fit',
                 'outside of them these figures do not hold', '640 x 480 px', 'origin at pixel',
                 'degrees from straight down'):
        assert said in comments and said in output
    assert '20' in comments and 'T' in comments


@pytest.mark.slow
def test_report_in_json_has_the_figures_of_the_one_for_a_person(report, run):
    found = report('board', board_picture(noise=2), *BOARD, '-o', 'surface.yaml')
    assert found['model'] == 'homography' and found['points'] == 54
    assert 0 < found['mean_mm'] <= found['rms_mm'] <= found['max_mm'] < 0.5
    assert found['rms_mm'] < found['leave_one_out_rms_mm'] < 0.5
    assert found['tilt_deg'] == pytest.approx(30, abs=1)
    assert 0.1 < found['coverage'] < 1 and found['warnings'] == []
    assert (found['file'], found['picture']) == ('surface.yaml', 'surface_report.png')
    _, output, _ = run('board', 'board.png', *BOARD, '-o', 'again.yaml')
    assert f'rms {found["rms_mm"]:.2f} mm' in output


@pytest.mark.slow
def test_report_picture_is_beside_the_file_or_where_it_is_wanted(report):
    report('board', board_picture(), *BOARD, '-o', 'surface.yaml')
    report('points', table(), '-o', 'points.yaml', '--picture', 'elsewhere.png')
    for name in ('surface_report.png', 'elsewhere.png'):
        height, width, _ = cv2.imread(name).shape
        assert height > 640 and width > 1000
    assert not Path('points_report.png').exists()


@pytest.mark.slow
def test_origin_can_be_another_corner_a_place_beside_it_and_turned(report):
    picture, homography = board_picture(), pixel_from_surface()
    corners = project(homography, [[0, 0], [20, 0], [20, 12.5], [0, 12.5], [5, 2.5]])
    for corner in range(4):
        found = report('board', picture, *BOARD, '-o', f'{corner}.yaml', '--origin-corner', corner)
        assert found['origin_px'] == pytest.approx(corners[corner], abs=0.5)
    found = report('board', picture, *BOARD, '-o', 'moved.yaml', '--origin-mm', 50, 25,
                   '--yaw-deg', 90)
    assert found['origin_px'] == pytest.approx(corners[4], abs=0.5)
    settings, _ = settings_of('moved.yaml')
    # x of the turned frame runs along the board's y.
    np.testing.assert_allclose(
        settings.surface.locate(project(homography, [[5, 12.5]])), [[10, 0]], atol=0.05)


def test_second_board_in_view_is_a_warning(report):
    large = render(pixel_from_surface(10, 0, away_cm=70, middle=(24, 6)))
    small = render(pixel_from_surface(10, 0, away_cm=110, middle=(-12, 6)))
    cv2.imwrite('both.png', np.hstack([large[:, :340], small[:, 340:]]))
    found = report('board', 'both.png', *BOARD, '-o', 'surface.yaml')
    assert 'another such board' in found['warnings'][-1]
    assert found['x_towards_px'][0] < 340


def photograph(name, frame, orientation):
    """Write a JPEG whose EXIF orientation asks viewers to turn it."""
    exif = (b'Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0'
            + bytes([orientation]) + b'\0\0\0\0\0\0')
    content = cv2.imencode('.jpg', frame, [cv2.IMWRITE_JPEG_QUALITY, 100])[1].tobytes()
    mark = b'\xff\xe1' + (len(exif) + 2).to_bytes(2, 'big')
    Path(name).write_bytes(content[:2] + mark + exif + content[2:])
    return name


@pytest.mark.parametrize('orientation, is_turned', [(1, False), (3, True), (6, True)])
def test_photograph_is_used_as_it_is_stored_with_a_warning(report, orientation, is_turned):
    name = photograph('board.jpg', render(pixel_from_surface()), orientation)
    found = report('board', name, *BOARD, '-o', 'surface.yaml')
    assert found['image_size'] == [640, 480]
    assert found['origin_px'] == pytest.approx(project(pixel_from_surface(), [[0, 0]])[0], abs=0.5)
    assert ['EXIF orientation' in text for text in found['warnings']] == [True] * is_turned


@pytest.mark.slow
def test_video_is_used_by_the_median_of_its_frames(report):
    writer = cv2.VideoWriter('board.avi', cv2.VideoWriter_fourcc(*'MJPG'), 10.0, IMAGE_SIZE)
    for seed in range(9):
        frame = render(pixel_from_surface(), noise=8, seed=seed)
        if seed % 3 == 0:  # a hand
            cv2.circle(frame, (320, 240), 80, (90, 120, 160), -1)
        writer.write(frame)
    writer.release()
    found = report('board', '--camera', 'board.avi', *BOARD, '-o', 'surface.yaml')
    assert found['points'] == 54 and found['max_mm'] < 0.5
    assert found['source'].endswith('in camera board.avi')


@pytest.mark.slow
def test_simulated_camera_is_calibrated_with_the_tilt_that_the_file_then_sets(report):
    report('board', '--camera', 'simulated', '--simulated-tilt-deg', 20, *BOARD, '-o', 'a.yaml',
           '--placements', 1)
    settings, _ = settings_of('a.yaml')
    assert settings.simulated.tilt_deg == 20


@pytest.mark.parametrize('line', ['camera_zoom: 1.2', 'camera_shift_px: [4.0, 0.0]'])
def test_file_that_moves_the_simulated_camera_is_refused(run, line):
    Path('a.yaml').write_text(f'/**:\n  ros__parameters:\n    simulated.{line}\n')
    code, _, error = run('board', '--camera', 'simulated', *BOARD, '-o', 'a.yaml')
    assert code == 1 and f"(simulated.{line.split(':')[0]})" in error and 'dashboard' in error


def test_table_gives_a_homography_whatever_the_order_of_its_columns(report):
    name = table()
    rows = [line.split(',') for line in Path(name).read_text().split()]
    Path('turned.csv').write_text('\n'.join(','.join(row[::-1]) for row in rows))
    for source in (name, 'turned.csv'):
        found = report('points', source, '-o', f'{source}.yaml', '--image-size', '640x480')
        assert found['max_mm'] < 1e-6 and found['points'] == 12 and found['warnings'] == []
        settings, _ = settings_of(f'{source}.yaml')
        np.testing.assert_allclose(
            settings.surface.locate(project(pixel_from_surface(), POINTS)), POINTS, atol=1e-6)


def test_polynomial_prints_the_tutorials_equations(run):
    points = np.array([[x, y] for y in (2.0, 5.0, 8.0, 11.0, 13.0) for x in (-6.0, 0.0, 6.0)])
    name = table(points=points, surface=PolynomialSurface())
    code, output, _ = run('points', name, '--model', 'polynomial', '-o', 'surface.yaml')
    assert code == 0
    assert 'y = 6e-05 v^2 - 0.0833 v + 25.848   (R^2 = 1.000000)' in output
    assert 'px_per_cm = 0.0625 y^2 - 1.6393 y + 29.071   (R^2 = 1.000000)' in output
    settings, _ = settings_of('surface.yaml')
    np.testing.assert_allclose(settings.surface.locate([[417, 265]]), [[6.26, 7.99]], atol=0.01)


def test_few_points_are_said_to_tell_nothing_of_the_lens(run):
    _, output, _ = run('points', table(points=POINTS), '-o', 'surface.yaml')
    assert '8 points or more can tell it' in output
    assert 'warning: there are too few points' in output


def test_picture_size_that_nobody_told_is_a_warning(report):
    found = report('points', table(), '-o', 'surface.yaml')
    assert '640 x 480 px; say it with --image-size' in found['warnings'][-1]


def test_pairs_give_the_transform_nodes_parameters(report):
    Path('pairs.csv').write_text(PAIRS)
    found = report('base', 'pairs.csv', '-o', 'base.yaml')
    assert found['rotation_deg'] == pytest.approx([180, 0, 0], abs=1e-9)
    assert found['displacement_cm'] == pytest.approx([-17.8, 24.4, 0], abs=1e-9)
    assert found['max_mm'] < 1e-6
    _, conversion = settings_of('base.yaml')
    np.testing.assert_allclose(conversion.convert_surface_points([[10, 5]]), [[-7.8, 19.4, 0]],
                               atol=1e-9)


def test_one_file_can_serve_both_nodes(report):
    report('board', board_picture(), *BOARD, '-o', 'cell.yaml')
    surface = read_parameter_file('cell.yaml')
    touched()
    found = report('base', 'pairs.csv', '--surface', 'cell.yaml', '-o', 'cell.yaml', '--force')
    assert found['warnings'] == []
    both = read_parameter_file('cell.yaml')
    assert set(both.values) == {
        *surface.values, 'rotation_deg', 'displacement_cm', 'base_covariance',
        'calibration.base'}
    assert all(both.values[name] == value for name, value in surface.values.items())
    # How good the cell is is said anew.
    kept = [line for line in surface.comments if not line.startswith('accuracy')]
    assert set(kept) <= set(both.comments)


def test_check_tells_the_error_on_points_that_were_not_used(report, run):
    report('board', board_picture(), *BOARD, '-o', 'surface.yaml')
    off = project(pixel_from_surface(), POINTS + [[0.1, 0.0]])
    rows = [','.join(map(repr, row)) for row in np.hstack([POINTS, off]).tolist()]
    Path('points.csv').write_text('\n'.join(['x_cm,y_cm,u_px,v_px', *rows]))
    found = report('check', 'surface.yaml', 'points.csv')
    assert found['mean_mm'] == pytest.approx(1.0, abs=0.1)
    assert (found['points'], found['outside_hull']) == (4, 2)
    assert '2 of the points lie outside' in run('check', 'surface.yaml', 'points.csv')[1]
    assert sorted(path.name for path in Path().iterdir()) == [
        'board.png', 'points.csv', 'surface.yaml', 'surface_report.png']


def test_files_are_overwritten_when_told_to_only(run):
    picture = board_picture()
    for existing in ('surface.yaml', 'surface_report.png'):
        Path(existing).write_text('mine')
        code, _, error = run('board', picture, *BOARD, '-o', 'surface.yaml')
        assert code == 1 and f"'{existing}' exists already" in error
        assert Path(existing).read_text() == 'mine'
        Path(existing).unlink()
    Path('surface.yaml').write_text('mine')
    assert run('board', picture, *BOARD, '-o', 'surface.yaml', '--force')[0] == 0
    assert 'homography' in Path('surface.yaml').read_text()
    assert Path('surface.yaml.bak').read_text() == 'mine'


def flat_picture(name='flat.png', width=640):
    cv2.imwrite(name, np.full((480, width, 3), 128, np.uint8))
    return name


def huge_picture(name='huge.png'):
    """Write a PNG whose header claims 100,000 x 100,000 px."""
    content = bytearray(cv2.imencode('.png', np.zeros((9, 9, 3), np.uint8))[1].tobytes())
    content[16:24] = (100000).to_bytes(4, 'big') * 2
    content[29:33] = zlib.crc32(content[12:29]).to_bytes(4, 'big')
    Path(name).write_bytes(content)
    return name


def written(name, text):
    Path(name).write_text(text)
    return name


def camera_info(name='camera_info.yaml', focal=600.0, centre=CENTRE, **changed):
    """Write what ROS's camera_calibration writes; None leaves a key out."""
    content = {
        'image_width': 640, 'image_height': 480, 'camera_name': 'narrow_stereo',
        'camera_matrix': {'rows': 3, 'cols': 3,
                          'data': [focal, 0, centre[0], 0, focal, centre[1], 0, 0, 1]},
        'distortion_model': 'plumb_bob',
        'distortion_coefficients': {'rows': 1, 'cols': 5, 'data': [0.0, 0.0, 0.0, 0.0, 0.0]},
        **changed}
    Path(name).write_text(yaml.safe_dump(
        {key: value for key, value in content.items() if value is not None}))
    return name


LINE = 'x_cm,y_cm,u_px,v_px\n' + ''.join(f'{k},{k},{9 * k},{5 * k}\n' for k in range(1, 6))
SIZED = 'x_cm,y_cm,u_px,v_px,width_px,height_px\n0,0,1,1,320,240\n9,0,99,1,320,240\n'
BAD_INPUTS = {
    'no board': (lambda: ('board', flat_picture(), *BOARD), 'no chessboard .* evenly lit'),
    'wrong counts': (lambda: ('board', board_picture(), '--corners', '8x6', '--square-mm', 25),
                     'has 9 x 6 inner corners, not 8 x 6'),
    'counts too small': (lambda: ('board', board_picture(), '--corners', '9x2', '--square-mm', 25),
                         'must be 3..1000, got 2'),
    'counts that are none': (lambda: ('board', 'a.png', '--corners', '54', '--square-mm', 25),
                             "--corners must be two counts as in 9x6, got '54'"),
    'square of no size': (lambda: ('board', board_picture(), '--corners', '9x6',
                                   '--square-mm', 0), 'square_mm must be'),
    'square that is no number': (
        lambda: ('board', 'a.png', '--corners', '9x6', '--square-mm', 'wide'),
        "--square-mm: expected a number such as 25.4, got 'wide'"),
    'square with a decimal comma of no size': (
        lambda: ('board', board_picture(), '--corners', '9x6', '--square-mm', '0,0'),
        'square_mm must be'),
    'base before the board': (lambda: ('base', '--live', 'none.yaml'),
                              NO_FILE),
    'markers before the board': (lambda: ('base', '--markers', 'none.yaml'),
                                 NO_FILE),
    'no such corner': (lambda: ('board', board_picture(), *BOARD, '--origin-corner', 4),
                       'origin_corner must be 0..3, got 4'),
    'missing picture': (lambda: ('board', 'none.png', *BOARD), "picture 'none.png': No such file"),
    'no picture': (lambda: ('board', written('a.png', 'text'), *BOARD), 'no picture that OpenCV'),
    'empty picture': (lambda: ('board', written('a.png', ''), *BOARD), 'no picture that OpenCV'),
    'picture of one pixel': (lambda: ('board', flat_picture(width=1), *BOARD),
                             '1 x 480 px is too small to show 10 x 7 squares'),
    'picture that claims to be huge': (lambda: ('board', huge_picture(), *BOARD),
                                       'damaged, or larger than OpenCV reads'),
    'missing camera': (lambda: ('board', '--camera', '/dev/video99', *BOARD),
                       'cannot open camera'),
    'missing video': (lambda: ('board', '--camera', 'none.avi', *BOARD), 'there is no such file'),
    'neither picture nor camera': (lambda: ('board', *BOARD),
                                   'expected pictures of the board, --camera'),
    'missing intrinsics': (lambda: ('board', board_picture(), *BOARD, '--intrinsics', 'none.yaml'),
                           "cannot read the camera_info file 'none.yaml'"),
    'intrinsics of another size': (
        lambda: ('board', board_picture(), *BOARD, '--intrinsics', camera_info(image_width=1280)),
        'intrinsics are for pictures of 1280 x 480 px, but this one has 640 x 480 px'),
    'output over the intrinsics': (
        lambda: ('board', board_picture(), *BOARD, '--intrinsics', camera_info(), '-o',
                 'camera_info.yaml', '--force'), 'different files to read and to write'),
    'missing table': (lambda: ('points', 'none.csv'), 'cannot read the table none.csv'),
    'missing column': (lambda: ('points', table(header='x_cm,y_cm,u_px,v')), 'no column v_px'),
    'not a number': (lambda: ('points', written('a.csv', LINE + '6,six,7,8\n')),
                     "row 7: y_cm: not a number: 'six'"),
    'nan': (lambda: ('points', written('a.csv', LINE + '6,nan,7,8\n')), 'row 7: y_cm is nan'),
    'infinity': (lambda: ('points', written('a.csv', LINE + '6,1,inf,8\n')), 'row 7: u_px is inf'),
    'three points': (lambda: ('points', table(points=POINTS[:3])), '3 points are too few'),
    'duplicate points': (lambda: ('points', table(points=POINTS[[0, 1, 2, 3, 1]])),
                         'rows 3 and 6 have the same position'),
    'one line': (lambda: ('points', written('a.csv', LINE)), 'all 5 points lie on one line'),
    'one line but one': (lambda: ('points', written('a.csv', LINE + '6,0,300,8\n')),
                         'all points but row 7 lie on one line'),
    'outside the picture': (lambda: ('points', table(), '--image-size', '320x240'),
                            r'row \d+: pixel .* outside a picture of 320 x 240 px'),
    "another size than the table's": (
        lambda: ('points', written('a.csv', SIZED), '--image-size', '640x480'),
        'from a picture of 320 x 240 px, not of 640 x 480 px'),
    'no rows of one y': (lambda: ('points', table(points=POINTS), '--model', 'polynomial'),
                         'at least three values of y_cm'),
    'no rigid transform': (lambda: ('base', written('a.csv', PAIRS + '10,10,20,20\n')),
                           r'row 6 does not belong to the others: it is off by 283.6 mm'),
    'four pairs that nothing fits': (
        lambda: ('base', written('a.csv', PAIRS.replace('-17.8,-2.6', '-17.8,2.6'))),
        r'no rigid transform fits the pairs: row \d is off by \d+ mm'),
    'two pairs': (lambda: ('base', written('a.csv', '\n'.join(PAIRS.split()[:3]))),
                  '2 pairs are too few'),
    'no column of pairs': (lambda: ('base', table()), 'no column x_cam_cm'),
    'surface that is no file': (
        lambda: ('base', written('a.csv', PAIRS), '--surface', 'none.yaml'),
        "there is no file 'none.yaml'"),
    'no such folder': (lambda: ('points', table(), '-o', 'none/surface.yaml'),
                       "cannot write picture 'none/surface_report.png': there is no folder"),
    'output over the input': (lambda: ('points', table(), '-o', 'points.csv', '--force'),
                              'different files to read and to write'),
    'a device': (lambda: ('points', table(), '-o', '/dev/null', '--force', '--picture', 'a.png'),
                 "cannot write '/dev/null': a device or a pipe is there, not a file"),
    'picture of no format': (lambda: ('points', table(), '--picture', 'report.doc'),
                             'must end in .png or .jpg'),
    'sheet of no format': (lambda: ('sheet', '-o', 'a.doc'), 'must end in .pdf, .svg or .png'),
    'sheet that is too small': (lambda: ('sheet', '--square-mm', 40, '-o', 'a.pdf'),
                                'does not fit on A4: squares of 25 mm do'),
    'no such subcommand': (lambda: ('bord',), "there is no 'bord', did you mean board"),
}


@pytest.mark.parametrize('bad_input', BAD_INPUTS)
def test_bad_input_is_one_sentence_and_exit_code_1_and_nothing_is_written(run, bad_input):
    make, said = BAD_INPUTS[bad_input]
    arguments = make()
    if '-o' not in arguments:
        arguments += ('-o', 'surface.yaml')
    before = {path: path.read_bytes() for path in Path().iterdir()}
    code, output, error = run(*arguments)
    assert (code, output) == (1, '')
    assert error.startswith('calibrate: ') and error.count('\n') == 1
    assert re.search(said, error), error
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


BASE = TOUCHED * [1, -1] + [-17.8, 24.4]
ONE_BAD = BASE + 0.8 * np.eye(6)[:, [4, 0]] * [1, 0]
LIES = {
    'mirrored base frame': (TOUCHED, TOUCHED + [-17.8, 24.4], 'so it is mirrored'),
    'x and y of the base exchanged': (TOUCHED, BASE[:, ::-1], 'so it is mirrored'),
    'frames exchanged': (BASE, TOUCHED, 'are the columns of the two frames exchanged'),
    'mm in both': (10 * TOUCHED, 10 * BASE, r'row \d: the camera point .* is it in mm'),
    'm in both': (TOUCHED / 100, BASE / 100, r'within 1\.9 mm, too near .* are the numbers in m'),
    'mm in the base': (TOUCHED, 10 * BASE, 'the base points lie 10 times as far apart'),
    'a corner of the table': (TOUCHED[:3] / 16, (TOUCHED * [1, -1])[:3] / 16,
                              r'errors of 1.0 mm in them become \d+ mm at the far end'),
    'one bad pair of six': (TOUCHED, ONE_BAD, r'row 6 does not belong .* off by \d+.\d mm'),
}


@pytest.mark.parametrize('lie', LIES)
def test_pairs_that_cannot_be_of_this_table_are_refused_and_nothing_is_written(run, lie):
    camera, base, said = LIES[lie]
    surface = surface_file()
    run('check', surface, 'points.csv')  # takes what the making of the surface has printed
    touched(camera, base)
    before = {path: path.read_bytes() for path in Path().iterdir()}
    code, output, error = run('base', 'pairs.csv', '--surface', surface, '-o', 'cell.yaml')
    assert (code, output) == (1, '') and error.count('\n') == 1
    assert re.search(said, error), error
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


def test_pairs_of_the_tutorials_parallel_camera_fit_its_surface(report):
    Path('pairs.csv').write_text(PAIRS + '18,13,0.2,11.4\n')
    parallel = written('parallel.yaml', '/**: {ros__parameters: {surface: {model: parallel}}}')
    found = report('base', 'pairs.csv', '--surface', parallel, '-o', 'cell.yaml')
    assert found['warnings'] == [] and found['rotation_deg'] == pytest.approx([180, 0, 0])


def test_pairs_fit_a_surface_whose_picture_shows_the_horizon(report):
    # A camera that looks along a road: its horizon is the row 112.
    road = written('road.yaml', '/**: {ros__parameters: {surface: {model: homography, homography: '
                   '{surface_from_pixel: [100.0, 0, -32000, 0, 0, 12800, 0, 1, -112]}}}}')
    camera = np.array([[-40.0, 40.0], [40.0, 40.0], [-60.0, 80.0], [60.0, 80.0], [0.0, 60.0]])
    touched(camera, camera + [5.0, 7.0])
    found = report('base', 'pairs.csv', '--surface', road, '-o', 'cell.yaml')
    assert found['displacement_cm'] == pytest.approx([5, 7, 0]) and found['warnings'] == []


def test_hanging_robot_counts_z_downwards(run):
    surface, pairs = surface_file(), touched(TOUCHED, TOUCHED + [-17.8, 24.4])
    code, _, error = run('base', pairs, '--surface', surface, '-o', 'a.yaml', '--base-z', 'down')
    assert (code, error) == (0, '')
    code, _, error = run('base', touched(), '--surface', surface, '-o', 'b.yaml', '--base-z',
                         'down')
    assert code == 1 and "the pairs put the base frame's z away from the table" in error


def test_what_pairs_alone_cannot_tell_is_a_warning(report, run):
    Path('pairs.csv').write_text(PAIRS)
    warnings = report('base', 'pairs.csv', '-o', 'base.yaml')['warnings']
    assert any('without --surface nothing shows whether' in text for text in warnings)
    assert any('with 4 pairs a bad one cannot be told' in text for text in warnings)
    assert all(f'warning: {text}' in read_parameter_file('base.yaml').comments
               for text in warnings)
    touched(10 * TOUCHED, 10 * BASE)
    code, _, error = run('base', 'pairs.csv', '-o', 'far.yaml')
    assert code == 1 and 'which is no table: are the numbers in mm' in error


def test_pairs_outside_of_the_calibrated_area_are_named(run):
    points = np.array([[x, y] for y in (2.0, 5.0, 8.0) for x in (3.0, 8.0, 12.0)])
    assert main(['points', table(points=points), '-o', 'a.yaml', '--image-size', '640x480']) == 0
    code, output, _ = run('base', touched(), '--surface', 'a.yaml', '-o', 'cell.yaml')
    assert code == 0 and 'do not hold: 2, 3, 4, 5, 7' in output


def measured(seed=0, noise=0.5):
    """Give points of the table and pixels with the errors of clicks, (n, 2) each."""
    rng = np.random.default_rng(seed)
    points = np.array([[x, y] for y in (-2.0, 4.0, 9.0, 14.0) for x in (-2.0, 10.0, 22.0)])
    return points, project(pixel_from_surface(), points) + rng.normal(0, noise, points.shape)


def write_points(points, pixels):
    rows = [','.join(map(repr, row)) for row in np.hstack([points, pixels]).tolist()]
    return written('points.csv', '\n'.join(['x_cm,y_cm,u_px,v_px', *rows]))


@pytest.mark.parametrize('spoil, said', [
    (lambda points, pixels: (points, pixels[[3, 1, 2, 0, 4, 5, 9, 7, 8, 6, 10, 11]]),
     'no measurement of a surface: .* rms, .* % of their extent|no camera can see|horizon'),
    (lambda points, pixels: (points + np.eye(12)[:, [7, 0]] * [2.0, 0.0], pixels),
     r'row 9 does not belong to the others: it is off by (1[89]|2[012])\.\d mm'),
    (lambda points, pixels: (points, 300 + (pixels - pixels.mean(axis=0)) / 30),
     r'all points lie within \d+ x \d+ px of a picture of 640 x 480 px, too near each other')])
def test_points_that_are_no_measurement_are_refused_and_nothing_is_written(run, spoil, said):
    write_points(*spoil(*measured()))
    code, output, error = run('points', 'points.csv', '-o', 'a.yaml', '--image-size', '640x480')
    assert (code, output) == (1, '') and error.count('\n') == 1
    assert re.search(said, error), error
    assert [path.name for path in Path().iterdir()] == ['points.csv']


def test_points_with_the_errors_of_clicks_are_taken_and_mm_are_doubted(report):
    points, pixels = measured()
    write_points(points, pixels)
    found = report('points', 'points.csv', '-o', 'a.yaml', '--image-size', '640x480')
    assert found['warnings'] == []
    write_points(16 * points, pixels)
    found = report('points', 'points.csv', '-o', 'b.yaml', '--image-size', '640x480')
    assert 'which is an unusual table: are all numbers in cm?' in found['warnings'][-1]


@pytest.mark.parametrize('text, said', [
    ('a: [1', 'is no YAML'), ('', "has no '/\\*\\*: ros__parameters:'"), ('[1, 2]', 'has no'),
    ('/**: {ros__parameters: {period: 3.0}}', 'expected the parameters of a surface'),
    ('/**: {ros__parameters: {surface: {model: cubic}}}', 'surface.model must be one of'),
    ('/**: {ros__parameters: {surface: {model: homography, image_size: [320, 240]}}}',
     'a picture of 640 x 480 px, not of 320 x 240 px'),
])
def test_file_that_is_no_calibration_cannot_be_checked(run, text, said):
    sized = 'x_cm,y_cm,u_px,v_px,width_px,height_px\n0,0,1,1,640,480\n'
    code, output, error = run('check', written('a.yaml', text), written('a.csv', sized))
    assert (code, output) == (1, '')
    assert error.count('\n') == 1 and re.search(said, error), error


def test_pixel_near_the_horizon_cannot_be_checked(run):
    text = ('/**: {ros__parameters: {surface: {model: homography, homography: '
            '{surface_from_pixel: [1.0, 0, -320, 0, 0, 128, 0, 1, -112]}}}}')
    points = written('a.csv', 'x_cm,y_cm,u_px,v_px\n0,0,320,112\n')
    code, _, error = run('check', written('a.yaml', text), points)
    assert code == 1 and 'near the horizon' in error


@pytest.mark.parametrize('factor, said', [
    (0.01, r'span 0\.\d+ cm, which is no table: are the numbers in m instead'),
    (100, r'span \d+ cm|span .*e\+03 cm, which is no table: are the numbers in mm instead')])
def test_points_of_a_stamp_or_a_hall_are_refused(run, factor, said):
    points = np.array([[x, y] for y in (-2.0, 4.0, 9.0, 14.0) for x in (-2.0, 10.0, 22.0)])
    pixels = project(pixel_from_surface(), points)
    rows = [','.join(map(repr, row)) for row in np.hstack([factor * points, pixels]).tolist()]
    Path('a.csv').write_text('\n'.join(['x_cm,y_cm,u_px,v_px', *rows]))
    code, output, error = run('points', 'a.csv', '--image-size', '640x480', '-o', 'surface.yaml')
    assert (code, output) == (1, '') and re.search(said, error), error
    assert not Path('surface.yaml').exists()


@pytest.mark.slow
def test_blurred_board_is_doubted(report):
    found = report('board', board_picture(blur=12), *BOARD, '-o', 'surface.yaml')
    assert any('is the picture blurred, or the board bent' in text for text in found['warnings'])


@pytest.mark.slow
def test_sheet_is_drawn_for_the_command_that_it_names(report, run):
    found = report('sheet', '-o', 'board.png')
    assert found['warnings'] == [] and found['corners'] == [9, 6]
    code, output, _ = run('board', 'board.png', *BOARD, '-o', 'surface.yaml')
    assert code == 0
    code, output, _ = run('sheet', '--corners', '8x6', '-o', 'board.pdf')
    assert code == 0 and Path('board.pdf').read_bytes().startswith(b'%PDF')
    assert 'measure the ruler: it must be 100 mm long' in output
    assert 'warning: a board of 8 x 6 inner corners looks the same when it is turned' in output


def test_status_tells_the_way_from_a_surface_to_a_cell(run):
    surface_file('cell.yaml')
    code, output, error = run('status', 'cell.yaml')
    assert (code, error) == (0, '')
    assert 'surface: homography for pictures of 640 x 480 px, from points.csv, 20' in output
    assert output.endswith(f'next: {full_command("calibrate", "base", "--live", "cell.yaml")}\n')
    for _ in range(2):
        code, *_ = run('base', touched(), '--surface', 'cell.yaml', '-o', 'cell.yaml', '--force')
        assert code == 0
    code, output, _ = run('status', 'cell.yaml')
    assert 'base frame, from pairs.csv, 20' in output
    assert output.endswith(f'next: {run_command("cell.yaml", "0")}\n')
    comments = read_parameter_file('cell.yaml').comments
    assert sum(line.startswith('rigid from') for line in comments) == 1
    assert sum(line.startswith('homography from') for line in comments) == 1


@pytest.mark.parametrize('command', [
    (), ('sheet',), ('status',), ('board',), ('points',), ('base',), ('check',)])
def test_help_explains_itself_with_an_example(run, command):
    code, output, _ = run(*command, '--help')
    assert code == 0
    assert f'\n  calibrate {"".join(command) or "board"} ' in output


@pytest.mark.slow
@pytest.mark.parametrize('tilt', [0, 15, 45])
def test_board_with_intrinsics_tells_where_the_camera_is(report, run, tilt):
    picture = board_picture(homography=pixel_from_surface(tilt), noise=2)
    found = report('board', picture, *BOARD, '-o', 'surface.yaml', '--intrinsics', camera_info())
    foot, height = camera_place(tilt)
    assert found['camera']['height_cm'] == pytest.approx(height, rel=0.01)
    assert found['camera']['foot_cm'] == pytest.approx(foot, abs=0.01 * height)
    assert found['warnings'] == []
    values = read_parameter_file('surface.yaml').values
    x, y, z = values['surface.pinhole.camera_position_cm']
    assert [x, y] == pytest.approx(found['camera']['foot_cm'], abs=1e-3)
    assert abs(z) == pytest.approx(found['camera']['height_cm'], abs=1e-3)
    _, output, _ = run('board', picture, *BOARD, '-o', 'again.yaml', '--intrinsics',
                       'camera_info.yaml')
    told = re.search(
        r'the camera is ([\d.]+) cm above the surface .*, its foot point at \(', output)
    assert float(told[1]) == pytest.approx(height, rel=0.01)


def test_foot_point_is_in_the_camera_frame_that_was_asked_for(report):
    found = report('board', board_picture(), *BOARD, '-o', 'surface.yaml', '--intrinsics',
                   camera_info(), '--origin-corner', 2, '--origin-mm', 50, 25, '--yaw-deg', 90)
    foot, height = camera_place()
    # From the far corner both axes turn round; then x runs along the board's y.
    x, y = np.array([20, 12.5]) - foot - [5, 2.5]
    assert found['camera']['foot_cm'] == pytest.approx([y, -x], abs=0.01 * height)
    assert found['camera']['height_cm'] == pytest.approx(height, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize('tilt', [0, 30])
def test_simulated_camera_is_found_60_cm_from_the_pictures_centre(report, tilt):
    # The origin is put where the simulated board has its own; see BoardView for the place.
    intrinsics = camera_info(focal=60 / (36 / 640), centre=(320.0, 240.0))
    found = report('board', '--camera', 'simulated', '--simulated-tilt-deg', tilt, *BOARD,
                   '--placements', 1,
                   '--origin-mm', -80, -72.5, '-o', 'a.yaml', '--intrinsics', intrinsics)
    height, back = 60 * np.cos(np.radians(tilt)), 60 * np.sin(np.radians(tilt))
    assert found['camera']['height_cm'] == pytest.approx(height, rel=0.01)
    assert found['camera']['foot_cm'] == pytest.approx([18.0, 13.5 + back], abs=0.6)


def test_file_with_the_cameras_place_holds_for_objects_that_have_a_height(report):
    report('board', board_picture(), *BOARD, '-o', 'surface.yaml', '--intrinsics', camera_info())
    values = {**DEFAULTS, **read_parameter_file('surface.yaml').values, 'object_height_cm': 4.0}
    settings, (foot, height) = camera_settings(values), camera_place()
    assert settings.detector.heights_cm == (4.0,)
    assert settings.surface.camera_place.foot_cm == pytest.approx(foot, abs=0.01 * height)
    assert settings.surface.camera_place.height_cm == pytest.approx(height, rel=0.01)


def test_check_is_made_on_the_surface_whatever_the_height_of_the_objects(report):
    report('points', table(), '-o', 'a.yaml', '--image-size', '640x480')
    values = {**read_parameter_file('a.yaml').values, 'object_height_cm': 4.0,
              'surface.camera_height_cm': 45.0, 'surface.camera_foot_cm': [0.0, 0.0]}
    written('a.yaml', parameter_text(values, []))
    assert report('check', 'a.yaml', 'points.csv')['max_mm'] < 1e-6


def test_intrinsics_of_another_lens_are_refused(run):
    code, _, error = run('board', board_picture(), *BOARD, '-o', 'surface.yaml', '--intrinsics',
                         camera_info(focal=400.0))
    assert code == 1 and 'are the intrinsics those of this camera' in error


def test_full_disk_for_the_report_is_one_sentence():
    with open('/dev/full', 'w') as full:
        child = subprocess.run(
            [sys.executable, '-m', 'camera_to_base.commands.calibrate.command', 'status',
             str(Path(__file__).parents[3] / 'config' / 'simulated_tilted_camera.yaml')],
            stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
    assert child.returncode == 1
    assert child.stderr == 'calibrate: cannot print the report: No space left on device\n'


def test_word_that_is_nearly_a_command_gets_a_suggestion_and_paper_any_case(run):
    code, _, error = run('bord')
    assert code == 1 and "there is no 'bord', did you mean board?" in error
    code, output, _ = run('sheet', '--paper', 'a4', '-o', 'board.pdf')
    assert code == 0 and 'on A4' in output


@pytest.mark.slow
def test_board_ends_with_a_verdict_and_the_next_command_and_the_map_is_for_the_verbose(run):
    picture = board_picture()
    code, output, _ = run('board', picture, *BOARD, '-o', 'cell.yaml')
    verdict, step = output.splitlines()[-2:]
    assert re.match(r'(good|fair|poor): 95 % of positions within \d+\.\d mm in the mid', verdict)
    assert step == f'next: {full_command("calibrate", "base", "--live", "cell.yaml")}'
    assert 'over the picture' not in output and '\x1b' not in output
    code, output, _ = run('board', picture, *BOARD, '-o', 'cell.yaml', '--force', '--verbose')
    assert 'expected within so many mm, over the picture' in output


def test_picture_that_is_searched_is_named(capsys):
    main(['board', board_picture(), '-o', 'cell.yaml'])
    assert 'looking for the board in board.png ...' in capsys.readouterr().err


def test_errors_below_those_of_clicks_need_no_doubt():
    small = ErrorFigures(12, 0.01, 0.01, 0.02, 3, leave_one_out_rms_mm=0.02)
    assert warnings(small) == []
    large = ErrorFigures(12, 0.4, 0.4, 0.6, 3, leave_one_out_rms_mm=1.2)
    assert 'much more than the 0.40 mm' in warnings(large)[0]
