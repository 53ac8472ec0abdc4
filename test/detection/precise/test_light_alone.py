# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What only its sharp edge tells from light: it is published with a warning, or as is chosen."""

import math

from camera_to_base.detection import DetectorSettings, PreciseDifferenceDetector
from camera_to_base.errors import InvalidValueError
from camera_to_base.pipeline import CameraPipeline
from camera_to_base.surface.models import ParallelSurface
import cv2
from lit_table import coded, painted as painted_by
import numpy as np
import pytest

SIZE = 240, 320
GREY, PATCH, COIN = (0.3, 0.3, 0.3), (100, 120), (240, 120)


def seen(light, seed=1):
    grey = 255 * np.clip(light, 0, 1) ** (1 / 2.2)
    noise = np.random.default_rng(seed).normal(0, 1.5, light.shape)
    return np.uint8(np.clip(np.rint(grey + noise), 0, 255))


def table(colour=GREY, texture=0.0):
    grain = cv2.GaussianBlur(np.random.default_rng(3).normal(0, 1, SIZE), (0, 0), 2)
    return np.float32(colour) * (1 + texture * grain / grain.std())[..., None].astype(np.float32)


def disc(centre, radius=25):
    large = np.zeros((4 * SIZE[0], 4 * SIZE[1]), np.uint8)
    cv2.circle(large, [4 * one for one in centre], 4 * radius, 255, cv2.FILLED)
    shares = cv2.resize(large, SIZE[::-1], interpolation=cv2.INTER_AREA) / np.float32(255)
    return cv2.GaussianBlur(shares, (0, 0), 0.7)[..., None]


def painted(light, colour, centre=PATCH):
    return painted_by(light, disc(centre), colour)


def detected(light, frame, **others):
    detector = PreciseDifferenceDetector(seen(light), **others)
    return detector.detect(seen(frame, 2)), [one.kind for one in detector.dropped]


@pytest.mark.parametrize('gain', [0.3, 0.6, 2.0])
def test_grey_patch_on_a_grey_surface_may_be_light(gain):
    (found,), _ = detected(table(), painted(table(), gain * np.float32(GREY)))
    assert found.may_be_light
    assert found.centre == pytest.approx(PATCH, abs=0.5)


def test_patch_with_straight_sides_may_be_light():
    gain = np.ones(SIZE, np.float32)
    gain[80:160, 60:140] = 0.5
    (found,), _ = detected(table(), table() * cv2.GaussianBlur(gain, (0, 0), 3.0)[..., None])
    assert found.may_be_light


def graded():
    across = np.linspace(0.6, 1.4, SIZE[1], dtype=np.float32)[None, :, None]
    return table((0.4, 0.4, 0.4)) * across


@pytest.mark.parametrize('gain', [0.5, 1.6, 2.4])
def test_light_on_a_surface_that_gets_darker_to_one_side_may_be_light(gain):
    for shares in (disc(PATCH), disc((160, 120), 80)):
        (found,), _ = detected(graded(), graded() * (1 + (gain - 1) * shares))
        assert found.may_be_light


def test_grey_thing_on_a_surface_that_gets_darker_to_one_side_is_a_thing():
    for colour in (0.15, 0.62):
        (found,), _ = detected(graded(), painted_by(graded(), disc((160, 120), 80), (colour,) * 3))
        assert not found.may_be_light


NEARLY_BLACK = (0.008, 0.009, 0.008)


@pytest.mark.parametrize('texture', [0.0, 0.06])
@pytest.mark.parametrize('strength, blur', [(0.13, 4.0), (0.25, 7.0), (0.25, 10.0)])
def test_lamp_that_a_nearly_black_table_mirrors_is_no_thing(texture, strength, blur):
    image = cv2.GaussianBlur(disc((130, 120), 75), (0, 0), blur)[..., None]
    surface = table(NEARLY_BLACK, texture)
    found, left_out = detected(surface, surface + np.float32(strength) * image)
    assert found == []
    assert left_out[0] in ('light', 'light_or_thing')


def test_pale_thing_out_of_focus_is_a_thing():
    surface = table(NEARLY_BLACK)
    frame = cv2.GaussianBlur(painted(surface, (0.5, 0.5, 0.5)), (0, 0), 2.2)
    (found,), _ = detected(surface, frame)
    assert found.centre == pytest.approx(PATCH, abs=0.5) and not found.may_be_light


