# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What both nodes would take from a parameter file, read without them."""

from pathlib import Path

from camera_to_base.errors import InvalidValueError
from camera_to_base.settings import read_node_settings
import pytest


@pytest.fixture
def read(tmp_path):
    def read_text(text, namespace=None):
        (tmp_path / 'cell.yaml').write_text(text)
        return read_node_settings(str(tmp_path / 'cell.yaml'), namespace)
    return read_text


def section(name, values):
    return f'{name}:\n  ros__parameters: {{{values}}}\n'


def test_without_a_file_both_have_their_defaults():
    settings = read_node_settings(None)
    assert settings.camera.detector.method == 'precise'
    assert settings.transform.base_point(0.0, 0.0) == pytest.approx((-17.8, 24.4, 0.0))
    assert settings.warnings == []


def test_a_nodes_own_section_overrides_the_one_for_all(read):
    settings = read(section('/**', 'period: 1, reach_cm: 50, detector: {threshold: 60}')
                    + section('camera_publisher', 'period: 2.5')
                    + section('robot_base_publisher', 'reach_cm: 70.0'))
    assert settings.camera.period == 2.5 and settings.camera.detector.threshold == 60
    assert settings.transform.reach_cm == 70.0 and settings.warnings == []


@pytest.mark.parametrize('name', ['/cell/camera_publisher', '/cell:\n  camera_publisher'])
def test_the_only_namespace_of_a_file_is_found(read, name):
    text = section('/**', 'period: 1')
    nested = section(name, 'period: 2.0').replace('\n  ros__', '\n    ros__')
    assert read(text + nested).camera.period == 2.0


def test_of_several_namespaces_one_must_be_chosen(read):
    text = (section('/left/camera_publisher', 'period: 1')
            + section('/right/camera_publisher', 'period: 2'))
    with pytest.raises(InvalidValueError, match='with --namespace: /left, /right'):
        read(text)
    for name in ('right', '/right', '/right/'):
        assert read(text, name).camera.period == 2.0


def test_namespace_that_a_file_does_not_have_is_refused(read):
    text = section('/left/camera_publisher', 'period: 1')
    with pytest.raises(InvalidValueError, match="namespace 'lfet', but for those in /left"):
        read(text, 'lfet')
    assert read(text + section('/**', 'period: 2.0'), 'lfet').camera.period == 2.0


def test_as_ros_reads_a_file_so_does_it(read, ros, tmp_path):
    import rclpy
    from rclpy.node import Node
    text = (section('camera_publisher', 'period: 4') + section('/*', 'period: 5')
            + section('/**', 'detector: {threshold: 60}')
            + section('/cell/camera_publisher', 'period: 6')
            + section('/**/camera_publisher', 'detector: {threshold: 70}'))
    for namespace in ('/', '/cell'):
        settings = read(text, namespace).camera
        context = rclpy.Context()
        rclpy.init(context=context, args=[
            '--ros-args', '--params-file', str(tmp_path / 'cell.yaml')])
        node = Node('camera_publisher', namespace=namespace, context=context)
        expected = {name: given.value for name, given in node._parameter_overrides.items()}
        node.destroy_node()
        context.shutdown()
        assert settings.period == expected['period']
        assert settings.detector.threshold == expected['detector.threshold']


def test_unknown_names_are_told_with_what_was_meant(read):
    settings = read(section('/**', 'detector: {treshold: 50}, reach: 3, use_sim_time: true, '
                                   'qos_overrides: {/mask: {publisher: {depth: 3}}}'))
    assert settings.warnings == [
        "there is no parameter 'detector.treshold', it is left out: did you mean "
        "'detector.threshold'?",
        "there is no parameter 'reach', it is left out: did you mean 'reach_cm'?"]


def test_a_node_name_that_is_misspelt_is_told_and_that_of_another_node_is_not(read):
    text = section('camera_publsher', 'period: 2') + section('usb_cam', 'framerate: 3')
    for everyone in ('', section('/**', 'period: 1')):
        warning, = read(everyone + text).warnings
        assert warning.endswith("has parameters for '/camera_publsher', and none for this node "
                                "alone, '/camera_publisher'")


def test_a_file_without_a_parameter_is_told(read):
    warning, = read('/**:\n  ros__parameters:\n').warnings
    assert warning.endswith("cell.yaml' holds no parameters")


@pytest.mark.parametrize('name', ['overhead_camera', 'tilted_camera', 'simulated_tilted_camera'])
def test_files_of_this_package_are_read_without_a_warning(name):
    config = Path(__file__).parents[2] / 'config'
    assert read_node_settings(str(config / f'{name}.yaml')).warnings == []


CONFIG = Path(__file__).parents[2] / 'config'


@pytest.mark.parametrize('file, is_configured, is_calibrated', [
    (None, False, False), ('overhead_camera.yaml', False, False),
    ('tilted_camera.yaml', True, True), ('simulated_tilted_camera.yaml', True, True)])
def test_the_tutorials_numbers_are_no_setup(file, is_configured, is_calibrated):
    camera = read_node_settings(file and str(CONFIG / file)).camera
    assert (camera.is_configured, camera.is_calibrated) == (is_configured, is_calibrated)


@pytest.mark.parametrize('values, is_configured, is_calibrated', [
    ('surface.parallel.width_cm: 36', False, False), ('period: 0.1', False, False),
    ('surface.parallel.width_cm: 36.5', True, True), ('displacement_cm: [1, 2, 0]', True, False),
    ('surface.image_size: [1280, 720]', True, False), ('detector.threshold: 60', True, False)])
def test_other_numbers_are_a_setup_and_those_of_the_surface_a_calibration(
        read, values, is_configured, is_calibrated):
    camera = read(section('/**', values)).camera
    assert (camera.is_configured, camera.is_calibrated) == (is_configured, is_calibrated)
