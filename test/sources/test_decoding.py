# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from array import array
import zlib

from camera_to_base.errors import InvalidValueError
from camera_to_base.sources.decoding import decode_compressed, decode_image, ENCODINGS
import cv2
import numpy as np
import pytest
import scenes

# The bytes of a pixel and OpenCV's own conversion.
EIGHT_BIT = {
    'mono8': (1, cv2.COLOR_GRAY2BGR), '8UC1': (1, cv2.COLOR_GRAY2BGR),
    'bgr8': (3, None), '8UC3': (3, None), 'rgb8': (3, cv2.COLOR_RGB2BGR),
    'bgra8': (4, cv2.COLOR_BGRA2BGR), '8UC4': (4, cv2.COLOR_BGRA2BGR),
    'rgba8': (4, cv2.COLOR_RGBA2BGR),
    'uyvy': (2, cv2.COLOR_YUV2BGR_UYVY), 'yuv422': (2, cv2.COLOR_YUV2BGR_UYVY),
    'yuyv': (2, cv2.COLOR_YUV2BGR_YUYV), 'yuv422_yuy2': (2, cv2.COLOR_YUV2BGR_YUYV)}
SIXTEEN_BIT = ['mono16', '16UC1']
YUV = ['uyvy', 'yuv422', 'yuyv', 'yuv422_yuy2']
ODD_SIZES = [(1, 1), (7, 5), (641, 3), (3, 481)]
EVEN_SIZES = [(2, 1), (6, 5), (642, 3)]
PADDINGS = [0, 1, 13]

random = np.random.default_rng(7)


def random_picture(width, height, *channels, dtype=np.uint8):
    highest = np.iinfo(dtype).max
    return random.integers(0, highest, (height, width, *channels), dtype, endpoint=True)


def sent_with(padding, picture, is_bigendian=False):
    """Give step, byte order and data of a picture whose rows are padded with random bytes."""
    rows = np.frombuffer(picture.tobytes(), np.uint8).reshape(len(picture), -1)
    rows = np.hstack([rows, random_picture(padding, len(rows))])
    return rows.shape[1], is_bigendian, array('B', rows.tobytes())


def picture():
    return scenes.StillCoin(has_disc=True)()


def jpeg(*options):
    return cv2.imencode('.jpg', picture(), options)[1].tobytes()


def png(content):
    return cv2.imencode('.png', content)[1].tobytes()


def test_every_known_encoding_is_tested_here():
    assert set(ENCODINGS) == {*EIGHT_BIT, *SIXTEEN_BIT}


@pytest.mark.parametrize('padding', PADDINGS)
@pytest.mark.parametrize('encoding', EIGHT_BIT)
def test_frame_is_what_opencv_makes_of_the_picture(encoding, padding):
    bytes_per_pixel, conversion = EIGHT_BIT[encoding]
    for width, height in EVEN_SIZES + (ODD_SIZES if encoding not in YUV else []):
        sent = random_picture(width, height, bytes_per_pixel)
        frame = decode_image(encoding, width, height, *sent_with(padding, sent))
        expected = sent if conversion is None else cv2.cvtColor(sent, conversion)
        assert frame.dtype == np.uint8 and frame.shape == (height, width, 3)
        assert np.array_equal(frame, expected)


