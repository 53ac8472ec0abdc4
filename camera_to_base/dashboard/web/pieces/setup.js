// Copyright 2026 The camera_to_base authors
//
// Licensed under the Apache License, Version 2.0 (the "License");
// you may not use this file except in compliance with the License.
// You may obtain a copy of the License at
//
//     http://www.apache.org/licenses/LICENSE-2.0
//
// Unless required by applicable law or agreed to in writing, software
// distributed under the License is distributed on an "AS IS" BASIS,
// WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
// See the License for the specific language governing permissions and
// limitations under the License.

// The way to a calibrated cell, as one list of steps above the parts; it goes when all are done.

import {button, element, setAttribute, setText, show, sync} from '../base/dom.js';
import {lacksBackground, lacksCamera} from '../base/reasons.js';

const KEPT_AS = 'setup-closed';
// Where the list is shown even if all but the proof is done; elsewhere it goes then.
const OF_SETUP = ['calibrate', 'robot', 'prove', 'save'];
const WITHOUT = ['health'];

/** Make the list. */
export function createSetup(store) {
  const list = element('ol', {class: 'steps'});
  const node = element('section', {class: 'setup', 'aria-label': 'Set up this cell'}, list,
    button('Hide', () => {
      sessionStorage.setItem(KEPT_AS, 'yes');
      update();
    }, {class: 'quiet small', 'aria-label': 'Hide this list'}));
  document.getElementById('setup').append(node);
  let before = null;
  const update = () => {
    const steps = stepsOf(store);
    const part = location.hash.slice(1) || 'watch';
    const next = steps.findIndex((step) => !step.isDone);
    const isOpen = OF_SETUP.includes(part) ? next >= 0 : next >= 0 && steps[next].part !== 'prove';
    show(node, isOpen && !store.get('watch')?.cameras && !WITHOUT.includes(part) && !sessionStorage.getItem(KEPT_AS));
    sync(list, steps, (step) => step.name, makeStep,
      (item, step, index) => fillStep(item, step, index === next, step.part === part));
    // On a small screen the list is one line that scrolls.
    const here = list.querySelector('[aria-current]') ?? list.children[Math.max(next, 0)];
    if (here !== before && list.scrollWidth > list.clientWidth) list.scrollLeft = here.offsetLeft - list.offsetLeft - 40;
    before = here;
  };
  ['watch', 'parameters', 'save', 'cells', 'board', 'robot', 'prove'].forEach((part) =>
    store.on(part, update));
  addEventListener('hashchange', update);
}

function makeStep({part, name}) {
  return element('li', {}, element('a', {href: `#${part}`}, name), element('span', {class: 'state'}));
}

function fillStep(item, step, isNext, isHere) {
  setAttribute(item, 'class', step.isDone ? 'done' : isNext ? 'next' : 'later');
  setAttribute(item.firstChild, 'aria-current', isHere ? 'step' : null);
  setText(item.lastChild, step.isDone ? 'done' : step.state ?? (isNext ? step.todo : ''));
}

function stepsOf(store) {
  const watch = store.get('watch');
  const save = store.get('save');
  const surface = value(store, 'camera', 'calibration.surface');
  const base = value(store, 'transform', 'calibration.base');
  return [
    {part: 'health', name: 'Camera', isDone: Boolean(watch?.image?.width) && !lacksCamera(watch.state.reason),
      todo: 'no picture yet: look at Health'},
    ...surfaceSteps(store.get('board'), Boolean(surface)),
    {part: 'detect', name: 'Background',
      isDone: Boolean(watch) && !lacksBackground(watch.state.reason),
      todo: 'clear the table, and take the background'},
    {part: 'robot', name: 'Robot', ...robotStep(store.get('robot'), Boolean(base))},
    {part: 'save', name: 'Save',
      isDone: Boolean(surface && base && save?.path) && !save.changes?.length,
      todo: 'keep everything for the next start'},
    {part: 'prove', name: 'Prove', isDone: store.get('prove')?.good === true,
      todo: 'touch an object at a new place'},
  ];
}

/** The board on the table, and at a tilt: without the latter, the lens and the height lack. */
function surfaceSteps(board, isKnown) {
  const isOn = board && board.step !== 'off' && !board.accepted;
  const count = isOn && `${board.placements.length} of ${board.wanted} places`;
  const flat = isOn ? board.report ? 'check the report' : count : undefined;
  const steps = [{part: 'calibrate', name: 'Surface', isDone: isKnown && !isOn, state: flat,
    todo: 'lay a printed board on the table'}];
  if (isOn && board.placements.length) {
    steps.push({part: 'calibrate', name: 'Tilted board', isDone: false,
      state: `${board.tilted.length} of ${board.wanted_tilted}`});
  }
  return steps;
}

function robotStep(robot, isKnown) {
  const isOn = robot?.step === 'measuring' && !robot.accepted;
  return {isDone: isKnown && !isOn, todo: 'touch five objects with the robot',
    state: isOn ? `${robot.pairs.length} of 5 pairs` : undefined};
}

function value(store, node, name) {
  return store.get('parameters')?.[node]?.find((each) => each.name === name)?.value;
}
