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

// The way to a calibrated cell, as a list of steps; it disappears when all are done.

import {button, element, setAttribute, setText, show, sync} from '../base/dom.js';
import {lacksBackground} from '../base/reasons.js';

const KEPT_AS = 'setup-closed';

/** Make the list. */
export function createSetup(store) {
  const list = element('ol', {class: 'steps'});
  const node = element('section', {class: 'card setup', 'aria-labelledby': 'setup-title'},
    element('h3', {id: 'setup-title'}, 'Set up this cell'),
    button('Hide this list', () => {
      sessionStorage.setItem(KEPT_AS, 'yes');
      update();
    }, {class: 'quiet small'}), list);
  const update = () => {
    const steps = stepsOf(store);
    const next = steps.findIndex((step) => !step.isDone);
    show(node, next >= 0 && !sessionStorage.getItem(KEPT_AS));
    sync(list, steps, (step) => step.name, makeStep,
      (item, step, index) => fillStep(item, step, index === next));
  };
  ['watch', 'parameters', 'save', 'cells'].forEach((part) => store.on(part, update));
  return {node};
}

function makeStep({part, name}) {
  return element('li', {}, element('a', {href: `#${part}`}, name), element('span', {class: 'state'}));
}

function fillStep(item, step, isNext) {
  setAttribute(item, 'class', step.isDone ? 'done' : isNext ? 'next' : 'later');
  setText(item.lastChild, step.isDone ? 'done' : isNext ? step.todo : '');
}

function stepsOf(store) {
  const watch = store.get('watch');
  const save = store.get('save');
  const surface = value(store, 'camera', 'calibration.surface');
  const base = value(store, 'transform', 'calibration.base');
  return [
    {part: 'health', name: 'Camera', isDone: Boolean(watch?.image?.width),
      todo: 'no picture yet: look at Health'},
    {part: 'calibrate', name: 'Surface', isDone: Boolean(surface),
      todo: 'lay a printed board on the table'},
    {part: 'detect', name: 'Background',
      isDone: Boolean(watch) && !lacksBackground(watch.state.reason),
      todo: 'clear the table, and take the background'},
    {part: 'robot', name: 'Robot', isDone: Boolean(base),
      todo: 'touch five objects with the robot'},
    {part: 'save', name: 'Save',
      isDone: Boolean(surface && base && save?.path) && !save.changes?.length,
      todo: 'keep everything for the next start'},
  ];
}

function value(store, node, name) {
  return store.get('parameters')?.[node]?.find((each) => each.name === name)?.value;
}