@pytest.mark.parametrize('padding', PADDINGS)
@pytest.mark.parametrize('order', ['<u2', '>u2'])
@pytest.mark.parametrize('encoding', SIXTEEN_BIT)
def test_16_bit_picture_becomes_what_opencv_makes_of_a_16_bit_png(encoding, order, padding):
    for width, height in ODD_SIZES:
        sent = random_picture(width, height, dtype=np.uint16)
        frame = decode_image(encoding, width, height, *sent_with(
            padding, sent.astype(order), is_bigendian=order == '>u2'))
        assert np.array_equal(frame, decode_compressed(png(sent)))
        assert np.array_equal(frame[..., 0], sent // 256)


def test_colours_are_those_that_the_names_say():
    for encoding, data in {'bgr8': [255, 0, 0], 'rgb8': [0, 0, 255], 'bgra8': [255, 0, 0, 9],
                           'rgba8': [0, 0, 255, 9]}.items():
        assert decode_image(encoding, 1, 1, 4, False, bytes([*data, 0])).tolist() == [[
            [255, 0, 0]]]
    # BT.601: Y 41, U 240, V 110 is blue.
    for encoding, data in {'uyvy': [240, 41, 110, 41], 'yuyv': [41, 240, 41, 110]}.items():
        blue = decode_image(encoding, 2, 1, 4, False, bytes(data))
        assert blue.astype(int) == pytest.approx(np.tile([255, 0, 0], (1, 2, 1)), abs=2)


def test_bgr_without_padding_is_not_copied_and_everything_else_is():
    data = array('B', random_picture(4, 4, 3).tobytes())
    assert np.shares_memory(decode_image('bgr8', 4, 4, 12, False, data), np.asarray(data))
    assert not np.shares_memory(decode_image('bgr8', 3, 4, 12, False, data), np.asarray(data))
    assert not np.shares_memory(decode_image('rgb8', 4, 4, 12, False, data), np.asarray(data))


@pytest.mark.parametrize('kind', [bytes, bytearray, memoryview, lambda data: array('B', data),
                                  lambda data: np.frombuffer(data, np.uint8)])
def test_data_may_be_anything_with_a_buffer(kind):
    sent = random_picture(5, 3, 3)
    assert np.array_equal(decode_image('bgr8', 5, 3, 15, False, kind(sent.tobytes())), sent)
    compressed = png(sent)
    assert np.array_equal(decode_compressed(kind(compressed)), sent)


def test_data_behind_the_last_row_is_left_alone():
    assert decode_image('mono8', 2, 2, 2, False, bytes(100)).shape == (2, 2, 3)


@pytest.mark.parametrize('encoding, width, height, step, length, complaint', [
    ('bayer_rggb8', 4, 4, 4, 16, r"'bayer_rggb8' is not known: .* one of bgr8, 8UC3, rgb8"),
    ('', 4, 4, 4, 16, "'' is not known"),
    ('x' * 10**6, 4, 4, 4, 16, 'is not known'),
    ('bgr8', 0, 4, 12, 48, '0 x 4 px is empty'),
    ('bgr8', 4, 0, 12, 48, '4 x 0 px is empty'),
    ('bgr8', 4, 4, 0, 48, 'needs a step of 12 bytes or more, got 0'),
    ('bgr8', 4, 4, 11, 48, 'needs a step of 12 bytes or more, got 11'),
    ('mono16', 4, 4, 7, 48, 'needs a step of 8 bytes or more, got 7'),
    ('bgr8', 4, 4, 12, 47, '4 rows of 12 bytes need 48 bytes, got 47'),
    ('bgr8', 4, 4, 12, 0, 'need 48 bytes, got 0'),
    ('bgr8', 2**30, 2**31, 2**32 - 1, 48, 'bytes, got 48'),
    *[(encoding, 5, 4, 10, 40, 'even width, got 5 px') for encoding in YUV]])
def test_picture_that_does_not_fit_its_description_is_refused(
        encoding, width, height, step, length, complaint):
    with pytest.raises(InvalidValueError, match=complaint) as error:
        decode_image(encoding, width, height, step, False, bytes(length))
    assert 'camera driver' in str(error.value)
    assert len(str(error.value)) < 250


@pytest.mark.parametrize('options', [
    [], [cv2.IMWRITE_JPEG_PROGRESSIVE, 1], [cv2.IMWRITE_JPEG_RST_INTERVAL, 4]])
def test_jpeg_is_decoded_whole_and_refused_cut(options):
    content = jpeg(*options)
    frame = decode_compressed(content, 'jpeg')
    assert np.array_equal(frame, cv2.imdecode(np.frombuffer(content, np.uint8), 1))
    assert np.array_equal(decode_compressed(content + bytes(100)), frame)
    for length in [*range(3, len(content), 997), len(content) - 2, len(content) - 1]:
        with pytest.raises(InvalidValueError, match=f'of {length} bytes was cut off'):
            decode_compressed(content[:length])


def test_cut_jpeg_whose_thumbnail_is_whole_is_refused():
    content, thumbnail = jpeg(), cv2.imencode('.jpg', picture()[::8, ::8])[1].tobytes()
    segment = b'\xff\xe1' + (len(thumbnail) + 2).to_bytes(2, 'big') + thumbnail
    content = content[:2] + segment + content[2:]
    assert decode_compressed(content).shape == (480, 640, 3)
    for length in (len(segment) + 10, len(content) // 2, len(content) - 2):
        with pytest.raises(InvalidValueError):
            decode_compressed(content[:length])


def test_png_is_decoded_whole_and_refused_cut_or_altered():
    sent = picture()
    content = png(sent)
    assert np.array_equal(decode_compressed(content, 'png'), sent)
    for length in (8, 40, len(content) // 2, len(content) - 12, len(content) - 1):
        with pytest.raises(InvalidValueError, match='was cut off'):
            decode_compressed(content[:length])
    altered = bytearray(content)
    altered[len(content) // 2] ^= 4
    with pytest.raises(InvalidValueError, match='is damaged'):
        decode_compressed(altered)


def test_grey_and_transparent_pictures_become_bgr():
    grey, transparent = random_picture(9, 7), random_picture(9, 7, 4)
    assert np.array_equal(decode_compressed(png(grey)), cv2.merge([grey] * 3))
    assert np.array_equal(decode_compressed(png(transparent)), transparent[..., :3])
    grey_jpeg = cv2.imencode('.jpg', grey)[1].tobytes()
    assert decode_compressed(grey_jpeg).shape == (7, 9, 3)


@pytest.mark.parametrize('content', [
    b'', b'\xff\xd8', b'\x00\x00\x00\x01\x67', bytes(1000),
    cv2.imencode('.bmp', random_picture(4, 4, 3))[1].tobytes()])
def test_what_is_no_jpeg_and_no_png_is_refused_with_its_format(content):
    with pytest.raises(InvalidValueError, match=rf"{len(content)} bytes of format 'h264'"):
        decode_compressed(content, 'h264')


def test_size_beyond_all_limits_is_refused():
    content = bytearray(png(random_picture(4, 4, 3)))
    content[16:24] = (200000).to_bytes(4, 'big') * 2
    content[29:33] = zlib.crc32(content[12:29]).to_bytes(4, 'big')
    with pytest.raises(InvalidValueError, match='damaged'):
        decode_compressed(content)


def test_photograph_is_decoded_as_it_is_stored_whatever_its_exif_orientation():
    content = cv2.imencode('.jpg', np.full((40, 60, 3), 90, np.uint8))[1].tobytes()
    # Orientation 6 asks viewers to turn the picture by a quarter.
    exif = (b'\xff\xe1\0\x22Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0'
            b'\0\0\0\0')
    turned = content[:2] + exif + content[2:]
    assert cv2.imdecode(np.frombuffer(turned, np.uint8), cv2.IMREAD_COLOR).shape == (60, 40, 3)
    assert decode_compressed(turned).shape == (40, 60, 3)
