# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A browser for a module of tests, and cells with a dashboard."""

from dashboard_page import Cell, missing, Page, start_browser
import pytest


@pytest.fixture(scope='module')
def browser():
    """Give a browser, or skip where there is none."""
    if missing():
        pytest.skip(missing())
    driver = start_browser()
    yield driver
    driver.quit()


@pytest.fixture(scope='module')
def start_cell(browser):
    """Start cells, and leave no process behind."""
    cells = []

    def start(*camera, **options):
        cells.append(Cell(*camera, **options))
        return cells[-1]

    yield start
    for cell in cells:
        cell.close()


@pytest.fixture
def open_page(browser):
    """Open pages; each must be without errors on the browser's console at the end."""
    pages = []

    def open_one(cell):
        pages.append(Page(browser, cell.url))
        return pages[-1]

    yield open_one
    assert not [error for page in pages for error in page.errors()]


@pytest.fixture(scope='module')
def cell(start_cell):
    """Start a simulated cell."""
    return start_cell()


@pytest.fixture
def page(open_page, cell):
    """Open the cell's page, and wait until it tells that positions are published."""
    page = open_page(cell)
    page.wait_for('published', '#banner')
    return page
