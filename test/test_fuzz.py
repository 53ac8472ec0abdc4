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

"""
Anything may come in; nothing but this package's own errors comes out.

FUZZ_CASES=100000 makes a longer run; the number of cases is printed at the end.
"""

from collections import Counter
import os

from camera_to_base.absolute_difference import AbsoluteDifferenceDetector
from camera_to_base.camera_parameters import camera_settings, CAMERA_SPECS
from camera_to_base.camera_pipeline import CameraPipeline, Limits
from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.damage_check import DamageCheck
from camera_to_base.errors import CameraToBaseError
from camera_to_base.image_decoding import decode_compressed, decode_image, ENCODINGS
from camera_to_base.messages import position_from_message
from camera_to_base.surface import HomographySurface, ParallelSurface, PolynomialSurface
from camera_to_base.transform_parameters import transform_node_settings, TRANSFORM_SPECS
import cv2
import numpy as np
import pytest
from std_msgs.msg import Float64MultiArray

hypothesis = pytest.importorskip('hypothesis')
from hypothesis import given, settings, strategies as st  # noqa: E402, I100
from hypothesis.extra import numpy as arrays  # noqa: E402

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
def print_counts(request):
    yield
    manager = request.config.pluginmanager.getplugin('capturemanager')
    with manager.global_and_fixture_disabled():
        print(f'\nfuzz: {sum(counts.values())} cases: ' + ', '.join(
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


@pytest.mark.parametrize('specs, make', [
    (CAMERA_SPECS, camera_settings), (TRANSFORM_SPECS, transform_node_settings)])
def test_any_parameter_value_is_used_or_gives_our_error(specs, make):
    defaults = {spec.name: spec.default for spec in specs}

    def like(default):
        # ROS has checked the type before; what is in a list and how long it is it has not.
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
        outcome('parameter values', make, {**defaults, **dict([changed])})

    check()


@bounded
@given(values, values)
def test_any_transform_is_made_or_gives_our_error(rotation, displacement):
    outcome('transforms', CameraToRobotBaseConversion.from_roll_pitch_yaw, rotation, displacement)


@bounded
@given(st.lists(numbers, min_size=9, max_size=9), values, values)
def test_any_surface_and_any_pixel_gives_finite_points_or_our_error(matrix, pixels, width):
    surfaces = [
        outcome('surfaces', HomographySurface, np.array(matrix, dtype=object).reshape(3, 3),
                (640, 480)),
        outcome('surfaces', ParallelSurface, width, 640),
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
        ParallelSurface(36.0, 640), limits=Limits(check_period_s=0.0),
        background_frames=background_frames)
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
        pipeline = CameraPipeline(ParallelSurface(36.0, 640))
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
