# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
What happens on a day with markers: each event is a generator, one step a frame.

It draws its numbers from a generator of its own. `cell` is what the user starts, and asks for a
new background.
"""

from marker_world import between, HEIGHT, moved_camera, Thing, WIDTH
import numpy as np
from rendered_markers import Camera, PLACES, random_camera

_SHEET, _DARK, _COIN = 0.7, 0.08, 0.6


def bump(world, random, cell):
    """Bump the camera; it stays there."""
    yield from _carried(world, moved_camera(world.camera, random, random.uniform(0.05, 1)),
                        int(random.integers(0, 4)))
    yield from _rest(random, 10, 30)


def carry(world, random, cell):
    """Put the camera to another place."""
    there = random_camera(random, focal_px=world.camera.focal_px, **world.fixed)
    yield from _carried(world, there, int(random.integers(2, 6)))
    yield from _rest(random, 15, 35)


def put_back(world, random, cell):
    """Put the camera back where it was calibrated, or nearly there."""
    there = moved_camera(world.home, random, random.choice([0, 0.05, 0.3]))
    yield from _carried(world, there, int(random.integers(1, 5)))
    yield from _rest(random, 15, 35)


def zoom(world, random, cell):
    """Turn the lens."""
    factor = random.uniform(1.02, 1.25) ** random.choice([-1, 1])
    there = Camera(**{**world.camera.pose, 'focal_px': world.camera.focal_px * factor})
    yield from _carried(world, there, int(random.integers(0, 5)))
    yield from _rest(random, 15, 35)


def cover(world, random, cell):
    """Lay a sheet or a dark object over a part of a marker or two, or beside it."""
    for number in random.choice(4, int(random.choice([1, 1, 2])), replace=False):
        at = np.add(world.places[number][:2], random.uniform(-2.5, 2.5, 2))
        is_sheet = random.random() < 0.6
        world.covers.append(Thing(at, random.uniform(2, 6) if is_sheet else random.uniform(1, 3),
                                  _SHEET if is_sheet else _DARK,
                                  random.uniform(0, 3) if is_sheet else None))
    yield from _reached(world, random, world.covers[-1].at)
    yield from _rest(random, 5, 20)


def uncover(world, random, cell):
    """Take away what lies on the markers."""
    world.covers = []
    yield from _rest(random, 10, 20)


def shift_marker(world, random, cell):
    """Move a marker on the table."""
    number = int(random.integers(4))
    x, y, yaw = world.places[number]
    by, angle = random.choice([0.3, 0.6, 1.0, 2.0, 6.0]), random.uniform(0, 2 * np.pi)
    yield from _reached(world, random, (x, y))
    world.places[number] = (x + by * np.cos(angle), y + by * np.sin(angle),
                            yaw + random.choice([0, 0, random.uniform(-0.5, 0.5)]))
    yield from _rest(random, 10, 30)


def swap(world, random, cell):
    """Exchange two markers."""
    one, other = (int(number) for number in random.choice(4, 2, replace=False))
    world.places[one], world.places[other] = world.places[other], world.places[one]
    yield from _rest(random, 10, 30)


def tidy(world, random, cell):
    """Put the markers back, and take away what lies on them."""
    world.covers, world.places = [], dict(PLACES)
    yield from _rest(random, 8, 12)


def glare(world, random, cell):
    """Let light shine on a marker, or somewhere."""
    world.glare = (*random.uniform(0.1, 0.9, 2), random.uniform(0.3, 1.5))
    if random.random() < 0.7:
        pixel, = world.camera.project([world.places[int(random.integers(4))][:2]])
        world.glare = (*(pixel / (WIDTH, HEIGHT)), world.glare[2])
    yield from _rest(random, 5, 25)
    world.glare = None
    yield from _rest(random, 3, 6)


def lamp(world, random, cell):
    """Change the light."""
    to = random.uniform(0.5, 1.2)
    for value in np.linspace(world.lamp, to, int(random.choice([1, 20]))):
        world.lamp = value
        yield
    yield from _rest(random, 3, 10)


def capture(world, random, cell):
    """Take a new background, mostly with a cleared table."""
    if random.random() < 0.8:
        world.coin = None
    yield
    cell.pipeline.capture_background(int(random.choice([1, 3])))
    yield from _rest(random, 8, 15)


def restart(world, random, cell):
    """Start the node anew, with its background file or without."""
    if random.random() < 0.7:
        world.coin = None
    cell.restart(with_file=random.random() < 0.5)
    yield from _rest(random, 10, 20)


def coin(world, random, cell, at=None, frames=None):
    """Put the coin on the table, or move it."""
    yield from _rest(random, 8, 9)
    world.coin = Thing(_free_place(world, random) if at is None else at, 1.2, _COIN)
    yield from _rest(random, frames or 8, frames or 25)


def hand(world, random, cell):
    """Reach in."""
    yield from _reached(world, random, random.uniform((3, 3), (37, 27)))
    yield from _rest(random, 2, 6)


def _free_place(world, random):
    for _ in range(50):
        at = random.uniform((6, 5), (34, 25))
        if world.sees(at) and all(np.hypot(*(thing.at - at)) > 1.5 + 1.5 * thing.half
                                  for thing in world.covers) and all(
                np.hypot(x - at[0], y - at[1]) > 6 for x, y, _ in world.places.values()):
            return at
    return np.array([20.0, 15.0])


def _carried(world, there, frames):
    here = world.camera
    for share in np.linspace(0, 1, frames + 2)[1:-1]:
        world.camera = between(here, there, share)
        yield
    world.camera = there
    yield


def _reached(world, random, at):
    tip, = world.camera.project([at])
    begin = np.array([random.choice([-60, WIDTH + 60]), random.uniform(0, HEIGHT)])
    width, shade = random.uniform(30, 60), random.uniform(0.05, 0.5)
    for reach in (0.3, 0.6, 0.9, 1.0, 1.0, 0.9, 0.6, 0.3):
        world.hands.append((begin, begin + reach * (tip - begin), width, shade))
        yield


def _rest(random, least, most):
    for _ in range(int(random.integers(least, most + 1))):
        yield


EVENTS = {event.__name__: event for event in (
    bump, carry, put_back, zoom, cover, uncover, shift_marker, swap, tidy, glare, lamp, capture,
    restart, coin, hand)}
# Much is moved, and mostly there is something to find.
SHARES = {'coin': 5.0, 'carry': 2.0, 'capture': 2.0, 'bump': 1.5, 'swap': 0.5, 'hand': 0.5}
