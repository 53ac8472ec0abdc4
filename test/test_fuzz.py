# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Anything may come in; nothing but this package's own errors comes out.

FUZZ_CASES=100000 makes a longer run; the number of cases is printed at the end.
"""

from collections import Counter
import math
import os

from camera_to_base.calibration.base import calibrate_base
from camera_to_base.calibration.surface import calibrate_surface, check_surface
from camera_to_base.calibration.tables import (
    PAIR_COLUMNS, PAIR_HEIGHTS, POINT_COLUMNS, read_camera_info, read_pairs, read_points,
    SIZE_COLUMNS)
from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.detection.tutorial import AbsoluteDifferenceDetector
from camera_to_base.errors import CalibrationError, CameraToBaseError, InvalidValueError
from camera_to_base.parameters.file import parameter_text, read_parameter_file
from camera_to_base.parameters.spec import checked_values
from camera_to_base.parameters.transform import transform_node_settings, TRANSFORM_SPECS
from camera_to_base.pipeline.damage import DamageCheck
from camera_to_base.pipeline.pipeline import CameraPipeline
from camera_to_base.pipeline.sighting import Limits
from camera_to_base.ros.messages import (
    MOST_POSES, point_from_message, poses_from_message, position_from_message)
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.sources.decoding import decode_compressed, decode_image, ENCODINGS
from camera_to_base.sources.kinds import DEVICE
from camera_to_base.surface.models import (
    HomographySurface, ParallelSurface, PolynomialSurface, SURFACE_DEFAULTS)
from camera_to_base.surface.points import MatchedPoints
import cv2
from geometry_msgs.msg import Point, PointStamped, Pose, PoseArray, Quaternion
import numpy as np
import pytest
from std_msgs.msg import Float64MultiArray
import yaml

hypothesis = pytest.importorskip('hypothesis')
from hypothesis import given, settings, strategies as st  # noqa: E402, I100
from hypothesis.extra import numpy as arrays  # noqa: E402

pytestmark = pytest.mark.slow

CASES = int(os.environ.get('FUZZ_CASES', '150'))
counts = Counter()

bounded = settings(max_examples=CASES, deadline=None, derandomize='FUZZ_CASES' not in os.environ,
                   database=None)
numbers = st.floats() | st.integers() | st.sampled_from([1e308, -1e308, 5e-324, 2**63, 0, -0.0])
scalars = numbers | st.booleans() | st.none() | st.text(max_size=5) | st.binary(max_size=5)
values = scalars | st.lists(scalars, max_size=10)
sides = st.integers(0, 40)
pictures = arrays.arrays(
    st.sampled_from([np.uint8] * 6 + [np.int16, np.float32, np.bool_]),
    st.tuples(sides, sides, st.just(3)) | st.tuples(sides, sides) | st.tuples(
        sides, sides, st.integers(0, 5)) | arrays.array_shapes(max_side=6))


@pytest.fixture(scope='module', autouse=True)
def print_counts(tell):
    yield
    tell(f'fuzz: {sum(counts.values())} cases: ' + ', '.join(
        f'{number} {name}' for name, number in sorted(counts.items())))


def outcome(name, function, *arguments, **options):
    """Give what a function returns, or None where it raises an error of our own."""
    counts[name] += 1
    try:
        return function(*arguments, **options)
    except CameraToBaseError as error:
        assert str(error)
        return None


@bounded
@given(st.lists(st.floats(), max_size=40))
def test_any_message_gives_a_finite_position_or_our_error(data):
    position = outcome('messages', position_from_message, Float64MultiArray(data=data))
    if position is not None:
        assert np.isfinite(position).all() and len(position) == 2
        conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
        outcome('transforms', conversion.convert_point, *position)


points = st.builds(Point, x=st.floats(), y=st.floats(), z=st.floats())
# Any numbers, and those that are a yaw, or nearly.
quaternions = st.builds(
    Quaternion, x=st.floats(), y=st.floats(), z=st.floats(), w=st.floats()) | st.builds(
        lambda half, error: Quaternion(x=error, y=0.0, z=math.sin(half), w=math.cos(half) + error),
        st.floats(-10, 10), st.sampled_from([0.0, 0.0, 1e-6, 9e-4, 2e-3, math.nan]))
near_points = st.builds(Point, x=st.floats(-9, 9), y=st.floats(-9, 9), z=st.floats(-9, 9))
poses = st.builds(Pose, position=points | near_points, orientation=quaternions)
TRANSFORM = transform_node_settings({spec.name: spec.default for spec in TRANSFORM_SPECS})


@bounded
@given(points | near_points)
def test_any_stamped_point_gives_a_finite_one_in_reach_or_our_error(point):
    camera_point = outcome('point messages', point_from_message, PointStamped(point=point))
    if camera_point is not None:
        assert np.isfinite([point.x, point.y, point.z]).all()
        base_point = outcome('transforms', TRANSFORM.base_point, *camera_point)
        assert base_point is None or np.isfinite(base_point).all()
        assert base_point is None or math.hypot(*base_point[:2]) <= TRANSFORM.reach_cm


@bounded
@given(st.lists(poses, max_size=6), st.sampled_from([1, 1, 1, MOST_POSES]))
def test_any_array_of_poses_gives_as_many_finite_ones_or_our_error(found, repeated):
    camera_poses = outcome(
        'pose messages', poses_from_message, PoseArray(poses=found * repeated))
    if camera_poses is not None:
        assert len(camera_poses) == len(found * repeated) <= MOST_POSES
        assert np.isfinite([pose.yaw for pose in camera_poses]).all()
        for pose in camera_poses[:6]:
            base_pose = outcome('transforms', TRANSFORM.base_pose, pose)
            assert base_pose is None or np.isfinite(base_pose).all()


@pytest.mark.parametrize('specs, make', [
    (CAMERA_SPECS, camera_settings), (TRANSFORM_SPECS, transform_node_settings)])
def test_any_parameter_value_is_used_or_gives_our_error(specs, make):
    defaults = {spec.name: spec.default for spec in specs}

    def like(default):
        # ROS has checked the type before.
        if isinstance(default, list):
            kind = st.integers(-2**63, 2**63 - 1) if default and isinstance(
                default[0], int) else st.floats()
            return st.lists(kind, max_size=12)
        return {bool: st.booleans(), int: st.integers(-2**63, 2**63 - 1), float: st.floats(),
                str: st.text(st.characters(exclude_categories=['Cs']), max_size=30)}[type(default)]

    @bounded
    @given(st.sampled_from(sorted(defaults)).flatmap(
        lambda name: st.tuples(st.just(name), like(defaults[name]))))
    def check(changed):
        values = outcome('parameter values', checked_values, specs, dict([changed]))
        if values is not None:
            outcome('settings', make, values)

    check()


@bounded
@given(values, values)
def test_any_transform_is_made_or_gives_our_error(rotation, displacement):
    outcome('transforms', CameraToRobotBaseConversion.from_roll_pitch_yaw, rotation, displacement)


@bounded
@given(st.lists(numbers, min_size=9, max_size=9), values)
def test_any_surface_and_any_pixel_gives_finite_points_or_our_error(matrix, pixels):
    surfaces = [
        ParallelSurface(),
        outcome('surfaces', HomographySurface, np.array(matrix, dtype=object).reshape(3, 3),
                (640, 480)),
        outcome('surfaces', PolynomialSurface, y_of_v=matrix[:3], px_per_cm_of_y=matrix[3:6],
                centre_u=matrix[6], image_size=(640, 480))]
    for surface in surfaces:
        if surface is not None:
            points = outcome('pixels', surface.locate, pixels)
            assert points is None or np.isfinite(points).all()


@bounded
@given(pictures, pictures)
def test_any_two_pictures_are_detected_on_or_give_our_error(background, frame):
    detector = outcome('pictures', AbsoluteDifferenceDetector, background)
    if detector is not None:
        outcome('pictures', detector.detect, frame)


@bounded
@given(st.lists(pictures, max_size=4), st.integers(1, 3))
def test_any_frames_go_through_the_pipeline_or_give_our_error(frames, background_frames):
    pipeline = CameraPipeline(
        ParallelSurface(36.0, 640), limits=Limits(),
        background_frames=background_frames, kind=DEVICE)
    for frame in frames:
        outcome('frames', pipeline.process, frame, 0.0)


@bounded
@given(st.lists(arrays.arrays(np.uint8, st.tuples(
    st.integers(1, 40), st.integers(1, 40), st.just(3))), max_size=5))
def test_any_picture_is_judged_for_damage(frames):
    check = DamageCheck()
    for frame in frames:
        reason = outcome('frames judged', check.reason, frame)
        assert reason is None or reason


@bounded
@given(st.binary(max_size=300), st.integers(0, 600), st.integers(0, 7))
def test_any_damaged_jpeg_that_opencv_decodes_goes_through_the_pipeline(tail, cut, bit):
    _, jpeg = cv2.imencode('.jpg', np.full((48, 64, 3), 200, np.uint8))
    content = bytearray(jpeg.tobytes()[:cut] + tail)
    if content:
        content[len(content) // 2] ^= 1 << bit
    frame = cv2.imdecode(np.frombuffer(bytes(content), np.uint8), cv2.IMREAD_COLOR) \
        if content else None
    if frame is not None and frame.size < 10**7:
        pipeline = CameraPipeline(ParallelSurface(36.0, 640), kind=DEVICE)
        outcome('jpegs', pipeline.process, frame, 0.0)
        outcome('jpegs', pipeline.process, frame, 0.0)
    counts['jpegs'] += 1


@bounded
@given(st.sampled_from([*ENCODINGS, 'nv12', '']), st.integers(-1, 2**32 - 1) | sides,
       st.integers(-1, 2**32 - 1) | sides, st.integers(-1, 2**32 - 1) | st.integers(0, 200),
       st.booleans(), st.binary(max_size=2000))
def test_any_picture_message_gives_a_frame_or_our_error(
        encoding, width, height, step, is_bigendian, data):
    frame = outcome('raw pictures', decode_image, encoding, width, height, step, is_bigendian,
                    data)
    assert frame is None or (frame.dtype == np.uint8 and frame.shape == (height, width, 3))


@bounded
@given(st.sampled_from(['.jpg', '.png']), st.floats(0, 1), st.integers(0, 255),
       st.binary(max_size=30), st.text(max_size=5))
def test_any_compressed_picture_gives_a_frame_or_our_error(ending, place, value, tail, name):
    content = bytearray(cv2.imencode(ending, np.full((48, 64, 3), 200, np.uint8))[1].tobytes())
    content[int(place * (len(content) - 1))] = value
    frame = outcome('compressed pictures', decode_compressed, content + tail, name)
    assert frame is None or (frame.dtype == np.uint8 and frame.ndim == 3 and frame.shape[2] == 3)
    outcome('compressed pictures', decode_compressed, tail, name)


texts = st.text(st.characters(exclude_categories=['Cs']), max_size=60)
MATCHED = MatchedPoints(np.array([[1.0, 2.0], [3.0, 1.0], [5.0, 6.0]]),
                        np.array([[10.0, 20.0], [300.0, 10.0], [500.0, 400.0]]))
# What a YAML reader stumbles over: anchors and cycles, depth, tags, numbers without an end.
YAML_PARTS = [
    '/**:', ' ros__parameters:', ' surface:', ' model: homography', ' image_size: [640, 480]',
    ' surface.hull: ', '\n', '\n  ', '\n    ', ' ', ': ', '- ', '? ', '&a ', '*a', '<<: *a', '[',
    ']', '{', '}', ',', '"', "'", '|', '>', '#', '---\n', '...', '%YAML 9.9', '!!timestamp ',
    '!!int ', '!!float ', '!!bool ', '!!binary ', '!!set ', '!!omap ', '!!python/name:os.system ',
    '2001-13-45', '2001-01-01 99:99:99', '.nan', '-.inf', '1e999', '0x', '0b', '1:99', '1_0', '=',
    '~', 'no', '1' * 5000, '[' * 500, '- ' * 500, '\0', '\t', '\ufeff', '\u2028', '"\\ud800"']
yaml_texts = st.lists(st.sampled_from(YAML_PARTS), max_size=30).map(''.join)
names = st.sampled_from([*SURFACE_DEFAULTS, 'surface', 'model', 'surface.']) | st.text(max_size=3)
trees = st.dictionaries(
    names | scalars, st.recursive(values | st.dates() | st.datetimes(), lambda more: st.lists(
        more, max_size=3) | st.dictionaries(names | numbers, more, max_size=3)), max_size=5)
parameter_files = trees.map(
    lambda tree: yaml.safe_dump({'/**': {'ros__parameters': tree}}, allow_unicode=True))
info_parts = values | st.sampled_from(['plumb_bob', 640, 480, [0.0] * 5]) | st.dictionaries(
    st.sampled_from(['data', 'rows']), values | st.just([600.0, 0, 320, 0, 600, 240, 0, 0, 1]))
camera_info_files = st.dictionaries(
    st.sampled_from(['image_width', 'image_height', 'distortion_model', 'camera_matrix',
                     'distortion_coefficients']), info_parts, min_size=3).map(yaml.safe_dump)
good_cells = st.sampled_from(range(0, 640, 80)) | st.floats(0, 639)
bad_cells = numbers.map(str) | st.sampled_from(
    ['', ' ', '"', '""', '"1', '1"', '"1\n2"', '1,5', '1;5', '0x10', '1_0', '١', 'nan', '\0'])


@st.composite
def tables(draw, required, optional):
    """Make a table that is good, or has a few things wrong."""
    header = [*required, *draw(st.sampled_from([(), ('remark',), optional]))]
    constant = {name: draw(good_cells) for name in optional}
    rows = [[str(constant.get(name, draw(good_cells))) for name in header]
            for _ in range(draw(st.integers(0, 12)))]
    for _ in range(draw(st.sampled_from([0, 0, 0, 1, 2])) if rows else 0):
        row = draw(st.sampled_from(rows))
        row[draw(st.integers(0, len(header) - 1))] = draw(bad_cells)
    dropped = draw(st.sampled_from([len(header)] * 9 + [len(header) - 1]))
    separator = draw(st.sampled_from([',', ',', ';', '\t']))
    end = draw(st.sampled_from(['\n', '\r\n', '\r', '\n\n']))
    lines = [separator.join(row[:dropped]) for row in [header, *rows]]
    return draw(st.sampled_from(['', '\ufeff'])) + end.join(lines)


@pytest.fixture(scope='module')
def file(tmp_path_factory):
    """Give a function that writes text or bytes to a file, and returns its path."""
    path = str(tmp_path_factory.mktemp('fuzz') / 'file')

    def write(content):
        with open(path, 'wb') as output:
            output.write(content if isinstance(content, bytes) else content.encode(
                'utf-8', 'surrogatepass'))
        return path

    return write


@bounded
@given(st.binary(max_size=200) | texts | yaml_texts | parameter_files | parameter_files)
def test_any_parameter_file_is_read_and_used_or_gives_our_error(file, content):
    found = outcome('parameter files', read_parameter_file, file(content))
    if found is None:
        return
    outcome('surfaces from files', check_surface, found.values, MATCHED)
    text = outcome('parameter files written', parameter_text, found.values, found.comments)
    if text is not None:
        again = outcome('parameter files', read_parameter_file, file(text))
        assert repr(sorted(again.values.items())) == repr(sorted(found.values.items()))


@bounded
@given(yaml_texts | camera_info_files)
def test_any_camera_info_file_is_read_or_gives_our_error(file, content):
    outcome('camera_info files', read_camera_info, file(content))


@bounded
@given(st.binary(max_size=200) | texts | tables(POINT_COLUMNS, SIZE_COLUMNS))
def test_any_table_of_points_is_calibrated_on_or_gives_our_error(file, content):
    found = outcome('tables', read_points, file(content))
    if found is None:
        return
    matched, image_size = found
    outcome('surfaces checked', check_surface, SURFACE_DEFAULTS, matched, image_size)
    for model in ('homography', 'polynomial'):
        outcome('calibrations', calibrate_surface, matched, image_size or (640, 480),
                source='a table', model=model)


@bounded
@given(st.binary(max_size=200) | texts | tables(PAIR_COLUMNS, PAIR_HEIGHTS))
def test_any_table_of_pairs_is_calibrated_on_or_gives_our_error(file, content):
    pairs = outcome('tables', read_pairs, file(content))
    if pairs is not None:
        outcome('calibrations', calibrate_base, pairs, source='a table')


def test_table_of_100000_rows_is_checked_on_and_refused_for_a_fit(file):
    number = np.arange(100_000)
    columns = [number % 639 + number / 1e6, number // 639 + number / 1e6]
    rows = np.stack([0.05 * columns[0], 0.05 * columns[1], *columns], axis=1)
    text = '\n'.join(','.join(map(str, row)) for row in rows.tolist())
    matched, _ = read_points(file(','.join(POINT_COLUMNS) + '\n' + text))
    assert check_surface(SURFACE_DEFAULTS, matched)['points'] == 100_000
    for model in ('homography', 'polynomial'):
        with pytest.raises(CalibrationError, match='100000 points are too many'):
            calibrate_surface(matched, (640, 480), source='a table', model=model)
    pairs = read_pairs(file(','.join(PAIR_COLUMNS) + '\n' + text))
    with pytest.raises(CalibrationError, match='give 1000 at most'):
        calibrate_base(pairs, source='a table')


@pytest.mark.parametrize('read', [
    read_parameter_file, read_camera_info, read_points, read_pairs])
def test_what_is_no_file_is_refused(read, tmp_path):
    for path in (str(tmp_path), str(tmp_path / 'missing'), 'a\0b', 'x' * 5000, ''):
        with pytest.raises(InvalidValueError, match='cannot read the'):
            read(path)
