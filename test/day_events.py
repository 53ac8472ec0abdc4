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

import cv2
from day_world import Arm, HEIGHT, MARGIN, SHAPE, Thing, WIDTH
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
    if world.push.any():
        return
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


def lobe(world, random):
    """Let a lamp light a part of the table, without an edge."""
    at, size = random.uniform((0, 0), SHAPE[::-1]), random.uniform(40, 150)
    v, u = np.mgrid[:SHAPE[0], :SHAPE[1]].astype(np.float32)
    near = np.exp(-((u - at[0]) ** 2 + (v - at[1]) ** 2) / (2 * size ** 2))
    yield from _lit(world, random, random.choice([-0.4, 0.3, 0.5]) * near)


def patch(world, random):
    """Let the sun shine through a window: a patch with an edge."""
    if not world.has_texture:
        return
    centre, size = random.uniform((60, 60), (WIDTH, HEIGHT)), random.uniform(30, 110, 2)
    corners = cv2.boxPoints((tuple(centre), tuple(size), random.uniform(0, 180)))
    mask = cv2.fillPoly(np.zeros(SHAPE, np.float32), [np.int32(corners)], 1.0)
    yield from _lit(world, random, random.uniform(0.15, 0.6) * cv2.GaussianBlur(
        mask, (0, 0), random.uniform(0.7, 3)))


def shadow(world, random):
    """Let somebody stand in the light: a shadow from beyond an edge."""
    begin = np.array(_beyond_an_edge(random)) + MARGIN
    end = begin + random.uniform(0.2, 0.6) * (np.array(SHAPE[::-1]) / 2 - begin)
    mask = cv2.line(np.zeros(SHAPE, np.float32), np.int32(begin), np.int32(end), 1.0,
                    int(random.uniform(40, 160)))
    yield from _lit(world, random, -random.uniform(0.15, 0.5) * cv2.GaussianBlur(
        mask, (0, 0), random.uniform(2, 12)))


def neighbour(world, random):
    """Put an object down right beside another one."""
    one = _any(world, random)
    if one is None or len(world.things) > 4:
        return
    turn, thing = random.uniform(0, 2 * np.pi), world.new_thing(random, (0.0, 0.0))
    apart = one.reach + thing.reach + random.uniform(4, 9)
    thing.at = one.at + apart * np.array([np.cos(turn), np.sin(turn)])
    is_in_view = (np.minimum(thing.at, (WIDTH, HEIGHT) - thing.at) > 30).all()
    if is_in_view and world.is_free(thing.at, but=one):
        yield from _done(world, random, thing.at, lambda: one in world.things and world.is_free(
            thing.at, but=one) and world.things.append(thing))


def saturation(world, random):
    """Let the camera or the light overexpose the picture for a moment."""
    strongest, rise = random.uniform(1.6, 6), int(random.integers(1, 8))
    stays = int(random.integers(1, 12))
    for value in [*np.linspace(1, strongest, rise + 1)[1:], *[strongest] * stays]:
        world.flicker = value
        yield


def push(world, random):
    """Push the table; the background is taken anew after a while."""
    if world.push.any() or world.pose.any() or world.shift.any():
        # Not beside a bump: both together are not told apart each time.
        return
    angle, length = random.uniform(0, 2 * np.pi), random.uniform(6, 14)
    before = world.push
    for share in np.linspace(0, 1, int(random.integers(2, 8))):
        world.push = before + share * length * np.array([np.cos(angle), np.sin(angle)])
        world.moving.append(None)
        yield
    for _ in range(int(random.integers(10, 50))):
        yield
    yield from retake(world, random)


def leave(world, random):
    """Take or turn an object of the background; take one with the objects if there is none."""
    things = [thing for thing in world.things if thing.in_background]
    if not things:
        world.orders.append(('capture', random.uniform(0, 1, 1)))
        yield
        return
    thing = things[random.integers(len(things))]
    if random.random() < 0.5:
        yield from _done(world, random, thing.at, lambda: _remove(world, thing))
    else:
        thing.angle += random.uniform(10, 80)
        thing.at = thing.at + random.uniform(-6, 6, 2)
        yield


def sheet(world, random):
    """Lay a sheet of paper on the table, and perhaps an object on that."""
    paper = Thing(random, np.full(3, random.uniform(225, 250)), (0.0, 0.0))
    paper.radius, paper.width, paper.is_round = 48, 36, False
    paper.at = random.uniform((70, 70), (WIDTH - 70, HEIGHT - 70))
    if not world.is_free(paper.at, reach=paper.reach):
        return

    def lay():
        if world.is_free(paper.at, reach=paper.reach):
            world.things.append(paper)

    yield from _done(world, random, paper.at, lay)
    if paper in world.things and random.random() < 0.7:
        for _ in range(12):
            yield
        thing = world.new_thing(random, paper.at + random.uniform(-12, 12, 2))
        thing.is_on_sheet = thing.is_round = True
        if paper in world.things:
            world.things.append(thing)


def _done(world, random, at, do):
    # By a hand, or at once.
    if random.random() < 0.6:
        yield from hand(world, random, at, do)
    else:
        do()
        yield


def _lit(world, random, change):
    if world.gains:
        # One at a time: the edge of a patch that fades in is not known from a lamp that does.
        return
    rise, stays = int(random.integers(1, 20)), int(random.integers(5, 40))
    shares = np.linspace(0, 1, rise + 1)[1:]
    for share in [*shares, *np.ones(stays), *shares[::-1]]:
        world.gains.append(1 + share * change)
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
    hand, put, take, move, bump, wobble, light, damage, outage, setting, retake, lobe, patch,
    shadow, neighbour, saturation, push, leave, sheet)}
