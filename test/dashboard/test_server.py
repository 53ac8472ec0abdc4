# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""What a page sees of the cells, and what it changes."""

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import cv2
import numpy as np
import pytest
from rclpy.parameter import Parameter
from ros_helpers import SIMULATED_CELL

SIMULATED = ('-p', 'source:=simulated')


@pytest.fixture
def cell(ros):
    """Start both nodes of a cell in the test's executor."""
    return (ros.add(CameraPublisher, *SIMULATED), ros.add(RobotBasePublisher))


def comes(ros, page, part, condition, timeout=30.0):
    """Wait until a part of the state fulfils a condition; return it."""
    ros.spin_until(lambda: part in page.parts and condition(page.parts[part]), timeout)
    return page.parts[part]


def values_of(page, node='camera'):
    return {one['name']: one['value'] for one in page.parts['parameters'][node]}


def test_objects_are_shown_in_both_frames_with_pixel_and_ellipse(ros, dashboard, cell):
    page = dashboard()
    page.look()
    truth = ros.listen('/true_pos_in_cam_frame')
    watch = comes(ros, page, 'watch', lambda watch: watch['objects'] and all(
        one['base'] and one['ellipse'] and one['pixel'] for one in watch['objects'])
        and 5 < watch['rate_hz'] < 15)
    one = watch['objects'][0]
    assert one['number'] == 1 and watch['state']['reason'] == 'not_calibrated'
    camera = np.array([one['camera']['x'], one['camera']['y']])
    assert np.linalg.norm(np.array(truth) - camera, axis=1).min() < 0.1
    # The tutorial's transform, and its 36 cm across 640 px.
    assert np.allclose([one['base']['x'], one['base']['y']],
                       [camera[0] - 17.8, 24.4 - camera[1]], atol=1e-3)
    assert np.allclose(one['pixel'], camera / 0.05625, atol=0.1)
    assert 0 < one['ellipse']['minor_mm'] <= one['ellipse']['major_mm']
    assert watch['age_s'] < 2 and watch['latency_ms'] > 0
    assert watch['image'] == {'width': 640, 'height': 480}
    assert [-17.8, 24.4] in watch['map']['view']


@pytest.mark.slow
def test_the_error_of_a_base_position_is_that_of_the_base_frame_in_each_update(
        ros, dashboard, cell):
    page = dashboard()
    page.look()

    def updates():
        return [message['data']['objects'] for message in page.messages
                if message['part'] == 'watch' and message['data']['objects']]

    comes(ros, page, 'watch', lambda watch: watch['objects'] and all(
        one['base'] and one['ellipse'] for one in watch['objects']))
    began = len(updates())
    ros.spin_until(lambda: len(updates()) > began + 80)
    shown = [one['ellipse'] and one['ellipse']['frame']
             for objects in updates()[began:] for one in objects if one['base']]
    assert shown.count('camera') == 0 and shown.count(None) <= 0.02 * len(shown)


def test_what_is_left_out_is_shown_with_its_reason(ros, dashboard, cell):
    page = dashboard()
    page.look()
    cell[0].set_parameters([Parameter('detector.min_area_cm2', value=50.0)])
    watch = comes(ros, page, 'watch', lambda watch: watch['left_out'])
    left_out = watch['left_out'][0]
    assert left_out['reason'] == 'too_small'
    assert 'detector.min_area_cm2' in left_out['sentence']
    assert watch['objects'] == [] and watch['state']['level'] != 'error'
    assert 'empty' not in watch['state']['sentence']


def test_two_pages_see_what_one_of_them_changes(ros, dashboard, cell):
    first = dashboard()
    first.look()
    comes(ros, first, 'parameters', lambda parts: parts['camera'] and parts['transform'])
    second = type(first)(ros, first.origin)
    second.look()
    comes(ros, second, 'parameters', lambda parts: parts['camera'])
    status, answer = first.post('/api/parameters?cell=/', {
        'node': 'camera', 'values': {'detector.threshold': 70, 'detector.min_area_cm2': 1}})
    assert (status, answer['values']['detector.min_area_cm2']) == (200, 1.0)
    for page in (first, second):
        comes(ros, page, 'parameters', lambda _, page=page: values_of(page)[
            'detector.threshold'] == 70)
    assert cell[0].get_parameter('detector.threshold').value == 70
    second.close()


@pytest.mark.parametrize('name, value, part_of_sentence', [
    ('detector.threshold', 900, 'out of range'),
    ('detector.threshold', 'much', 'cannot be'),
    ('detector.no_such_thing', 1, 'has no parameter'),
    ('surface.model', 'round', 'one of'),
    ('surface.hull', [1, 2], 'at least three pixels')])
