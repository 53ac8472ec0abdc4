# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from pathlib import Path

from camera_to_base.parameters.transform import transform_settings, TRANSFORM_SPECS
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.simulation.board import SimulatedBoard
import numpy as np
import pytest
import yaml

CONFIG = Path(__file__).parents[1] / 'config'
# The list of cameras names parameter files; it is none.
FILES = sorted(path.name for path in CONFIG.glob('*.yaml') if path.name != 'two_cameras.yaml')
TUTORIALS = ['overhead_camera.yaml', 'tilted_camera.yaml']

all_files = pytest.mark.parametrize('name', FILES)


def flat(tree, prefix=''):
    values = {}
    for name, value in tree.items():
        if isinstance(value, dict):
            values.update(flat(value, f'{prefix}{name}.'))
        else:
            values[prefix + name] = value
    return values


def values_of(name):
    return flat(yaml.safe_load((CONFIG / name).read_text())['/**']['ros__parameters'])


def defaults():
    return {spec.name: spec.default for spec in CAMERA_SPECS + TRANSFORM_SPECS}


def test_there_is_a_file_for_each_case():
    assert {*TUTORIALS, 'simulated_camera.yaml', 'simulated_tilted_camera.yaml',
            'simulated_solid_objects.yaml', 'simulated_left.yaml',
            'simulated_right.yaml'} == set(FILES)


@all_files
def test_file_speaks_to_both_nodes_and_says_nothing_else(name):
    content = yaml.safe_load((CONFIG / name).read_text())
    assert list(content) == ['/**'] and list(content['/**']) == ['ros__parameters']


def test_simulated_cameras_calibration_is_that_of_the_board():
    values = values_of('simulated_camera.yaml')
    settings = camera_settings({**defaults(), **values})
    board = SimulatedBoard(image_size=settings.image_size, noise=0.0)
    board.read()
    pixels = [(0.0, 0.0), (639.0, 0.0), (200.0, 400.0)]
    true = [board.surface_from_pixel @ (*pixel, 1.0) for pixel in pixels]
    assert settings.surface.locate(pixels) == pytest.approx(
        np.array([(x / w, y / w) for x, y, w in true]), abs=1e-9)
    uncertain = settings.uncertainty.of_pixel(pixels[0], settings.image_size)
    assert settings.is_calibrated and max(uncertain.xx, uncertain.yy) < 0.1 ** 2
    assert values['displacement_cm'] == defaults()['displacement_cm']


def test_simulated_tilted_cameras_matrix_is_that_of_the_board():
    values = values_of('simulated_tilted_camera.yaml')
    board = SimulatedBoard(
        tilt_deg=values['simulated.tilt_deg'], image_size=values['surface.image_size'])
    assert values['simulated.tilt_deg'] == 30.0
    assert values['surface.homography.surface_from_pixel'] == pytest.approx(
        board.surface_from_pixel.ravel().tolist(), rel=1e-9, abs=1e-15)


def test_simulated_solid_objects_are_seen_by_the_camera_that_the_file_describes():
    values = values_of('simulated_solid_objects.yaml')
    settings = camera_settings({**defaults(), **values})
    true = SimulatedBoard(
        tilt_deg=values['simulated.tilt_deg'], image_size=settings.image_size).pinhole
    points = np.array([[3.0, 4.0, 0.0], [30.0, 20.0, 3.0], [18.0, 13.5, 6.0]])
    assert settings.surface.pixels_of(points) == pytest.approx(true.pixels_of(points), abs=1e-9)
    assert settings.is_calibrated
    assert {values['object_height_cm']} == set(values['simulated.heights_cm'])


@all_files
def test_file_has_only_names_that_the_nodes_declare(name):
    assert set(values_of(name)) <= set(defaults())


@all_files
def test_file_has_values_of_the_declared_types(name):
    for parameter, value in values_of(name).items():
        default = defaults()[parameter]
        assert type(value) is type(default)
        if isinstance(value, list):
            of_one = type(default[0]) if default else float
            assert [type(item) for item in value] == [of_one] * len(value)


@all_files
def test_file_makes_the_settings_of_both_nodes(name):
    values = {**defaults(), **values_of(name)}
    surface = camera_settings(values).surface
    assert type(surface).__name__.lower() == values['surface.model'] + 'surface'
    conversion = transform_settings(values)
    assert conversion.base_from_camera[:3, 3].tolist() == values['displacement_cm']


def test_overhead_camera_repeats_the_tutorials_defaults():
    values = values_of('overhead_camera.yaml')
    assert values == {name: defaults()[name] for name in values}


def test_tilted_camera_repeats_the_tutorials_polynomials_and_moves_nothing():
    values = values_of('tilted_camera.yaml')
    polynomial = {name: value for name, value in defaults().items() if '.polynomial.' in name}
    assert {name: values[name] for name in polynomial} == polynomial
    assert values['rotation_deg'] == values['displacement_cm'] == [0.0, 0.0, 0.0]


def test_rviz_shows_what_the_nodes_publish_wherever_their_namespace_is():
    content = yaml.safe_load((CONFIG / 'camera_to_base.rviz').read_text())['Visualization Manager']
    topics = {display['Topic']['Value'] for display in content['Displays'] if 'Topic' in display}
    assert topics == {'objects_in_cam_frame', 'objects_in_robot_base_frame',
                      'pos_in_robot_base_frame/point', 'debug_image',
                      'objects_in_robot_base_frame/ellipses'}
    assert content['Global Options']['Fixed Frame'] == 'base_link'
