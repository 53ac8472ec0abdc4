# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""A dashboard that runs in the test's executor, and a client of it."""

from camera_to_base.dashboard.dashboard import Dashboard
from dashboard_client import DashboardClient
import pytest


@pytest.fixture
def dashboard(ros):
    """Start dashboards; give a client of each."""
    clients = []

    def start(*arguments):
        node = ros.add(Dashboard, '-p', 'port:=0', *arguments)
        clients.append(DashboardClient(ros, node.address))
        clients[-1].node = node
        return clients[-1]

    yield start
    for client in clients:
        client.close()
