# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The page of a fused cell: two cameras, one map."""

import threading

from dashboard_page import answers, free_port, Page, wait_until
from fake_camera import BOX, DISC, FakeCamera
import pytest
from ros_helpers import stamp_now
from two_cameras import PAIRS

pytestmark = pytest.mark.slow
NAMES = 'left', 'right'


@pytest.fixture
def seen_by(ros):
    """Let both cameras see a box and a disc, all the time; the set is of those that see."""
    cameras = {name: FakeCamera(ros, name, place) for name, place in zip(
        NAMES, PAIRS['tilted 30 degrees, opposite sides'])}
    seeing, has_ended = set(NAMES), threading.Event()

    def show():
        while not has_ended.wait(0.1):
            stamp = stamp_now()
            for name in sorted(seeing):
                cameras[name].show(stamp, BOX, DISC)

    thread = threading.Thread(target=show)
    thread.start()
    yield seeing
    has_ended.set()
    thread.join()


@pytest.fixture
def page(browser, start, seen_by):
    """Open the page of the cell that is fused from both cameras."""
    port = free_port()
    start('camera_fusion')
    start('dashboard', '-p', f'port:={port}')
    url = f'http://127.0.0.1:{port}/'
    wait_until(lambda: answers(url), lambda: 'the dashboard does not answer')
    page = Page(browser, url)
    page.wait_for('2 objects are published', '#banner')
    yield page
    assert not page.errors()


def listed_heights(page):
    """Return the heights in the list, in cm; None while they are not all there."""
    texts = page.run("return [...document.querySelectorAll('#part-watch .numbers tbody tr')]"
                     '.map((row) => row.cells[2].textContent)')
    is_whole = len(texts) == 2 and '–' not in texts
    return [float(text) for text in texts] if is_whole else None


@pytest.mark.parametrize('width, scheme', [(1280, 'light'), (390, 'dark')])
def test_fused_cell_shows_heights_and_a_silent_camera_and_everybody_can_use_it(
        page, seen_by, width, scheme):
    page.resize(width, 844, scheme)
    page.wait_for('Height in cm', '#part-watch')
    heights = wait_until(lambda: listed_heights(page), lambda: page.read('#part-watch'))
    assert heights == [pytest.approx(2.0, abs=0.15), pytest.approx(5.0, abs=0.15)]
    assert [tab.text for tab in page.elements('#tabs button') if tab.is_displayed()] == [
        'Watch', 'Health']
    assert page.serious_problems_by_part() == {}
    seen_by.remove('right')
    page.wait_for('Right publishes no positions', '#banner')
    assert page.serious_problems_by_part() == {}
    assert 'Right publishes no positions' in page.read('#banner')
    page.go_to('watch')
    assert page.run('return document.documentElement.scrollWidth') <= width