def test_a_refused_parameter_has_its_sentence_and_changes_nothing(
        ros, dashboard, cell, name, value, part_of_sentence):
    page = dashboard()
    page.look()
    comes(ros, page, 'parameters', lambda parts: parts['camera'])
    before = values_of(page)
    status, answer = page.post('/api/parameters?cell=/', {
        'node': 'camera', 'values': {name: value, 'detector.min_area_cm2': 3.0}})
    assert status == 400
    assert part_of_sentence in answer['errors'][name] and answer['error']
    assert cell[0].get_parameter('detector.min_area_cm2').value == 0.05
    ros.spin_for(0.3)
    assert values_of(page) == before


def test_a_parameter_is_described_as_its_node_describes_it(ros, dashboard, cell):
    page = dashboard()
    page.look()
    parts = comes(ros, page, 'parameters', lambda parts: parts['camera'] and parts['transform'])
    threshold, = (one for one in parts['camera'] if one['name'] == 'detector.threshold')
    assert threshold['type'] == 'integer' and threshold['range'] == [0, 255, 0]
    assert threshold['group'] == 'detector' and threshold['default'] == threshold['value'] == 95
    assert threshold['description'].endswith('.') and not threshold['read_only']
    by_name = {one['name']: one for one in parts['camera']}
    assert by_name['source']['read_only'] and by_name['source']['value'] == 'simulated'
    assert by_name['detector.method']['choices'] == ['tutorial', 'precise']
    reach, = (one for one in parts['transform'] if one['name'] == 'reach_cm')
    assert reach['unit'] == 'cm' and reach['type'] == 'double'


def test_the_background_is_taken_anew(ros, dashboard, cell):
    page = dashboard()
    page.look()
    comes(ros, page, 'watch', lambda watch: watch['objects'])
    status, answer = page.post('/api/background?cell=/', {})
    assert status == 200 and answer['sentence'].startswith('took 640 x 480 px')


@pytest.mark.parametrize('kind, flag', [
    ('annotated', cv2.IMREAD_COLOR), ('frame', cv2.IMREAD_COLOR),
    ('mask', cv2.IMREAD_UNCHANGED), ('background', cv2.IMREAD_COLOR)])
def test_pictures_come_as_they_are_asked_for(ros, dashboard, cell, kind, flag):
    page = dashboard()
    page.watch_pictures(kind)
    ros.spin_until(lambda: page.pictures)
    picture = cv2.imdecode(np.frombuffer(page.pictures[0], np.uint8), flag)
    assert picture.shape[:2] == (480, 640)


@pytest.mark.slow
def test_log_and_health_of_both_nodes_are_shown(ros, dashboard):
    ros.add(CameraPublisher, *SIMULATED, *SIMULATED_CELL)
    ros.add(RobotBasePublisher)
    page = dashboard()
    page.look()
    nodes = ['/camera_publisher', '/robot_base_publisher']
    health = comes(ros, page, 'health', lambda health: all(
        one['level'] == 'ok' for one in health['nodes']) and len(health['charts']['rate_hz']) > 2)
    assert [one['name'] for one in health['nodes']] == nodes
    assert health['nodes'][0]['values']['source'] == 'simulated'
    log = comes(ros, page, 'log', lambda log: {line['node'] for line in log} == set(nodes))
    assert any("frames of 'simulated'" in line['text'] for line in log)
    times = [line['time'] for line in log]
    assert times == sorted(times)


def test_a_cell_in_a_namespace_is_found_and_kept_apart(ros, dashboard):
    ros.add(CameraPublisher, *SIMULATED, '-r', '__ns:=/left')
    page = dashboard()
    other = ros.add(RobotBasePublisher)
    assert other.get_namespace() == '/'
    page.look('/left')
    cells = comes(ros, page, 'cells', lambda cells: len(cells) == 2)
    assert cells == [{'cell': '/'}, {'cell': '/left'}]
    watch = comes(ros, page, 'watch', lambda watch: watch['objects'])
    assert watch['objects'][0]['base'] is None
    assert watch['state']['reason'] == 'transform_not_running'
    assert '__ns:=/left' in watch['state']['sentence']


@pytest.mark.slow
def test_nothing_costs_anything_while_nobody_looks(ros, dashboard, cell):
    topics = ['/objects_in_cam_frame', '/objects_in_cam_frame/ellipses', '/debug_image/compressed',
              '/frame/compressed', '/rosout']

    def listened_to():
        return [topic for topic in topics if any(
            info.node_name == 'dashboard'
            for info in ros.node.get_subscriptions_info_by_topic(topic))]

    page = dashboard()
    ros.spin_for(0.5)
    assert listened_to() == []
    sockets = [page.look(), page.watch_pictures('annotated')]
    ros.spin_until(lambda: listened_to() == [topics[0], topics[1], topics[2], topics[4]])
    for socket in sockets:
        page.close_socket(socket)
    ros.spin_until(lambda: listened_to() == [])


def test_an_action_for_a_cell_that_nobody_looks_at_is_refused_with_the_cure(ros, dashboard):
    status, answer = dashboard().post('/api/background?cell=/', {})
    assert status == 409 and 'open one first' in answer['error']
