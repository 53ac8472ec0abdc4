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

// The simulated table: what a person would do by hand at a real one.

import {act} from '../base/actions.js';
import {button, element, setAttribute, setText, show, sync} from '../base/dom.js';
import {attempt} from '../base/notices.js';
import {fixed} from '../base/numbers.js';

const SHOWS = {
  objects: 'Moving objects', still_objects: 'Objects at rest', empty: 'Nothing', board: 'Board'};
const BUMP = {'simulated.camera_shift_px': [6, 4]};
const BACK = {'simulated.camera_shift_px': [0, 0]};

/** Fill the panel; it is shown for the simulated camera only. */
export function createSimulated(store) {
  const panel = document.getElementById('simulated');
  const shows = Object.entries(SHOWS).map(([kind, text]) => [kind, button(text, () => lay(kind))]);
  const placement = element('select', {id: 'placement',
    onchange: () => lay('board', Number(placement.value))});
  const touch = element('div', {class: 'buttons', role: 'group',
    'aria-label': 'Object that the robot touches'});
  const display = element('output', {class: 'display'});
  const lay = (kind, place = Number(placement.value) || 1) => attempt(
    () => act('/api/simulated/show', {shows: kind, placement: place}), () => null);
  const ofBoard = [line('Place of the board', placement, 'placement')];
  const ofRobot = [line('The robot touches', touch), line("The robot's display", display)];
  const isWide = matchMedia('(min-width: 50rem)').matches;
  panel.append(element('details', {open: isWide}, element('summary', {},
    'Simulated table', element('span', {}, ': do here what you would do by hand')),
  element('div', {class: 'lines'},
    line('On the table', element('div', {class: 'buttons', role: 'group', 'aria-label': 'On the table'},
      ...shows.map(([, node]) => node))),
    ...ofBoard, ...ofRobot,
    line('Camera', element('div', {class: 'buttons'},
      button('Bump', () => nudge(BUMP)), button('Put back', () => nudge(BACK)))))));
  const update = () => {
    const {touched, robot} = store.get('simulated') ?? {};
    const tool = touched ? robot ?? store.get('robot')?.tool.position : null;
    setText(display, tool ? `x ${fixed(tool.x, 2)}  y ${fixed(tool.y, 2)} cm` : 'touches nothing');
    for (const node of touch.children) {
      setAttribute(node, 'aria-pressed', node.dataset.key === String(touched));
    }
  };
  store.on('simulated', (state) => {
    show(panel, state.shown);
    for (const [kind, node] of shows) setAttribute(node, 'aria-pressed', kind === state.shows);
    const places = Array.from({length: state.placements ?? 0}, (_, index) => index + 1);
    sync(placement, places, (place) => place, (place) => element('option', {}, String(place)),
      () => {});
    placement.value = state.placement;
    ofBoard.forEach((node) => show(node, state.shows === 'board'));
    ofRobot.forEach((node) => show(node, state.shows === 'still_objects'));
    update();
  });
  store.on('robot', update);
  store.on('watch', ({objects}) => {
    sync(touch, objects, ({number}) => number, ({number}) => button(String(number),
      () => reach(store, number), {'aria-label': `Object ${number}`}), () => {});
    update();
  });
}

function line(name, content, id) {
  return element('div', {class: 'line'},
    id ? element('label', {for: id}, name) : element('span', {}, name), content);
}

function nudge(values) {
  return attempt(() => act('/api/parameters', {node: 'camera', values}), () => null);
}

function reach(store, number) {
  const object = store.get('watch').objects.find((each) => each.number === number);
  if (object) attempt(() => act('/api/simulated/touch', object.camera), () => null);
}

