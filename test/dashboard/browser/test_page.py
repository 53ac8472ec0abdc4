# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What can be read and done on the page of a running simulated cell."""

import os
import re

from ament_index_python.packages import get_package_share_directory
from dashboard_page import DOWN, ENTER, RIGHT, wait_until
import pytest

pytestmark = pytest.mark.slow

SOLIDS = os.path.join(
    get_package_share_directory('camera_to_base'), 'config', 'simulated_solid_objects.yaml')
PARTS = ('watch', 'detect', 'calibrate', 'robot', 'prove', 'health', 'save')


def has_picture(page, selector):
    """Tell whether a picture has come."""
    return page.run('return document.querySelector(arguments[0]).naturalWidth', selector) > 0


@pytest.mark.parametrize('width, scheme', [(1280, 'light'), (390, 'dark')])
def test_no_part_has_a_serious_accessibility_problem(page, width, scheme):
    page.resize(width, 844, scheme)
    assert page.serious_problems_by_part() == {}
    assert [one.text for one in page.elements('#tabs button')] == [
        part.capitalize() for part in PARTS]


def test_no_part_is_wider_than_a_small_phone(page):
    page.resize(360, 740)
    for part in PARTS:
        page.go_to(part)
        wide = page.run('return document.documentElement.scrollWidth')
        assert wide <= 360, part


def test_a_long_namespace_does_not_widen_the_page(open_page, start_cell):
    cell = start_cell(namespace='/a_cell_with_a_very_long_name_in_the_hall/' + 10 * 'left_')
    page = open_page(cell)
    page.resize(390, 844)
    for part in PARTS:
        page.go_to(part)
        assert page.run('return document.documentElement.scrollWidth') <= 390, part
        assert page.element('#content').rect['width'] >= 380, part
    cell.close()


def test_long_sentence_leaves_room_on_a_phone_and_can_be_read_on(page):
    page.click('Bump', '#simulated')
    page.wait_for('nudged', '#banner')
    assert not page.button('Read on', '#banner')
    page.resize(390, 844)
    wait_until(lambda: page.button('Read on', '#banner'), lambda: page.read('#banner'))
    short = page.element('#banner').rect['height']
    page.click('Read on', '#banner')
    wait_until(lambda: page.element('#banner').rect['height'] > 1.3 * short,
               lambda: page.element('#banner').rect)
    assert page.serious_problems() == []
    page.click('Less', '#banner')
    wait_until(lambda: page.element('#banner').rect['height'] == short,
               lambda: page.element('#banner').rect)
    page.resize(1280, 900)
    page.click('Put back', '#simulated')


def test_objects_are_in_the_picture_in_the_list_and_on_the_map(page):
    wait_until(lambda: has_picture(page, '#part-watch img'), lambda: 'no picture')
    page.wait_for('Base frame x, y', '#part-watch')
    wait_until(lambda: 'object 1 at' in page.element('.map').get_attribute('aria-label'),
               lambda: page.element('.map').get_attribute('aria-label'))
    cells = page.run("return [...document.querySelector('#part-watch tbody tr').cells]"
                     '.map((cell) => cell.textContent)')
    base, camera = (tuple(float(number.replace('−', '-')) for number in cell.split(', '))
                    for cell in cells[1:3])
    assert base == pytest.approx((camera[0] - 17.8, 24.4 - camera[1]), abs=0.011)


def test_snapshot_is_downloaded_and_a_recording_can_be_played(page):
    page.run('window.saved = []; const make = URL.createObjectURL;'
             'URL.createObjectURL = (content) => {'
             'window.saved.push(content.type); return make(content); };')
    page.click('Snapshot', '#part-watch')
    wait_until(lambda: 'application/zip' in page.run('return saved'),
               lambda: page.read('#notices'))
    page.click('Record', '#part-watch')
    page.wait_for('Stop recording', '#part-watch .capture')
    wait_until(lambda: page.run("return !document.querySelector('.recording').textContent"
                                ".includes(': 0 of')"), lambda: page.read('#part-watch .capture'))
    page.run("document.querySelector('button.recording').click()")
    page.wait_for('-p source:=', '#part-watch .capture')
    os.remove(re.search(r'source:=(\S+)', page.read('#part-watch .capture'))[1])


