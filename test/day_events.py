# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What happens on a random day: each event runs beside the others, one step a frame.

An event is a generator. Between two `yield` it says what it adds to the next frame. It draws all
its numbers from a generator of its own, so that a day without it is otherwise the same day.
"""

from day_world import Arm, HEIGHT, WIDTH
import numpy as np


def hand(world, random, tip=None, at_the_tip=lambda: None):
    """Reach in, hover, and go; `at_the_tip` is called there."""
    tip = random.uniform((40, 40), (WIDTH - 40, HEIGHT - 40)) if tip is None else tip
    arm = Arm(random, world.colour, _beyond_an_edge(random), tip)
    there, stays, back = (int(n) for n in random.integers((3, 1, 3), (10, 14, 10)))
    for reach in [*np.linspace(0, 1, there), *np.ones(stays), *np.linspace(1, 0, back)]:
        if reach == 1:
            at_the_tip()
            at_the_tip = _nothing
        world.arms.append((arm, reach))
        yield


def put(world, random):
    """Put an object on the table, by hand or from one frame to the next."""
    at = world.free_place(random)
    if at is None or len(world.things) > 4:
        return
    thing = world.new_thing(random, at)
    yield from _done(world, random, at, lambda: world.is_free(at) and world.things.append(thing))


def take(world, random):
    """Take an object from the table."""
    thing = _any(world, random)
    if thing is not None:
        yield from _done(world, random, thing.at, lambda: _remove(world, thing))


def move(world, random):
    """Let an object slide to another place, at up to 400 mm/s."""
    thing = _any(world, random)
    to = thing is not None and world.free_place(random, but=thing)
    if thing is None or to is None:
        return
    way, step = to - thing.at, random.uniform(2, 59)
    steps = np.linspace(0, 1, max(2, int(np.hypot(*way) / step)))
    places = [thing.at + share * way for share in steps]
    for at in places:
        if thing not in world.things or not world.is_free(at, but=thing):
            return
        thing.at, thing.in_background = at, False
        world.moving.append(thing)
        yield


def bump(world, random):
    """Bump the camera; it is put back after a while, or the background is taken anew."""
    offset, begin = _offset(random), int(random.choice([0, 0, 6, 12]))
    stays = int(random.integers(2, 30))
    for share in [*np.linspace(0, 1, begin), *np.ones(stays)]:
        world.shift += share * offset
        yield
    if random.random() < 0.5:
        world.pose = world.pose + offset
        yield from retake(world, random)


def wobble(world, random):
    """Let the camera swing."""
    offset, period = _offset(random) / 2, random.uniform(3, 15)
    for number in range(int(random.integers(6, 40))):
        world.shift += np.sin(2 * np.pi * number / period) * offset
        yield


def light(world, random):
    """Change the light, at once or slowly."""
    to = random.uniform(0.5, 1.4)
    if random.random() < 0.5:
        world.light = to
        return
    count = int(random.integers(12, 60))
    for value in np.linspace(world.light, to, count):
        world.flicker = value / world.light
        yield
    world.light = to


def damage(world, random):
    """Damage some frames."""
    kind = str(random.choice(['frozen rows', 'one colour', 'repeated', 'grey', 'black']))
    row, colour = int(random.integers(20, HEIGHT - 8)), random.integers(0, 256, 3)
    period = random.integers(1, 4)
    for number in range(int(random.integers(1, 20))):
        if number % period == 0:
            world.damages.append((kind, row, colour))
        yield


def outage(world, random):
    """Lose the camera; it may come back with another picture size."""
    for _ in range(int(random.integers(2, 40))):
        world.is_lost = True
        yield
    if random.random() < 0.4:
        size = [(WIDTH // 2, HEIGHT // 2), (WIDTH * 2, HEIGHT * 2), (HEIGHT, WIDTH)]
        width, height = size[random.integers(3)]
        for _ in range(int(random.integers(1, 20))):
            world.damages.append(('size', width, height))
            yield


def setting(world, random):
    """Set a parameter of the running node."""
    kind = str(random.choice(['faintest', 'work area', 'no work area', 'rebuilt', 'limits']))
    world.orders.append((kind, random.uniform(0, 1, 4)))
    yield


def retake(world, random):
    """Take the background anew, often with a cleared table."""
    if random.random() < 0.7:
        world.things.clear()
    world.orders.append(('capture', random.uniform(0, 1, 1)))
    yield


def _done(world, random, at, do):
    # By a hand, or at once.
    if random.random() < 0.6:
        yield from hand(world, random, at, do)
    else:
        do()
        yield


def _nothing():
    pass


def _remove(world, thing):
    if thing in world.things:
        world.things.remove(thing)


def _any(world, random):
    return world.things[random.integers(len(world.things))] if world.things else None


def _offset(random):
    kind, angle = random.integers(3), random.uniform(0, 2 * np.pi)
    length, sign = random.choice([1, 2, 5, 10, 20, 40]), random.choice([-1, 1])
    offset = np.zeros(4)
    if kind == 0:
        offset[:2] = length * np.cos(angle), length * np.sin(angle)
    elif kind == 1:
        offset[2] = sign * random.uniform(0.5, 2)
    else:
        offset[3] = sign * random.uniform(0.01, 0.03)
    return offset


def _beyond_an_edge(random):
    along = random.uniform(0.1, 0.9)
    return [(-40, along * HEIGHT), (WIDTH + 40, along * HEIGHT), (along * WIDTH, -40),
            (along * WIDTH, HEIGHT + 40)][random.integers(4)]


EVENTS = {event.__name__: event for event in (
    hand, put, take, move, bump, wobble, light, damage, outage, setting, retake)}
