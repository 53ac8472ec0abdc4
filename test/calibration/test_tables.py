# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Tables, good and bad."""

from camera_to_base.calibration.tables import read_pairs, read_points, refuse_other_size
from camera_to_base.errors import InvalidValueError
import numpy as np
import pytest

GOOD = 'v_px,u_px,name,x_cm,y_cm\n10,20,a,0,0\n\n11,220,b,30,0.5\n'


@pytest.fixture
def table(tmp_path):
    def write(text, encoding='utf-8'):
        path = tmp_path / 'table.csv'
        path.write_text(text, encoding=encoding)
        return path
    return write


@pytest.mark.parametrize('encoding', ['utf-8', 'utf-8-sig'])
def test_columns_may_come_in_any_order(table, encoding):
    matched, size = read_points(table(GOOD, encoding))
    np.testing.assert_array_equal(matched.points, [[0, 0], [30, 0.5]])
    np.testing.assert_array_equal(matched.pixels, [[20, 10], [220, 11]])
    assert matched.rows == (2, 4) and size is None


def test_semicolons_separate_too(table):
    matched, _ = read_points(table(GOOD.replace(',', ';')))
    assert len(matched) == 2


def test_the_picture_size_is_read_where_it_is_there(table):
    text = 'x_cm,y_cm,u_px,v_px,width_px,height_px\n0,0,1,1,640,480\n1,1,2,2,640,480\n'
    _, size = read_points(table(text))
    assert size == (640, 480)
    with pytest.raises(InvalidValueError, match='of 640 x 480 px, not of 320 x 240 px'):
        refuse_other_size(size, (320, 240))
    with pytest.raises(InvalidValueError, match='row 3: the picture is 320 x 480 px, but 640'):
        read_points(table(text.replace('2,640', '2,320')))


GERMAN = 'x_cm;y_cm;u_px;v_px;Höhe\n0;0;20,5;10,25;ä\n30;0,5;1.220,75;11;\n'


@pytest.mark.parametrize('text, encoding', [
    (GERMAN, 'cp1252'), (GERMAN, 'utf-8'), (GERMAN, 'utf-8-sig'), (GERMAN, 'utf-16'),
    (GERMAN, 'utf-16-le'), (GERMAN, 'utf-16-be'), (GERMAN.replace(';', '\t'), 'utf-16'),
    ('sep=;\n' + GERMAN, 'cp1252'), (GERMAN.replace('\n', '\r\n'), 'cp1252'),
    (GERMAN.replace('1.220', '1\u202f220'), 'utf-8'),
    (GERMAN.replace('1.220', '1\u00a0220'), 'cp1252'),
    (GERMAN.replace('1.220,75', '"1.220,75"'), 'utf-8'), ('\n\n' + GERMAN, 'utf-8'),
    (GERMAN.replace('1.220', '1220').replace(',', '.').replace(';', ','), 'utf-8'),
    (GERMAN.replace('1.220,75', '"1,220.75"').replace(',5', '.5').replace(',25', '.25').replace(
        ';', ','), 'utf-8')])
def test_tables_of_german_french_and_english_spreadsheets_are_read(table, text, encoding):
    matched, _ = read_points(table(text, encoding))
    np.testing.assert_array_equal(matched.points, [[0, 0], [30, 0.5]])
    np.testing.assert_array_equal(matched.pixels, [[20.5, 10.25], [1220.75, 11]])


@pytest.mark.parametrize('old, new, message', [
    ('0,5;', '0.5;', "row 3: y_cm: '0.5' has a point in a table with decimal commas"),
    ('0,5;', '1_0;', "row 3: y_cm: not a number: '1_0'"),
    ('0,5;', '1,2,3;', "row 3: y_cm: not a number: '1,2,3'"),
    ('0,5;', '5 cm;', "row 3: y_cm: not a number: '5 cm'"),
    ('0,5;', '#WERT!;', "row 3: y_cm: not a number: '#WERT!'"),
    (';', ',', 'row 2 has 7 cells, but the header has 5: .* Save the table with semicolons')])
def test_cell_that_can_be_misread_is_refused_by_row_and_column(table, old, new, message):
    with pytest.raises(InvalidValueError, match=message):
        read_points(table(GERMAN.replace(old, new)))


def test_comma_that_groups_or_divides_is_refused(table):
    with pytest.raises(InvalidValueError, match="row 4: u_px: '1,220' can be two numbers"):
        read_points(table(GOOD.replace('220', '"1,220"').replace('0.5', '5')))


def test_workbook_is_refused_with_the_cure(tmp_path):
    path = tmp_path / 'table.xlsx'
    path.write_bytes(b'PK\x03\x04\x14\x00\x06\x00\x08')
    with pytest.raises(InvalidValueError, match="it is a spreadsheet's workbook: save it as CSV"):
        read_points(path)


@pytest.mark.parametrize('text, message', [
    ('', 'is empty: expected a header with x_cm'),
    ('x_cm,y_cm,u_px\n1,2,3\n', 'has no column v_px: its header is x_cm, y_cm, u_px'),
    ('x_cm,y_cm,u_px,v_px,x_cm\n1,2,3,4,5\n', 'has column x_cm twice'),
    ('x_cm,y_cm,u_px,v_px\n', 'has a header but no rows'),
    (GOOD.replace('30', 'thirty'), "row 4: x_cm: not a number: 'thirty'"),
    (GOOD.replace('30', 'nan'), 'row 4: x_cm is nan: expected a finite number'),
    (GOOD.replace('220', '1e300'), 'row 4: u_px is 1e300: expected at most 1e'),
    (GOOD.replace('220', '-inf'), 'row 4: u_px is -inf: expected a finite number'),
    (GOOD.replace('220', ''), 'row 4: u_px is missing'),
    (GOOD.replace('11,220,b,30,0.5', '11'), 'row 4: x_cm is missing'),
    (GOOD + '50,60,c,30,0.5\n', r'rows 4 and 5 have the same position \(x, y\) \(30, 0.5\)'),
    (GOOD + '10,20,c,31,0.5\n', r'rows 2 and 5 have the same pixel \(u, v\) \(20, 10\)'),
])
def test_each_bad_table_gets_its_own_sentence(table, text, message):
    with pytest.raises(InvalidValueError, match=message):
        read_points(table(text))


def test_a_table_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InvalidValueError, match='cannot read the table .*missing.csv'):
        read_points(tmp_path / 'missing.csv')


def test_pairs_may_have_heights(table):
    pairs = read_pairs(table('x_cam_cm,y_cam_cm,x_base_cm,y_base_cm,z_base_cm\n1,2,3,4,5\n'))
    np.testing.assert_array_equal(pairs.camera_points, [[1, 2, 0]])
    np.testing.assert_array_equal(pairs.base_points, [[3, 4, 5]])