def test_height_of_the_objects_is_asked_where_the_camera_s_place_is_known(page):
    page.go_to('detect')
    page.wait_for('detector.method', '#part-detect')
    page.go_to('watch')
    assert not page.elements('.heights:not([hidden])')
    page.run("return fetch('/api/parameters', {method: 'POST', body: JSON.stringify({"
             "node: 'camera', values: {'surface.camera_height_cm': 60, "
             "'surface.camera_foot_cm': [18, 13.5]}})})")
    page.wait_for('Objects count as flat', '#part-watch .heights')
    page.fill('Height of the objects in cm', '0.5')
    wait_until(lambda: page.field('object_height_cm').get_attribute('value') == '0.5',
               lambda: page.read('#notices'))
    assert page.serious_problems() == []
    page.run("return fetch('/api/parameters', {method: 'POST', body: JSON.stringify({"
             "node: 'camera', values: {'object_height_cm': 0, 'surface.camera_height_cm': 0, "
             "'surface.camera_foot_cm': []}})})")
    wait_until(lambda: not page.elements('.heights:not([hidden])'), lambda: page.read())


def test_solid_objects_are_noticed_and_drawn_with_what_they_stand_on(open_page, start_cell):
    cell = start_cell('-p', 'source:=simulated', '-p', 'object_height_cm:=0.0',
                      namespace='/solid', params_file=SOLIDS)
    page = open_page(cell)
    page.wait_for('Objects look solid', '#part-watch .heights')
    page.wait_for('5 of 5 objects look solid', '#banner')
    page.click('They are flat', '#part-watch .heights')
    page.wait_for('5 objects are published', '#banner')
    assert page.field('object_height_cm').get_attribute('value') == '0.1'
    page.fill('Height of the objects in cm', '3')
    for paths in ('.picture .shapes path.top', '.map path.footprint'):
        wait_until(lambda paths=paths: len(page.elements(f'#part-watch {paths}')) == 5,
                   lambda: page.read('#part-watch'))
    page.wait_for('× 3.0', '#part-watch tbody')
    wait_until(lambda: not page.elements('.heights.question'), lambda: page.read('.heights'))
    page.click('Shapes', '#part-watch')
    assert not page.elements('#part-watch .picture .shapes path')
    page.click('Shapes', '#part-watch')
    cell.close()


def test_click_on_an_object_marks_it_in_the_picture(page):
    def is_marked():
        page.run("document.querySelector('#part-watch tbody button')?.click()")
        return page.run("return Boolean(document.querySelector('#part-watch .picture .chosen'))")

    assert wait_until(is_marked, lambda: 'not marked')


def test_scatter_of_the_chosen_object_is_measured_and_saved_as_csv(page):
    page.lay_objects()
    page.run('window.saved = []; const make = URL.createObjectURL;'
             'URL.createObjectURL = (content) => {'
             'window.saved.push(content); return make(content); };')
    page.click('Object 2: show it in the picture', '#part-watch')
    wait_until(lambda: int(re.search(r'(\d+) frames|$', page.read('.scatter'))[1] or 0) >= 8,
               lambda: page.read('#part-watch'))
    assert len(page.elements('.scatter .chart canvas')) == 3
    said = page.read('#part-watch')
    count, x = re.search(r'(\d+) frames in .* x (−?[\d.]+) cm ±', said).groups()
    page.click('Download as CSV', '#part-watch')
    head, *rows = page.run("return saved.find((one) => one.type === 'text/csv').text()").split()
    assert head == 'stamp_s,frame,x_cm,y_cm,yaw_deg' and len(rows) >= int(count)
    assert float(rows[-1].split(',')[2]) == pytest.approx(float(x.replace('−', '-')), abs=0.1)
    stamps = [float(row.split(',')[0]) for row in rows]
    assert stamps == sorted(set(stamps))
    page.click('Moving objects', '#simulated')


# Whether the line of a chart has a colour.
HAS_LINE = """const canvas = document.querySelector('#part-health .chart canvas');
const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
const isWanted = (at) => arguments[0].every((one, index) => Math.abs(data[at + index] - one) < 9);
for (let at = 0; at < data.length; at += 4) if (data[at + 3] > 200 && isWanted(at)) return true;
return false"""


def test_charts_are_drawn_in_place_in_the_colours_of_light_and_dark(page):
    page.go_to('health')
    wait_until(lambda: page.elements('#part-health .chart canvas'), lambda: 'no chart')
    drawn = page.run("window.canvas = document.querySelector('#part-health .chart canvas');"
                     'return canvas.toDataURL()')
    wait_until(lambda: page.run('return canvas.isConnected && canvas.toDataURL()') != drawn,
               lambda: 'it is not drawn anew')
    assert page.run('return canvas.isConnected')
    wait_until(lambda: page.run(HAS_LINE, [11, 105, 133]), lambda: 'no line in light')
    page.resize(390, 844, 'dark')
    wait_until(lambda: page.run(HAS_LINE, [98, 197, 223]), lambda: 'no line in dark')
    wait_until(lambda: page.element('#part-health .chart .uplot').rect['width'] <= 366,
               lambda: page.element('#part-health .chart .uplot').rect)
    page.click('10 min', '#part-health')
    assert 'Hz in the last 10 minutes' in page.read('#part-health .chart-box')


