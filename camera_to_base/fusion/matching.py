# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Which silhouettes of different cameras are of one object."""

from dataclasses import dataclass
from itertools import permutations
from typing import Dict, List, NamedTuple, Sequence, Tuple

from camera_to_base.fusion.shape import COUNT, reach
from camera_to_base.fusion.solver import SeenOutline, Solution, solve
import numpy as np

# (camera, its silhouette), by their numbers.
Member = Tuple[int, int]
# A strain is that large by chance once in 10,000 times.
MOST_STRAIN = 18.4
# Share of the outline. In rendered cells heights were off by 2 mm at most above it, and by 3 to
# 50 mm below, where much was missing or the object was not upright, as a loaf.
LEAST_AGREEMENT = 0.7
# The cameras' footprints are farther apart where one silhouette is of two objects.
MOST_MISFIT_CM = 0.2
# A convex object has convex silhouettes, and two objects that came as one do not: of 600 drawn
# pairs, the 108 that fit otherwise are notched by 0.65 cm and more. In rendered cells light and
# shadow notch convex objects that fit otherwise by less than this, and bolts by 0.44 cm.
MOST_NOTCH_CM = 0.4
# Standard deviations by which a height may be beyond the limit.
_SIGMAS = 3.0
# Another assignment must cost so much more: it is e⁶ times less likely.
_CLEARLY_MORE = 12.0
# More silhouettes than these on one heap are not assigned.
_MOST_TOGETHER = 4


class Group(NamedTuple):
    """
    The silhouettes of one object, of one camera each.

    :param members: By camera.
    """

    members: Tuple[Member, ...]
    solution: Solution


@dataclass(frozen=True)
class Matches:
    """
    What belongs together.

    :param groups: Of two cameras or more each.
    :param alone: Silhouettes that no silhouette of another camera touches.
    :param disagreeing: Silhouettes that others touch, but with no height and place that fits.
    :param ambiguous: Silhouettes that may belong to one object or to another.
    """

    groups: List[Group]
    alone: List[Member]
    disagreeing: List[Member]
    ambiguous: List[Member]


def match(cameras: Sequence[Sequence[SeenOutline]], highest_cm: float) -> Matches:
    """
    Find the silhouettes of each object.

    :param cameras: Of each camera, what it sees.
    :param highest_cm: No object is higher.
    """
    touching = _touching(cameras)
    fits = {}
    for pair in touching:
        solution = solve([cameras[camera][number] for camera, number in pair])
        if is_plausible(solution, highest_cm):
            fits[pair] = solution
    partners, unclear = _assigned(fits)
    groups = []
    for members in _joined(partners):
        group = _solved_group(cameras, members, partners)
        if group is not None and is_plausible(group.solution, highest_cm):
            groups.append(group)
    used = {member for group in groups for member in group.members}
    touched = {member for pair in touching for member in pair}
    rest = [(camera, number) for camera, seen in enumerate(cameras)
            for number in range(len(seen)) if (camera, number) not in used]
    return Matches(
        groups, [one for one in rest if one not in touched],
        [one for one in rest if one in touched and one not in unclear],
        [one for one in rest if one in unclear])


def is_plausible(solution: Solution, highest_cm: float) -> bool:
    """Tell whether silhouettes fit together: as one object, by what the calibrations allow."""
    height, deviation = solution.height
    return (solution.moments.area > 0 and height <= highest_cm + _SIGMAS * deviation
            and bool(solution.strain.max() <= MOST_STRAIN)
            and min(solution.extent[:2]) > 0
            and solution.agreement >= LEAST_AGREEMENT
            and solution.misfit_cm <= MOST_MISFIT_CM
            and solution.notch_cm <= MOST_NOTCH_CM)


def _touching(cameras: Sequence[Sequence[SeenOutline]]) -> List[Tuple[Member, Member]]:
    """List the pairs whose footprints can be one: no line separates their silhouettes."""
    reaches = [np.array([reach(one.corners) for one in seen]) for seen in cameras]
    pairs = []
    for first in range(len(cameras)):
        for second in range(first + 1, len(cameras)):
            if not (len(cameras[first]) and len(cameras[second])):
                continue
            opposite = np.roll(reaches[second], COUNT // 2, axis=1)
            meet = (reaches[first][:, None] + opposite[None]).min(axis=2) > 0
            pairs += [((first, i), (second, j)) for i, j in np.argwhere(meet).tolist()]
    return pairs


def _assigned(
    fits: Dict[Tuple[Member, Member], Solution]
) -> Tuple[Dict[Tuple[Member, Member], Solution], set]:
    """Choose the pairs, one to one between two cameras, and what cannot be decided."""
    chosen, unclear = {}, set()
    for pairs in _heaps(fits):
        if len(pairs) == 1:
            chosen[pairs[0]] = fits[pairs[0]]
            continue
        best = _best_of(pairs, fits)
        if best is None:
            unclear.update(member for pair in pairs for member in pair)
        else:
            chosen.update({pair: fits[pair] for pair in best})
    return chosen, unclear


def _heaps(fits: Dict[Tuple[Member, Member], Solution]) -> List[List[Tuple[Member, Member]]]:
    """Sort the pairs of each two cameras into those that share a silhouette."""
    heaps: List[List[Tuple[Member, Member]]] = []
    for pair in fits:
        cameras = {camera for camera, _ in pair}
        own = [heap for heap in heaps if {camera for camera, _ in heap[0]} == cameras
               and any(set(pair) & set(other) for other in heap)]
        heaps = [heap for heap in heaps if heap not in own]
        heaps.append([other for heap in own for other in heap] + [pair])
    return heaps


def _best_of(pairs, fits):
    """Return the cheapest assignment with the most pairs; None where another is as likely."""
    firsts = sorted({pair[0] for pair in pairs})
    seconds = sorted({pair[1] for pair in pairs})
    if max(len(firsts), len(seconds)) > _MOST_TOGETHER:
        return None
    options = {}
    slots = [*seconds, *[None] * len(firsts)]
    for order in permutations(slots, len(firsts)):
        option = frozenset(
            (one, other) for one, other in zip(firsts, order) if (one, other) in fits)
        options[option] = sum(fits[pair].cost for pair in option)
    most = max(map(len, options))
    ranked = sorted((cost, sorted(option)) for option, cost in options.items()
                    if len(option) == most)
    if len(ranked) > 1 and ranked[1][0] - ranked[0][0] < _CLEARLY_MORE:
        return None
    return ranked[0][1]


def _joined(partners) -> List[Tuple[Member, ...]]:
    """Join pairs that share a silhouette into objects."""
    objects: List[set] = []
    for pair in partners:
        own = [members for members in objects if members & set(pair)]
        objects = [members for members in objects if members not in own]
        objects.append(set(pair).union(*own))
    return [tuple(sorted(members)) for members in objects]


def _solved_group(cameras, members, partners):
    """Solve an object of all its cameras; None where one camera sees it twice."""
    if len({camera for camera, _ in members}) < len(members):
        return None
    if len(members) == 2:
        return Group(members, partners[members])
    return Group(members, solve([cameras[camera][number] for camera, number in members]))
