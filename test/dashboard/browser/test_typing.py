# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a person types is never overwritten, and a press of any length is a click."""

import os
import signal
import time

from dashboard_page import Page, wait_until
import pytest

pytestmark = pytest.mark.slow

TAB = '\ue004'
CHANGE = """
const [node, values] = arguments;
return fetch('/api/parameters?cell=/', {method: 'POST', body: JSON.stringify({node, values})})
  .then((answer) => answer.status);
"""


def change_elsewhere(page, **values):
    """Set parameters of the camera node as another browser does."""
    named = {name.replace('__', '.'): value for name, value in values.items()}
    assert page.run(CHANGE, 'camera', named) == 200


def node_has(page, name, value):
    """Wait until the node has a value: a page that is opened anew shows it."""
    again = page.run("""
        const done = new Promise((resolve) => {
          const line = new WebSocket(`ws://${location.host}/ws/state?cell=/`);
          line.onmessage = ({data}) => {
            const message = JSON.parse(data);
            if (message.part !== 'parameters' || !message.data.camera.length) return;
            line.close();
            resolve(message.data.camera.find((one) => one.name === arguments[0]).value);
          };
        });
        return done""", name)
    return again == value


@pytest.fixture
def detect(page):
    page.go_to('detect')
    page.wait_for('detector.faintest', '#part-detect')
    return page


def begin(page, name, text):
    field = page.field(name)
    page.run('arguments[0].scrollIntoView({block: "center"}); arguments[0].select()', field)
    field.send_keys(text)
    return field


def test_what_is_being_typed_stays_when_another_page_changes_something_else(detect):
    field = begin(detect, 'detector.faintest', '5')
    for number in range(5):
        change_elsewhere(detect, detector__median_size=3 + 2 * (number % 2))
        time.sleep(0.3)
    field.send_keys('0' + TAB)
    wait_until(lambda: node_has(detect, 'detector.faintest', 50.0), lambda: field.get_attribute(
        'value'))
    assert field.get_attribute('value') == '50'
    change_elsewhere(detect, detector__faintest=13.0)


@pytest.mark.parametrize('pause', [0.0, 0.1, 0.25])
def test_the_next_field_can_be_typed_in_at_once(detect, pause):
    first, second = detect.field('detector.faintest'), detect.field('detector.min_area_cm2')
    begin(detect, 'detector.faintest', '17' + TAB)
    detect.run('arguments[0].focus(); arguments[0].select()', second)
    time.sleep(pause)
    for key in '2.5':
        second.send_keys(key)
        time.sleep(0.1)
    second.send_keys(TAB)
    for name, value in (('detector.faintest', 17.0), ('detector.min_area_cm2', 2.5)):
        wait_until(lambda name=name, value=value: node_has(detect, name, value),
                   lambda: first.get_attribute('value') + ' ' + second.get_attribute('value'))
    change_elsewhere(detect, detector__faintest=13.0, detector__min_area_cm2=0.0)


def test_a_change_of_the_same_value_elsewhere_is_told_beside_what_is_typed(detect):
    field = begin(detect, 'detector.faintest', '2')
    change_elsewhere(detect, detector__faintest=19.0)
    detect.wait_for('set to 19 elsewhere', '#part-detect')
    assert field.get_attribute('value') == '2'
    field.send_keys('1' + TAB)
    wait_until(lambda: node_has(detect, 'detector.faintest', 21.0), lambda: '')
    change_elsewhere(detect, detector__faintest=13.0)
    wait_until(lambda: field.get_attribute('value') == '13', lambda: field.get_attribute('value'))
    assert 'elsewhere' not in detect.read('#part-detect')


@pytest.mark.parametrize('press_ms', [60, 150, 250, 600])
def test_a_press_of_any_length_on_the_map_chooses_the_object(page: Page, press_ms):
    from selenium.webdriver.common.action_chains import ActionChains
    page.lay_objects()
    page.run("document.querySelector('.map').scrollIntoView({block: 'center'})")
    for index in range(5):
        chain = ActionChains(page.driver, duration=0)
        chain.click_and_hold(page.elements('.map .object circle')[index])
        chain.pause(press_ms / 1000).release().perform()
        wait_until(lambda index=index: [one.get_attribute('data-key') for one in page.elements(
            '.map .object.chosen')] == [str(index + 1)], lambda: page.read('#part-watch'), 3.0)
    page.click('Moving objects', '#simulated')


def test_chosen_object_is_still_chosen_after_frames_without_it(page, cell):
    page.lay_objects()
    chosen = '#part-watch [aria-pressed=true].number'
    page.click('Object 2: show it in the picture', '#part-watch')
    wait_until(lambda: page.elements(chosen), lambda: 'not chosen')
    os.kill(cell.pid('camera_publisher'), signal.SIGSTOP)
    try:
        page.wait_for('No object.', '#part-watch')
    finally:
        os.kill(cell.pid('camera_publisher'), signal.SIGCONT)
    wait_until(lambda: [one.text for one in page.elements(chosen)] == ['2'],
               lambda: page.read('#part-watch'))
    page.click('Moving objects', '#simulated')


def test_what_stays_in_a_list_is_not_moved_when_something_before_it_goes(page):
    moved = page.run("""
        return import('/web/base/dom.js').then(({sync}) => {
          const parent = document.createElement('div');
          const show = (...keys) => sync(parent, keys, (key) => key,
            () => document.createElement('p'), () => {});
          show('a', 'b', 'c');
          const observer = new MutationObserver(() => {});
          observer.observe(parent, {childList: true});
          show('b', 'c', 'd');
          return observer.takeRecords().flatMap(
            ({addedNodes, removedNodes}) => [...addedNodes, ...removedNodes])
            .map((node) => node.dataset.key);
        })""")
    assert moved == ['a', 'd']


def test_map_stays_where_it_is_when_rows_come_and_go(page):
    tops = page.run("""
        return Promise.all([import('/web/parts/watch.js'), import('/web/base/state.js')]).then(
          ([{createWatch}, {Store}]) => {
            const store = new Store();
            const {node} = createWatch(store);
            document.body.append(node);
            const place = {x: 1, y: 2, yaw_deg: null};
            const tell = (count, left_out) => store.set('watch', {left_out, objects:
              Array.from({length: count}, (_, index) => ({number: index + 1, pixel: null,
                camera: place, base: place, ellipse: null}))});
            const tops = [];
            const look = () => tops.push(node.querySelector('.map').getBoundingClientRect().top);
            tell(1, []);
            look();
            store.set('shapes', [{number: 1, size_cm: [3, 2, 0], picture: {}, map: {}}]);
            tell(1, []);
            look();
            tell(3, []);
            look();
            tell(0, [{reason: 'shade', sentence: 'shade', x: 1, y: 2, pixel: null}]);
            look();
            node.remove();
            return tops;
          })""")
    assert len(tops) == 4 and len(set(tops)) == 1