def test_new_place_is_proved_by_touching_it(page):
    page.lay_objects()
    page.go_to('prove')
    assert page.element('.setup [aria-current=step]').text == 'Prove'
    wait_until(lambda: page.button('Object 5', '#part-prove'), lambda: page.read())
    page.click('Object 2', '#part-prove')
    wait_until(lambda: page.button('Compare', '#part-prove'), lambda: page.read('#part-prove'))
    page.click('Object 2', '#simulated')
    display = wait_until(
        lambda: re.fullmatch(r'x (\S+)\s+y (\S+) cm', page.read('#simulated .display')),
        lambda: page.read('#simulated'))
    page.fill('True x and y in the base frame', ' '.join(display.groups()))
    page.wait_for('of 1 within the 95 % ellipse', '#part-prove .verdict')
    error = page.run("return document.querySelector('#part-prove tbody').rows[0]"
                     '.cells[3].textContent')
    assert float(error.split()[0]) < 1.0
    assert page.serious_problems() == []
    page.click('Remove place 1', '#part-prove')
    page.click('Undo: place 1 removed', '#part-prove')
    wait_until(lambda: page.button('Remove place 1', '#part-prove'), lambda: page.read())
    page.click('Moving objects', '#simulated')


def test_grid_of_a_frame_lies_on_the_picture_which_fills_the_screen(page):
    layer = '#part-watch .frame-grid'
    for name in ('Camera frame', 'Base frame'):
        page.click(name, '#part-watch')
        wait_until(lambda: len(page.elements(f'{layer} path')) > 6, lambda: 'no grid')
        assert page.element(f'{layer} .frame-name').text == f'{name}, cm'
    page.click('No grid', '#part-watch')
    assert not page.elements(f'{layer} path')
    page.click('Full screen', '#part-watch')
    wait_until(lambda: page.run('return Boolean(document.fullscreenElement)'), lambda: 'small')
    box = page.element('#part-watch .picture img').rect
    assert box['width'] >= page.run('return innerWidth') - 1
    page.click('Full screen', '#part-watch')
    wait_until(lambda: page.run('return !document.fullscreenElement'), lambda: 'large')
    page.click('Camera frame', '#part-watch')
    # What a parameter means is read while it is changed, or with the pointer on its name.
    page.go_to('detect')
    about = page.element('#p-camera-detector-faintest-about')
    assert not about.is_displayed()
    page.run('arguments[0].focus()', page.field('detector.faintest'))
    wait_until(about.is_displayed, lambda: 'no sentence')


def test_mask_lies_over_a_large_picture_as_strong_as_the_slider_says(page):
    page.resize(1280, 800)
    page.go_to('detect')
    for selector in ('#part-detect .picture > img', '#part-detect .picture.over > img'):
        wait_until(lambda selector=selector: has_picture(page, selector), lambda: f'no {selector}')
    boxes = [page.element(f'#part-detect {one}').rect for one in ('.picture', '.picture.over')]
    assert boxes[0] == boxes[1] and boxes[0]['width'] >= 640
    page.run("const one = document.querySelector('#mask-strength'); one.value = 75;"
             "one.dispatchEvent(new Event('input'))")
    assert page.element('#part-detect .picture.over').value_of_css_property('opacity') == '0.75'


def test_parameter_takes_effect_and_goes_back_to_its_default(page):
    page.go_to('detect')
    page.wait_for('detector.faintest', '#part-detect')
    page.fill('detector.faintest', '31')
    page.click('Faintest object: back to the default')
    wait_until(lambda: page.field('detector.faintest').get_attribute('value') == '13',
               lambda: page.field('detector.faintest').get_attribute('value'))


def test_refused_parameter_shows_why_and_the_old_value(page):
    page.go_to('detect')
    page.wait_for('detector.median_size', '#part-detect')
    page.fill('detector.median_size', '4')
    name = 'p-camera-detector-median_size'
    page.wait_for('step', f'#{name}-error')
    assert page.field('detector.median_size').get_attribute('value') == '5'
    assert page.field('detector.median_size').get_attribute('aria-invalid') == 'true'


def test_second_page_sees_what_the_first_has_changed(page, open_page, cell, browser):
    first = browser.current_window_handle
    browser.switch_to.new_window('tab')
    second = browser.current_window_handle
    try:
        other = open_page(cell)
        other.go_to('detect')
        browser.switch_to.window(first)
        page.go_to('detect')
        page.wait_for('detector.threshold', '#part-detect')
        page.fill('detector.threshold', '77')
        browser.switch_to.window(second)
        wait_until(lambda: other.field('detector.threshold').get_attribute('value') == '77',
                   lambda: other.field('detector.threshold').get_attribute('value'))
    finally:
        browser.switch_to.window(second)
        browser.close()
        browser.switch_to.window(first)