@pytest.mark.parametrize('colour', [
    (0.3, 0.1, 0.1), (0.02, 0.02, 0.02), (0.9, 0.9, 0.9), (0.15, 0.2, 0.15)])
def test_another_colour_black_and_white_are_no_light(colour):
    (found,), _ = detected(table(), painted(table(), colour))
    assert not found.may_be_light


def test_texture_below_or_of_its_own_tells_that_it_is_a_thing():
    textured = table(texture=0.1)
    (found,), _ = detected(textured, painted(textured, (0.15, 0.15, 0.15)))
    assert not found.may_be_light
    (found,), _ = detected(table(), painted(table(), 0.5 * table(texture=0.2)))
    assert not found.may_be_light


def stained():
    stains = cv2.GaussianBlur(np.random.default_rng(4).normal(0, 1, SIZE), (0, 0), 4)
    return table() * (1 + 0.02 * stains / stains.std())[..., None].astype(np.float32)


@pytest.mark.parametrize('gain', [0.4, 0.6, 1.8])
def test_light_that_shows_the_tables_stains_is_no_object(gain):
    found, dropped = detected(stained(), painted(stained(), gain * stained()))
    assert found == [] and set(dropped) & {'shade', 'light'}


@pytest.mark.parametrize('level', [0.12, 0.18, 0.55])
def test_grey_thing_on_a_stained_table_is_an_object(level):
    (found,), _ = detected(stained(), painted(stained(), (level,) * 3))
    assert found.centre == pytest.approx(PATCH, abs=0.5)


@pytest.mark.parametrize('width', [4, 12])
def test_grey_thing_across_a_rack_s_shadow_is_an_object(width):
    shade = np.ones(SIZE, np.float32)
    shade[:, PATCH[0] - 5:] = 0.6
    shade = cv2.GaussianBlur(shade, (0, 0), width)[..., None]
    (found,), _ = detected(table() * shade, painted(table(), (0.15, 0.15, 0.15)) * shade)
    assert found.centre == pytest.approx(PATCH, abs=0.7)


def photographed(light, seed):
    _, code = cv2.imencode('.jpg', seen(light, seed), [cv2.IMWRITE_JPEG_QUALITY, 85])
    return cv2.imdecode(code, cv2.IMREAD_COLOR)


@pytest.mark.parametrize('gain', [0.4, 0.66, 1.55, 2.2])
def test_light_on_a_table_that_has_hardly_any_blue_is_no_object(gain):
    # Of what is nearly black, the sensor and the picture's coding leave any chroma.
    green = table((0.0008, 0.55, 0.34), 0.02)
    detector = PreciseDifferenceDetector(photographed(green, 1))
    lit = painted(painted(green, gain * green), (0.05, 0.05, 0.05), COIN)
    (found,) = detector.detect(photographed(lit, 2))
    assert found.centre == pytest.approx(COIN, abs=0.5)
    assert {'light', 'shade', 'light_or_thing'} & {one.kind for one in detector.dropped}


@pytest.mark.parametrize('choice, published, kinds', [
    ('leave_out', 2, []), ('publish', 2, []), ('leave_out_all', 1, ['light_or_thing'])])
def test_what_is_done_with_it_is_chosen(choice, published, kinds):
    frame = painted(painted(table(), (0.15, 0.15, 0.15)), (0.1, 0.1, 0.3), COIN)
    found, dropped = detected(table(), frame, light_or_thing=choice)
    assert len(found) == published and dropped == kinds
    assert not min(found, key=lambda one: abs(one.centre.u - COIN[0])).may_be_light


def test_other_choice_is_named():
    with pytest.raises(InvalidValueError, match="one of leave_out, .*got 'maybe'"):
        PreciseDifferenceDetector(seen(table()), light_or_thing='maybe')


@pytest.mark.parametrize('choice, kind', [
    ('leave_out', 'may_be_light'), ('publish', None), ('leave_out_all', None)])
