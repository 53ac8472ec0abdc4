# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The SROS2 policies allow what the nodes do, and nothing that they don't."""

import os
import re
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.help import NODE_HELP
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import pytest
from rclpy.expand_topic_name import expand_topic_name
from visualization_msgs.msg import MarkerArray

POLICY = os.path.join(get_package_share_directory('camera_to_base'),
                      'config', 'sros2', 'camera_to_base.policy.xml')
# With which arguments a node has all that it may ever have.
STARTS = {
    'camera_publisher': (CameraPublisher, ['random', 'simulated', 'topic', 'compressed_topic']),
    'robot_base_publisher': (RobotBasePublisher, [None])}

each_node = pytest.mark.parametrize('name', STARTS)


def profile_of(name):
    enclave = ElementTree.parse(POLICY).find(f".//enclave[@path='/camera_to_base/{name}']")
    profile, = enclave.findall('profiles/profile')
    assert profile.get('node') == name
    return profile


def allowed(name):
    """Give what the policy allows, as pairs of a verb and a full name."""
    profile = profile_of(name)
    return {(verb, expand_topic_name(item.text, name, profile.get('ns')))
            for rules in profile for verb in rules.attrib for item in rules}


def done_by(node, ros):
    """Give what a node does, as the graph knows it."""
    def names(kind):
        find = getattr(ros.node, f'get_{kind}_names_and_types_by_node')
        return [name for name, _ in find(node.get_name(), node.get_namespace())]

    verbs = {'publisher': 'publish', 'subscriber': 'subscribe', 'service': 'reply',
             'client': 'request'}
    assert ros.spin_until(lambda: '/diagnostics' in names('publisher'))
    return {(verb, name) for kind, verb in verbs.items() for name in names(kind)}


def done_at_any_start(name, ros):
    node_class, sources = STARTS[name]
    done = set()
    # Ellipses, boxes and silhouettes are converted while somebody looks at them.
    ros.listen_to(MarkerArray, '/objects_in_robot_base_frame/ellipses')
    ros.listen_to(MarkerArray, '/objects_in_robot_base_frame/boxes')
    ros.listen_to(MarkerArray, '/objects_in_robot_base_frame/silhouettes')
    for source in sources:
        arguments = ['--ros-args', '-p', f'source:={source}'] if source else None
        node = node_class(context=ros.context, cli_args=arguments)
        try:
            done |= done_by(node, ros)
            if name == 'robot_base_publisher':
                ros.executor.add_node(node)
                ros.spin_for(2.5)
                done |= done_by(node, ros)
        finally:
            node.destroy_node()  # a second node of the same name would be hidden by the first
    return done


@pytest.mark.slow
@each_node
def test_policy_allows_all_that_the_node_does(ros, name):
    assert done_at_any_start(name, ros) - allowed(name) == set()


@pytest.mark.slow
@each_node
def test_policy_allows_nothing_that_the_node_never_does(ros, name):
    assert allowed(name) - done_at_any_start(name, ros) == set()


@each_node
def test_node_calls_no_service(name):
    assert not {verb for verb, _ in allowed(name)} - {'publish', 'subscribe', 'reply'}
    assert {value for rules in profile_of(name) for value in rules.attrib.values()} == {'ALLOW'}


@each_node
def test_topics_in_the_help_text_are_those_of_the_policy(name):
    verbs = {'publishes': 'publish', 'subscribes to': 'subscribe'}
    told = {(verbs[heading], '/' + topic.lstrip('/'))
            for heading, block in re.findall(
                r'^(publishes|subscribes to).*:\n((?: .*\n)+)', NODE_HELP[name], re.MULTILINE)
            for topics in re.findall(r'^  (\S.*?)  ', block, re.MULTILINE)
            for topic in topics.split(', ')}
    of_every_node = {('publish', '/rosout'), ('publish', '/parameter_events')}
    assert told == {(verb, topic) for verb, topic in allowed(name) - of_every_node
                    if verb != 'reply'}


def test_sros2_accepts_the_policy():
    policy = pytest.importorskip('sros2.policy')
    assert policy.load_policy(policy.pathlib.Path(POLICY)) is not None