def test_background_is_taken_anew(page):
    # What lies there now would be missed later: it would have been taken away.
    page.click('Nothing', '#simulated')
    page.wait_for('The surface is empty', '#banner')
    page.go_to('detect')
    page.click('Take the background now')
    page.wait_for('The background is new', '#notices')
    page.click('Moving objects', '#simulated')


def test_tabs_follow_the_arrow_keys(page):
    page.element('#tab-watch').send_keys(RIGHT)
    assert page.run('return document.activeElement.id') == 'tab-detect'
    wait_until(page.element('#part-detect').is_displayed, lambda: page.read())
    assert not page.element('#part-watch').is_displayed()


def test_tools_for_drawing_are_in_sight_with_the_picture(page):
    page.resize(1280, 800)
    page.go_to('detect')
    page.click('Draw an area to ignore')
    for selector in ('.picture[role=application]', '.pen .primary'):
        box = page.run('return document.querySelector(arguments[0]).getBoundingClientRect()'
                       '.toJSON()', f'#part-detect {selector}')
        assert 0 <= box['top'] and box['bottom'] <= 800, selector
    # Nothing lies over it, such as the panel of the simulated table.
    assert page.run("const one = document.querySelector('#part-detect .pen .primary');"
                    'const box = one.getBoundingClientRect();'
                    'return document.elementFromPoint(box.left + 5, box.top + 5) === one')
    page.click('Cancel', '#part-detect')


def test_fields_that_are_read_at_the_start_only_are_folded_away(page):
    page.go_to('detect')
    page.wait_for('detector.method', '#part-detect')
    method = page.run("return document.querySelector('#p-camera-detector-method')"
                      ".closest('.field').className")
    assert 'idle' not in method
    seen = page.run("return [...document.querySelectorAll('#part-detect .field')]"
                    ".filter((one) => one.checkVisibility() && one.querySelector(':disabled'))"
                    '.length')
    assert seen == 0


def change_by_pointer(page):
    """Drag a corner, make a new one and take it away: the others stay to the last digit."""
    from selenium.webdriver import ActionChains

    def ignored():
        return page.field('ignored_areas').get_attribute('value').split(', ')

    def drag(selector, right, down):
        ActionChains(page.driver).click_and_hold(page.element(selector)).move_by_offset(
            right // 2, down // 2).move_by_offset(right // 2, down // 2).release().perform()

    before = wait_until(lambda: len(ignored()) == 3 and ignored(), ignored)
    page.click('Change ignored area 1')
    drag('#part-detect circle.corner', 0, -30)
    drag('#part-detect circle.middle', -40, -10)
    assert len(page.elements('#part-detect circle.corner')) == 4
    page.click('Delete this corner', '#part-detect')
    page.click('Undo', '#part-detect .pen')
    page.click('Delete this corner', '#part-detect')
    page.click('Finish', '#part-detect')
    after = wait_until(lambda: ignored() != before and ignored(), ignored)
    assert after[1:] == before[1:] and after[0] != before[0]
    page.click('Undo: ignored area 1 changed', '#part-detect')
    wait_until(lambda: ignored() == before, ignored)


def test_area_to_ignore_is_drawn_by_the_keyboard_and_removed(page):
    page.go_to('detect')
    page.click('Draw an area to ignore')
    picture = page.element('#part-detect .picture[role=application]')
    for moves in (RIGHT * 3, DOWN * 3, RIGHT * 3):
        picture.send_keys(moves + ENTER)
    page.click('Finish')
    page.wait_for('ignored area 1, 3 corners', '#part-detect')
    change_by_pointer(page)
    page.click('Remove ignored area 1')
    wait_until(lambda: '3 corners' not in page.read('#part-detect'),
               lambda: page.read('#part-detect'))
    page.click('Undo: ignored area 1 removed', '#part-detect')
    page.wait_for('ignored area 1, 3 corners', '#part-detect')
    page.click('Remove ignored area 1')
    wait_until(lambda: '3 corners' not in page.read('#part-detect'),
               lambda: page.read('#part-detect'))


def test_health_tells_of_both_nodes_in_words(page):
    page.go_to('health')
    page.wait_for('Objects on the surface are published', '#part-health')
    page.wait_for('Positions are transformed', '#part-health')
    page.wait_for('/camera_publisher', '#part-health .log')
    assert 'Hz in the last minute' in page.read('#part-health')


def test_picture_is_only_asked_for_where_it_is_shown(page):
    wait_until(lambda: has_picture(page, '#part-watch img'), lambda: 'no picture')
    page.go_to('save')
    source = page.run("return document.querySelector('#part-watch img').src")
    page.run('return new Promise((done) => setTimeout(done, 500))')
    assert page.run("return document.querySelector('#part-watch img').src") == source
