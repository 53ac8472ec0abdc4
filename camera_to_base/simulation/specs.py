# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The parameters `simulated.*`: what the simulated table shows, and its bad days."""

from typing import Any, Mapping

from camera_to_base.parameters import default_values, grouped, ParameterSpec

LARGEST_TILT_DEG = 60.0
SHOWN = OBJECTS, STILL_OBJECTS, BOARD, EMPTY = 'objects', 'still_objects', 'board', 'empty'
TABLES = GREY, WOOD, PRINTED = 'grey', 'wood', 'printed'
SHAPES = DISC, BOX, HEXAGON = 'disc', 'box', 'hexagon'
PLACEMENT_COUNT = 8
STILL_COUNT = 5
MARKER_COUNT = 4

# What a person changes while the node runs: the table, and where the camera is.
_SCENE_SPECS = [
    ParameterSpec('simulated.shows', OBJECTS,
                  'simulated: what lies on the table: objects that move, five still objects, a '
                  'printed chessboard of 9x6 corners and 25 mm squares, or nothing.',
                  choices=SHOWN),
    ParameterSpec('simulated.layout', 0,
                  'simulated: where the still objects lie: 0 for their usual places; each other '
                  'number moves and turns each of them, by up to 1.5 cm.', (0, 2**31 - 1)),
    ParameterSpec('simulated.taken', [0],
                  'simulated: the still objects that were taken away, by number, 1 for the one '
                  'in the middle; 0 for none.', (0, STILL_COUNT)),
    ParameterSpec('simulated.placement', 1,
                  'simulated: where the chessboard lies: 1 in the middle, 2 to 5 towards the '
                  'corners, 6 to 8 turned.', (1, PLACEMENT_COUNT)),
    ParameterSpec('simulated.markers', False,
                  'simulated: whether the markers 0 to 3, 40 mm wide, lie near the corners of '
                  'the picture.'),
    ParameterSpec('simulated.table', GREY,
                  "simulated: the table's surface.", choices=TABLES),
    ParameterSpec('simulated.touched', 0,
                  'simulated: the number of the object that the robot touches, 1 for the largest '
                  'in the picture; 0 for none. Its tool is published on simulated_tool.',
                  (0, 100)),
    ParameterSpec('simulated.touched_marker', -1,
                  'simulated: the marker whose middle the robot touches; -1 for none.',
                  (-1, MARKER_COUNT - 1)),
    ParameterSpec('simulated.camera_shift_px', [0.0, 0.0],
                  'simulated: the camera is moved, so that the picture of the table moves to '
                  'the right and down.', (-2000, 2000), unit='px', lengths=(2,)),
    ParameterSpec('simulated.camera_turn_deg', 0.0,
                  'simulated: the camera is turned, so that the picture of the table turns '
                  'clockwise about its middle.', (-180, 180), unit='deg'),
    ParameterSpec('simulated.camera_tilt_deg', [0.0, 0.0],
                  'simulated: the camera is tilted further, so that the top and the left of the '
                  'picture show more distant points.', (-25, 25), unit='deg', lengths=(2,)),
    ParameterSpec('simulated.camera_zoom', 1.0,
                  'simulated: the camera comes nearer by this factor.', (0.3, 3)),
]

SIMULATION_SPECS = [
    *_SCENE_SPECS,
    ParameterSpec('simulated.tilt_deg', 0.0,
                  "simulated: the camera's tilt, 0 looks straight down.", (0, LARGEST_TILT_DEG),
                  unit='deg', fixed=True),
    ParameterSpec('simulated.seed', 0, 'simulated: makes the noise.', (0, 2**31 - 1), fixed=True),
    ParameterSpec('simulated.frame_rate', 10.0, 'simulated: frames per second.', (0.1, 1000),
                  unit='Hz', fixed=True),
    ParameterSpec('simulated.noise', 2.0,
                  'simulated: standard deviation of the noise.', (0, 100),
                  unit='grey levels', fixed=True),
    ParameterSpec('simulated.light_drift', 0.0,
                  'simulated: what the table gains (or loses) in a minute.',
                  (-255, 255), unit='grey levels', fixed=True),
    ParameterSpec('simulated.exposure_step', 1.0,
                  "simulated: the factor by which the camera's exposure jumps every 15 s.",
                  (0.01, 100), fixed=True),
    ParameterSpec('simulated.shadow', 0.0,
                  'simulated: what a soft shadow takes away.', (0, 255),
                  unit='grey levels', fixed=True),
    ParameterSpec('simulated.hands', 0,
                  'simulated: how often a hand reaches into the picture in a minute.', (0, 100),
                  fixed=True),
    ParameterSpec('simulated.table_level', 202.0,
                  "simulated: the table's brightness.", (1, 255), unit='grey levels',
                  fixed=True),
    ParameterSpec('simulated.contrast', 142.0,
                  'simulated: objects are that much darker than the table (lighter, where '
                  'negative).', (-255, 255), unit='grey levels', fixed=True),
    ParameterSpec('simulated.diameters_cm', [2.4],
                  'simulated: the diameter of each object.', (0.1, 100), unit='cm', fixed=True),
    ParameterSpec('simulated.shapes', [DISC],
                  'simulated: the shape of each object; the first one follows the last one. The '
                  'diameter is the length of a box, and of a hexagon from corner to corner.',
                  choices=SHAPES, fixed=True),
    ParameterSpec('simulated.heights_cm', [0.0],
                  'simulated: the height of each object, 0 for a flat one; the first one follows '
                  'the last one. Solid objects have sides, and shadows of two lamps.', (0, 6),
                  unit='cm', fixed=True),
    ParameterSpec('simulated.elongation', 1.0,
                  'simulated: objects are that much longer than wide, the diameter being their '
                  'length; 1 for coins.', (1, 10), fixed=True),
    ParameterSpec('simulated.yaw_deg', 0.0,
                  "simulated: the direction of the first object's length, from x towards y; each "
                  'further one is turned by 50 degrees more.', (-180, 180), unit='deg',
                  fixed=True),
    ParameterSpec('simulated.highlight', False,
                  'simulated: whether flat discs have a spot that looks like the table.',
                  fixed=True),
    ParameterSpec('simulated.texture', 0.0,
                  "simulated: standard deviation of the table's pattern.",
                  (0, 100), unit='grey levels', fixed=True),
    ParameterSpec('simulated.over_edge', False,
                  "simulated: whether the objects' paths lead beyond the picture's edge.",
                  fixed=True),
    ParameterSpec('simulated.in_first_frame', False,
                  'simulated: whether the objects lie there on the first frame, the background.',
                  fixed=True),
    ParameterSpec('simulated.rests', False,
                  'simulated: whether the objects stop on their way.', fixed=True),
]
# By their names without 'simulated.'.
SIMULATION_DEFAULTS: Mapping[str, Any] = grouped(default_values(SIMULATION_SPECS), 'simulated.')