def test_pipeline_warns_while_it_is_published(choice, kind):
    pipeline = CameraPipeline(
        ParallelSurface(16.0, SIZE[1]), DetectorSettings(light_or_thing=choice))
    pipeline.process(seen(table()), 1.0)
    frame = painted(table(), (0.15, 0.15, 0.15))
    for second in range(2, 5):
        pipeline.process(seen(frame, second), float(second))
    doubt = pipeline.doubt
    assert (doubt and doubt.kind) == kind
    assert doubt is None or '(100, 120) px' in doubt.sentence
    pipeline.process(seen(table(), 6), 6.0)
    assert pipeline.doubt is None


def bolt_in_its_shade(light, gains, metal=None):
    """Lay a grey bolt down: darker and darker across, with two lamps' soft shade beside it."""
    shade = np.zeros(SIZE, np.float32)
    for corners in (((66, 110), (186, 106), (186, 130), (66, 130)),
                    ((64, 110), (184, 110), (184, 136), (68, 132))):
        one = np.zeros(SIZE, np.float32)
        cv2.fillConvexPoly(one, np.int32(corners), 1)
        shade = shade + cv2.GaussianBlur(one, (0, 0), 3)
    light = light * (1 - 0.25 * shade)[..., None]
    faces = np.zeros((8 * SIZE[0], 8 * SIZE[1]), np.float32)
    for index, gain in enumerate(gains):
        for left, right, half in ((70, 170, 8), (160, 182, 14)):
            step = 2 * half / len(gains)
            cv2.rectangle(faces, np.int32([8 * left, 8 * (118 - half + index * step)]).tolist(),
                          np.int32([8 * right, 8 * (118 - half + (index + 1) * step)]).tolist(),
                          gain, cv2.FILLED)
    shares = cv2.resize(np.float32(faces > 0), SIZE[::-1], interpolation=cv2.INTER_AREA)
    faces = cv2.resize(faces, SIZE[::-1], interpolation=cv2.INTER_AREA)
    shares, faces = (cv2.GaussianBlur(one, (0, 0), 0.7)[..., None] for one in (shares, faces))
    return light * (1 - shares) + faces * (light[0, 0] if metal is None else metal)


@pytest.mark.parametrize('lightest, darkest', [(0.95, 0.35), (0.8, 0.2), (0.65, 0.35)])
def test_faces_with_sharp_edges_between_them_are_a_thing(lightest, darkest):
    white = table((0.7, 0.7, 0.7))
    bolt = bolt_in_its_shade(white, np.linspace(lightest, darkest, 12))
    (found,), _ = detected(white, bolt)
    # Its shade may be a part of it.
    assert found.doubt > 1
    assert math.dist(found.centre, (126, 118)) < 3 * found.doubt


@pytest.mark.parametrize('colour, metal', [
    ((0.4, 0.35, 0.5), 0.35), ((0.4, 0.35, 0.5), 0.5), ((0.1, 0.12, 0.14), 0.35),
    ((0.15, 0.1, 0.13), 0.2)])
def test_dark_half_that_no_edge_tells_from_shade_widens_the_ellipse(colour, metal):
    bolt = bolt_in_its_shade(table(colour), np.linspace(1, 0.15, 12), metal)
    detector = PreciseDifferenceDetector(coded(table(colour), 1, 88))
    found, = detector.detect(coded(bolt, 2, 88))
    assert math.dist(found.centre, (126, 118)) < 3 * max(found.doubt, 0.5)


@pytest.mark.parametrize('colour, least, most', [
    ((0.05, 0.05, 0.05), 4, 8), ((0.04, 0.05, 0.3), 0, 0)])
def test_grey_face_may_be_missing_in_a_notch(colour, least, most):
    corner = np.zeros((*SIZE, 1), np.float32)
    cv2.fillPoly(corner, [np.int32(
        [(80, 80), (150, 80), (150, 100), (100, 100), (100, 150), (80, 150)])], 1)
    (found,), _ = detected(table(), painted_by(table(), corner, colour))
    assert least <= found.doubt <= most
    # The whole may be a box with a face like the table.
    assert not least or math.dist(found.centre, (115, 115)) < 3 * found.doubt


def test_uneven_crescent_is_a_thing_in_doubt():
    light = table((0.2, 0.3, 0.4))
    crescent = disc(PATCH, 40) * (1 - disc((118, 132), 40))
    across = np.interp(np.arange(SIZE[1]), (60, 130), (0.4, 0.8))[None, :, None]
    (found,), _ = detected(light, painted_by(light, crescent, light * np.float32(across)))
    assert 5 < found.doubt < 20
