# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from itertools import combinations

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.detection.detection import Box, Detection, Pixel
from camera_to_base.detection.left_out import Point
from camera_to_base.detection.locator import LocatedObject
from camera_to_base.drawing.files import check_picture_path, encoded_picture
from camera_to_base.drawing.pictures import base_label, draw_note, draw_objects, object_mask
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np
import pytest

GREY = 100


def grey_frame(width=640, height=480):
    return np.full((height, width, 3), GREY, np.uint8)


def located(box, point=(19.5, 13.75)):
    centre = Pixel(box[0] + box[2] // 2, box[1] + box[3] // 2)
    outline = np.zeros((1, 2), np.int32)
    detection = Detection(Box(*box), centre, float(box[2] * box[3]), outline, False)
    return LocatedObject(detection, Point(*point))


def changed(picture):
    return (picture != GREY).any(axis=2)


@pytest.fixture
def texts(monkeypatch):
    drawn, put_text = [], cv2.putText

    def record(picture, text, corner, font, scale, colour, thickness, *others):
        (width, height), below = cv2.getTextSize(text, font, scale, thickness)
        drawn.append((text, corner[0], corner[1] - height, width, height + below))
        return put_text(picture, text, corner, font, scale, colour, thickness, *others)

    monkeypatch.setattr(cv2, 'putText', record)
    return drawn


def test_box_is_drawn_around_the_object():
    drawn = changed(draw_objects(grey_frame(), [located((200, 150, 60, 40))]))
    assert drawn[150, 200:260].all() and drawn[189, 200:260].all()
    assert drawn[150:190, 200].all() and drawn[150:190, 259].all()


def test_centre_is_drawn_and_the_rest_of_the_object_stays_visible():
    drawn = changed(draw_objects(grey_frame(), [located((200, 150, 60, 40))]))
    inside = drawn[152:188, 202:258]
    rows, columns = np.nonzero(inside)
    assert drawn[170, 230]
    assert (rows.mean() + 152, columns.mean() + 202) == pytest.approx((170, 230), abs=0.01)
    assert 0 < inside.mean() < 0.05


def test_rest_of_the_frame_is_left_as_it_is():
    drawn = changed(draw_objects(grey_frame(), [located((200, 150, 60, 40))]))
    drawn[120:195, 190:400] = False
    assert not drawn.any()


def test_text_tells_the_position_in_cm(texts):
    draw_objects(grey_frame(), [located((200, 150, 60, 40), (19.504, -13.75))])
    assert [text for text, *_ in texts] == ['1: x 19.50, y -13.75 cm']


def test_every_object_is_drawn(texts):
    boxes = [(50, 100, 40, 40), (300, 300, 60, 30), (500, 60, 20, 80)]
    drawn = changed(draw_objects(
        grey_frame(), [located(box, (x, 0)) for x, box in enumerate(boxes)]))
    assert all(drawn[y, x] and drawn[y + h // 2, x + w // 2] for x, y, w, h in boxes)
    assert [text for text, *_ in texts] == [f'{x + 1}: x {x}.00, y 0.00 cm' for x in range(3)]


@pytest.mark.parametrize('x', [0, 300, 636])
@pytest.mark.parametrize('y', [0, 240, 476])
def test_text_stays_inside_the_picture(texts, x, y):
    draw_objects(grey_frame(), [located((x, y, 4, 4), (-100.25, -200.75))])
    (_, left, top, width, height), = texts
    assert 0 <= left and left + width <= 640
    assert 0 <= top and top + height <= 480


def overlap(one, other):
    (_, x, y, width, height), (_, other_x, other_y, other_width, other_height) = one, other
    return (x < other_x + other_width and other_x < x + width
            and y < other_y + other_height and other_y < y + height)


@pytest.mark.parametrize('magnification', [0.5, 1, 3])
def test_labels_of_neighbours_do_not_cover_each_other_nor_the_objects(texts, magnification):
    boxes = [(200, 150, 60, 40), (250, 195, 70, 30), (210, 230, 50, 50), (262, 150, 40, 30),
             (100, 150, 90, 60), (560, 20, 60, 60), (10, 430, 50, 40)]
    boxes = [tuple(int(magnification * value) for value in box) for box in boxes]
    frame = grey_frame(int(640 * magnification), int(480 * magnification))
    draw_objects(frame, [located(box) for box in boxes])
    assert len(texts) == len(boxes)
    assert not any(overlap(one, other) for one, other in combinations(texts, 2))
    assert not any(overlap(one, ('', *box)) for one in texts for box in boxes)


def test_objects_in_a_heap_have_labels_beside_each_other_with_lines_to_them(texts):
    picture = draw_objects(
        grey_frame(), [located((300 + x, 240, 20, 20)) for x in range(0, 50, 5)])
    assert not any(overlap(one, other) for one, other in combinations(texts, 2))
    # Outside of the labels and the objects, a red line remains.
    picture[240:260, 300:366] = GREY
    assert (picture.astype(int) @ [-1, -1, 2] > 150).any()


@pytest.mark.parametrize('magnification', [0.8, 1, 2, 4])
def test_labels_grow_with_the_picture(texts, magnification):
    draw_objects(grey_frame(), [located((20, 200, 8, 8))])
    draw_objects(grey_frame(int(640 * magnification), int(480 * magnification)),
                 [located((20, 200, 8, 8))])
    (*_, width, height), (*_, larger_width, larger_height) = texts
    assert larger_width / width == pytest.approx(magnification, rel=0.1)
    assert larger_height / height == pytest.approx(magnification, rel=0.2)


def test_of_many_objects_ten_have_labels_and_the_others_are_dots(texts):
    objects = [located((20 + 40 * (number % 12), 60 + 60 * (number // 12), 8, 8))
               for number in range(40)]
    drawn = changed(draw_objects(grey_frame(), objects))
    assert [text.split(':')[0] for text, *_ in texts] == [str(n) for n in range(1, 11)]
    assert all(drawn[one.detection.centre.v, one.detection.centre.u] for one in objects)


def test_label_leaves_the_topmost_line_to_a_note(texts):
    picture = draw_objects(grey_frame(), [located((30, 24, 20, 20))])
    draw_note(picture, 'background taken 3 s ago')
    assert not overlap(*texts)


def test_frame_is_left_as_it_is():
    frame = grey_frame()
    draw_objects(frame, [located((200, 150, 60, 40))])
    assert not changed(frame).any()


def test_frame_without_objects_comes_back_as_a_copy():
    frame = grey_frame()
    picture = draw_objects(frame, [])
    np.testing.assert_array_equal(picture, frame)
    assert not np.shares_memory(picture, frame)


@pytest.mark.parametrize('width, height', [(1, 1), (5, 3), (40, 400), (640, 2)])
def test_picture_may_be_smaller_than_the_text(width, height):
    picture = draw_objects(grey_frame(width, height), [located((0, 0, width, height))])
    assert picture.shape == (height, width, 3)


def test_frame_need_not_be_contiguous():
    frame = grey_frame(1280, 960)[::2, ::-2]
    np.testing.assert_array_equal(
        draw_objects(frame, [located((200, 150, 60, 40))]),
        draw_objects(grey_frame(), [located((200, 150, 60, 40))]))


def test_long_note_is_written_in_lines_that_fit(texts):
    draw_note(grey_frame(), 'the view has moved by 7.2 px: ' + 'move the camera back, ' * 5)
    assert len(texts) > 1 and texts[0][0].startswith('the view has moved')
    assert all(x + width < 640 for _, x, _, width, _ in texts)
    assert all(above[2] + above[4] <= below[2] for above, below in zip(texts, texts[1:]))


def test_note_of_any_length_leaves_the_objects_in_sight(texts):
    draw_note(grey_frame(), 'the camera was nudged by 7.4 px: ' + 'keep the correction, ' * 20)
    assert texts[0][0].startswith('the camera was nudged by 7.4 px')
    assert texts[-1][0].endswith(' ...')
    assert max(y + height for _, _, y, _, height in texts) < 480 / 8


def decoded(content):
    return cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)


def test_written_picture_is_read_back_as_it_was():
    picture = draw_objects(grey_frame(), [located((200, 150, 60, 40))])
    np.testing.assert_array_equal(decoded(encoded_picture('picture.png', picture)), picture)


def test_written_photograph_is_read_back_nearly_as_it_was():
    read = decoded(encoded_picture('picture.JPG', grey_frame()))
    np.testing.assert_allclose(read.astype(int), grey_frame(), rtol=0, atol=3)


def test_picture_in_a_folder_that_does_not_exist_is_refused(tmp_path):
    path = str(tmp_path / 'none' / 'picture.png')
    with pytest.raises(InvalidValueError, match=f'{path}.*there is no folder'):
        encoded_picture(path, grey_frame())


@pytest.mark.parametrize('name, ending', [
    ('a.png', '.png'), ('a.jpg', '.jpg'), ('A.PNG', '.png'), ('b/c.d/a.b.Jpg', '.jpg')])
def test_ending_of_a_pictures_name_tells_its_format(tmp_path, name, ending):
    (tmp_path / 'b' / 'c.d').mkdir(parents=True)
    assert check_picture_path(str(tmp_path / name)) == ending


@pytest.mark.parametrize('name', ['', 'picture', 'picture.bmp', 'picture.png.txt', 'a.png/b'])
def test_picture_with_another_ending_is_refused(name):
    with pytest.raises(InvalidValueError, match='.png or .jpg'):
        check_picture_path(name)
    with pytest.raises(InvalidValueError, match='.png or .jpg'):
        encoded_picture(name, grey_frame())


def bar(angle, yaw):
    """Make a bar of 100 x 20 px about (300, 200), turned by an angle."""
    corners = cv2.boxPoints(((300, 200), (100, 20), np.degrees(angle))).round().astype(np.int32)
    box = Box(*cv2.boundingRect(corners))
    return LocatedObject(
        Detection(box, Pixel(300, 200), 2000.0, corners, False), Point(1.0, 2.0), yaw)


def test_outline_is_drawn_around_the_object():
    found = bar(0.5, None)
    drawn = changed(draw_objects(grey_frame(), [found]))
    assert all(drawn[v, u] for u, v in found.detection.outline)


def test_direction_is_drawn_for_an_object_that_has_one():
    u, v = 300 + round(30 * np.cos(0.5)), 200 + round(30 * np.sin(0.5))
    assert changed(draw_objects(grey_frame(), [bar(0.5, 0.5)]))[v - 1:v + 2, u].any()
    assert not changed(draw_objects(grey_frame(), [bar(0.5, None)]))[v - 1:v + 2, u].any()


def test_base_label_tells_the_position_in_the_base_frame():
    label = base_label(CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0))
    assert label(Point(19.5, 13.75)) == 'base x 1.70, y 10.65 cm'


def test_mask_is_what_lies_within_the_outlines():
    mask = object_mask(grey_frame(), [bar(0.5, None)])
    assert mask.shape == (480, 640) and set(np.unique(mask)) == {0, 255}
    assert np.count_nonzero(mask) == pytest.approx(2000, rel=0.1)


def test_note_stands_in_the_corner(texts):
    draw_note(grey_frame(), 'background taken 3 s ago')
    (text, x, y, _, _), = texts
    assert text == 'background taken 3 s ago' and x < 20 and y < 20
