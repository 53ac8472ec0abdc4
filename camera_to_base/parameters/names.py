# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Names of parameters: unknown names, and the old names of renamed parameters."""

import difflib
from typing import Any, Collection, Dict, Iterable, List, Optional, Tuple

from camera_to_base.parameters.spec import ParameterSpec, Values

# Every ROS node has these; a name that ends in a dot is a group.
ROS_NAMES = ('use_sim_time', 'start_type_description_service', 'qos_overrides.')
# With at least this share of equal letters, a name counts as misspelt.
_ALIKE = 0.81


def misspelt_name(name: str, known: Collection[str]) -> Optional[str]:
    """Return the known name with nearly the same spelling; None if there is none."""
    return next(iter(difflib.get_close_matches(name, known, n=1, cutoff=_ALIKE)), None)


def meant_name(name: str, known: Iterable[str]) -> Optional[str]:
    """
    Return the known name that was probably meant by an unknown one; None if there is none.

    The unknown name may be misspelt, the start of a known name (`reach` for `reach_cm`, `surface`
    for `surface.model`), without its group (`threshold` for `detector.threshold`), or with a
    wrong one.
    """
    known = list(known)
    last = _last(name)
    candidates = (
        misspelt_name(name, known),
        next((other for other in known if other.startswith((f'{name}_', f'{name}.'))), None),
        next((other for other in known if _last(other) == last), None),
        next((other for other in known if _last(other).startswith(f'{last}_')), None),
        next((other for other in known if misspelt_name(last, [_last(other)])), None))
    return next(filter(None, candidates), None)


def unknown_name_text(name: str, meant: Optional[str], kind: str = 'parameter') -> str:
    """Return a warning of an unknown name of a parameter, or of something else."""
    hint = f": did you mean '{meant}'?" if meant else ''
    return f"there is no {kind} '{name}', it is left out{hint}"


def unknown_names(given: Iterable[str], known: Collection[str]) -> List[str]:
    """List the given names that are neither known nor those of every ROS node."""
    return sorted(name for name in given
                  if name not in known and not _is_of_ros(name))


def name_warnings(given: Iterable[str], known: Collection[str]) -> List[str]:
    """Warn of each given name that no parameter has, with the name that was meant."""
    return [unknown_name_text(name, meant_name(name, known))
            for name in unknown_names(given, known)]


def all_names(specs: Iterable[ParameterSpec]) -> List[str]:
    """List the parameters' names, and their old names."""
    return [name for spec in specs for name in (spec.name, *spec.old_names)]


def with_new_names(
    specs: Iterable[ParameterSpec], given: Values
) -> Tuple[Dict[str, Any], List[str]]:
    """
    Move the values of renamed parameters to their new names.

    :param given: By full name. If both names are given, the new name's value is used.
    :returns: The values, and a warning for each old name.
    """
    new_names = {old: spec.name for spec in specs for old in spec.old_names}
    renamed = {new_names[name]: value for name, value in given.items() if name in new_names}
    kept = {name: value for name, value in given.items() if name not in new_names}
    return {**renamed, **kept}, [
        f"parameter '{old}' is called '{new_names[old]}' now: rename it, its old name will be "
        'left out in the next release' for old in given if old in new_names]


def _is_of_ros(name: str) -> bool:
    return any(name == own or own.endswith('.') and name.startswith(own) for own in ROS_NAMES)


def _last(name: str) -> str:
    return name.rpartition('.')[2]
