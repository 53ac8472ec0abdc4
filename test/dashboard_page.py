# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A cell of processes with its dashboard, and the dashboard's page in a real browser."""

import importlib.util
import os
import shutil
import signal
import socket
import time
from urllib.error import URLError
from urllib.request import urlopen

from pytest import approx
from ros_helpers import NotInTime, Process, SIMULATED_CELL

DRIVERS = ('/usr/bin/chromedriver', 'chromedriver')
BROWSERS = ('/usr/bin/chromium', 'chromium', 'chromium-browser', 'google-chrome')
# The machine may be busy with other tests.
PATIENCE_S = 60.0
ENTER, RIGHT, DOWN = '\ue007', '\ue014', '\ue015'
# The coordinates in the list, in the camera frame in cm: of the simulated objects that rest, with
# the simulated camera's own calibration.
LISTED = """return [...document.querySelectorAll('#part-watch .numbers tbody tr')].flatMap(
    (row) => row.cells[2].textContent.split(', ').map(Number))"""
AT_REST = [18.0, 13.5, 10.44, 8.91, 25.56, 18.09, 25.56, 8.91, 10.44, 18.09]
# Brings a button into sight, and notes in `wasHit` whether the click that follows reaches it.
AIM = """const [button] = arguments;
    window.wasHit = false;
    button.addEventListener('click', () => { window.wasHit = true; }, {once: true, capture: true});
    button.scrollIntoView({block: 'center'});"""
# The browser itself says so about a server that a test has ended.
EXPECTED_ERRORS = (
    'WebSocket connection to', 'net::ERR_CONNECTION_REFUSED', 'the server responded with a status')


def missing():
    """Say what the tests in a browser lack; '' for nothing."""
    if importlib.util.find_spec('selenium') is None:
        return 'selenium is not installed: pip install selenium'
    if importlib.util.find_spec('axe_core_python') is None:
        return 'axe-core is not installed: pip install axe-core-python'
    if not (_found(BROWSERS) and _found(DRIVERS)):
        return 'no Chromium with its driver is installed: scripts/browser installs it'
    return ''


def _found(names):
    return next(filter(None, map(shutil.which, names)), None)


def wait_until(condition, what, patience=PATIENCE_S):
    """Wait until a condition is true, and return what it gives, or raise NotInTime."""
    until = time.monotonic() + patience
    while True:
        result = condition()
        if result:
            return result
        if time.monotonic() > until:
            raise NotInTime(f'waited {patience:.0f} s: {what()}')
        time.sleep(0.1)


def free_port():
    """Return a TCP port that nothing listens on."""
    with socket.socket() as one:
        one.bind(('127.0.0.1', 0))
        return one.getsockname()[1]


def answers(url):
    """Tell whether a server answers."""
    try:
        with urlopen(url, timeout=2):
            return True
    except (URLError, OSError):
        return False


class Cell:
    """
    Both nodes and the dashboard as processes.

    :param camera: ROS arguments of the camera node; the simulated camera if there are none.
    :param params_file: The file that all three are started with, and that the page saves to; ''
        for none.
    :param namespace: Of all three; tests whose cells run at the same time need different ones.
    """

    def __init__(self, *camera, params_file='', namespace='/'):
        self.port = free_port()
        self._namespace = namespace
        self._camera = camera or ('-p', 'source:=simulated')
        # Without a file, the simulated camera has its own calibration.
        own = ('--params-file', params_file) if params_file else ()
        self._file = own or (() if camera else SIMULATED_CELL)
        self._save = ('-p', f'params_file:={params_file}') if params_file else ()
        self.processes = {}
        for name in ('robot_base_publisher', 'camera_publisher', 'dashboard'):
            self.start(name)
        wait_until(lambda: answers(self.url), lambda: 'the dashboard does not answer')

    @property
    def url(self):
        """Address of the page."""
        return f'http://127.0.0.1:{self.port}/?cell={self._namespace}'

    def start(self, name):
        """Start one of the processes."""
        arguments = {
            'camera_publisher': (*self._file, *self._camera),
            'robot_base_publisher': self._file,
            'dashboard': ('-p', f'port:={self.port}', *self._save)}[name]
        self.processes[name] = Process(name, '-r', f'__ns:={self._namespace}', *arguments)

    def kill(self, name):
        """Kill one of the processes, without a chance to say good-bye."""
        self.processes.pop(name).kill()

    def pid(self, name):
        """Return a process's number."""
        return self.processes[name].number

    def close(self):
        """End all processes."""
        for process in self.processes.values():
            if process.is_running:
                process.end(signal.SIGTERM, 15.0)
        self.processes = {}


def start_browser():
    """Start Chromium without a window."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    options = webdriver.ChromeOptions()
    options.binary_location = _found(BROWSERS)
    for argument in ('--headless=new', '--no-sandbox', '--disable-dev-shm-usage', '--disable-gpu',
                     '--hide-scrollbars'):
        options.add_argument(argument)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    driver = webdriver.Chrome(options=options, service=Service(_found(DRIVERS)))
    driver.set_script_timeout(120)  # axe-core, on a busy computer
    return driver


class Page:
    """
    The dashboard's page, used as a person does: by what can be read on it.

    `clicks` and `typed` count what the person did.
    """

    def __init__(self, driver, url):
        self.driver = driver
        self.url = url
        self.clicks, self.typed = 0, []
        self.resize(1280, 900)
        driver.get('about:blank')
        driver.get(url)
        wait_until(lambda: 'Connected' in self.read('header'), lambda: self.read('body'))

    def resize(self, width, height, scheme='light'):
        """Show the page at a size, in light or dark."""
        self.driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
            'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': width < 500})
        self.driver.execute_cdp_cmd('Emulation.setEmulatedMedia', {
            'features': [{'name': 'prefers-color-scheme', 'value': scheme}]})

    def go_to(self, part):
        """Open a part by its tab."""
        self.element(f'#tab-{part}').click()
        self.clicks += 1

    def element(self, selector):
        """Return the first element of a CSS selector."""
        return self.driver.find_element('css selector', selector)

    def elements(self, selector):
        """Return all elements of a CSS selector."""
        return self.driver.find_elements('css selector', selector)

    def read(self, selector='main'):
        """Return the text that can be seen in an element."""
        return self.element(selector).text

    def run(self, script, *arguments):
        """Return what a function's body in JavaScript returns."""
        return self.driver.execute_script(script, *arguments)

    def wait_for(self, text, selector='body', patience=PATIENCE_S):
        """Wait until a text can be read."""
        wait_until(lambda: text in self.read(selector),
                   lambda: f"'{text}' is not in: {self.read(selector)}\n"
                           f"the page's notices: {self.read('#notices')}", patience)

    def button(self, name, within='body'):
        """Return the visible button with a text or a label."""
        path = (f".//*[self::button or self::summary or self::a][normalize-space()='{name}' or "
                f"@aria-label='{name}']")
        found = [one for one in self.element(within).find_elements('xpath', path)
                 if one.is_displayed()]
        return found[0] if found else None

    def click(self, name, within='body'):
        """Click a button once it can be clicked."""
        wait_until(lambda: self._try_click(name, within),
                   lambda: f"no button '{name}' to click in: {self.read(within)}")
        self.clicks += 1

    def _try_click(self, name, within):
        from selenium.common.exceptions import WebDriverException
        one = self.button(name, within)
        if one is None or not one.is_enabled():
            return False
        try:
            self.run(AIM, one)
            one.click()
        except WebDriverException:  # it has moved, or was made anew
            return False
        # The banner above may grow just before the click, which misses the button then; a person
        # sees that. Where there is no such variable, a link has led to another page.
        return self.run('return window.wasHit') is not False

    def lay_objects(self):
        """Let the simulated objects rest, and wait until the page shows them where they rest."""
        self.click('Objects at rest', '#simulated')
        wait_until(lambda: self.run(LISTED) == approx(AT_REST, abs=0.05),
                   lambda: self.read('#part-watch'))

    def keep_placement(self, count=1):
        """Keep the board's placement; again where the page still shows it in its last place."""
        def is_kept():
            return len(self.elements('.placements li')) == count

        def is_answered():
            return is_kept() or self.elements('#part-calibrate .hint.error')

        clicks = self.clicks
        while not is_kept():
            # A person lays the board slower than that; on a busy machine the page may still show
            # the last place, where this test, but no person, would click once more.
            time.sleep(1)
            self.click('Keep this placement', '#part-calibrate')
            wait_until(is_answered, lambda: self.read('#part-calibrate'))
        self.clicks = clicks + 1

    def fill(self, label, text, end=ENTER):
        """Type a text into the field with a label, and press Enter."""
        node = self.field(label)
        self.run('arguments[0].scrollIntoView({block: "center"}); arguments[0].select()', node)
        node.send_keys(text + end)
        self.typed.append(text)

    def field(self, label):
        """Return the input with a label, or of a parameter."""
        name = self.driver.find_element('xpath', f'//label[normalize-space()="{label}" or '
                                                 f'following-sibling::code[.="{label}"]]')
        return self.element(f"[id='{name.get_attribute('for')}']")

    def serious_problems(self):
        """Return what axe-core says of the page: serious and critical violations."""
        if not self.run('return Boolean(window.axe)'):
            import axe_core_python
            path = os.path.join(os.path.dirname(axe_core_python.__file__), 'axe.min.js')
            with open(path, encoding='utf-8') as file:
                self.run(file.read())
        found = self.driver.execute_async_script(
            'const done = arguments[0];'
            "axe.run({resultTypes: ['violations']}).then((result) => done(result.violations))")
        return [(one['id'], [node['html'] for node in one['nodes']][:3]) for one in found
                if one['impact'] in ('serious', 'critical')]

    def serious_problems_by_part(self):
        """Open each part, and return what axe-core says of those with serious problems."""
        parts = [tab.get_attribute('id').removeprefix('tab-')
                 for tab in self.elements('#tabs button') if tab.is_displayed()]
        assert 'watch' in parts and 'health' in parts
        found = {}
        for part in parts:
            self.go_to(part)
            found[part] = self.serious_problems()
        return {part: problems for part, problems in found.items() if problems}

    def errors(self):
        """Return the errors on the browser's console since the last call."""
        return [entry['message'] for entry in self.driver.get_log('browser')
                if entry['level'] == 'SEVERE'
                and not any(expected in entry['message'] for expected in EXPECTED_ERRORS)]
