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

// Robot: pairs of what the camera sees and what the robot touches tell where the base frame is.

import {button, card, createUndo, element, setText, show, sync} from '../base/dom.js';
import {createPairs} from './pairs.js';
import {createChoice, markPlaces} from '../pieces/choice.js';
import {createFit} from './robot_fit.js';
import {sentence as asSentence} from '../base/numbers.js';
import {robot} from '../base/sessions.js';
import {createTouch} from './touch.js';

/** Make the part. */
export function createRobot(store) {
  const hint = element('p', {class: 'hint', role: 'status'});
  const start = button('Start', () => robot('start'), {class: 'primary'});
  const begin = element('div', {}, element('p', {class: 'lead'}, 'Put an object down, click it, ' +
    'and touch it with the robot. Five places that are far apart tell where the camera frame ' +
    'lies in the base frame.'), card('Start', start));
  const undo = createUndo(() => robot('undo'));
  const see = createSee(store);
  const touch = createTouch(robot, {id: 'touch', label: "x and y on the robot's display", add: 'Add the pair'});
  const pairs = createPairs();
  const fit = createFit();
  const work = element('div', {}, element('div', {class: 'columns'}, see.node, touch.node),
    pairs.node);
  let isShown = false;
  const follow = () => {
    if (isShown && store.get('robot')?.step === 'measuring') see.start();
    else see.stop();
  };
  store.on('robot', (state) => {
    const isMeasuring = state.step === 'measuring';
    setText(hint, asSentence(state.error) ?? state.needs ?? state.hint ?? '');
    hint.classList.toggle('error', Boolean(state.error ?? state.needs));
    show(begin, !isMeasuring);
    start.disabled = Boolean(state.needs);
    show(work, isMeasuring || state.pairs.length);
    [see, touch, pairs, fit, undo].forEach((each) => each.update(state));
    follow();
  });
  const node = element('div', {class: 'robot'},
    begin, hint, undo.node, work, fit.node);
  return {
    node,
    shown: () => { isShown = true; follow(); },
    hidden: () => { isShown = false; follow(); },
  };
}

function createSee(store) {
  const {picture, buttons} = createChoice(store, (pixel) => robot('see', pixel));
  const markers = element('div', {class: 'buttons', role: 'group',
    'aria-label': 'Markers on the table'});
  const suggestion = element('p');
  const orMarkers = element('p', {class: 'quiet'},
    'In place of an object, the robot can touch the middle of a learned marker:');
  const update = (state) => {
    const isDone = state.open || state.accepted;
    setText(suggestion, isDone ? '' : state.suggestion?.sentence ?? '');
    show(orMarkers, state.markers.length);
    sync(markers, state.markers, (number) => number, (number) => button(`Marker ${number}`,
      () => robot('marker', {number})), () => {});
    markPairs(picture, state);
  };
  return {update, start: () => picture.start(), stop: () => picture.stop(),
    node: card('1. Choose the object', picture.node, suggestion,
      element('p', {class: 'quiet'}, 'Click the object that the robot will touch, or choose it here.'),
      buttons, orMarkers, markers)};
}

function markPairs(picture, {pairs, suggestion, open, accepted}) {
  markPlaces(picture, [
    ...pairs.filter(({pixel}) => pixel).map((pair) => ({...pair, name: pair.valid && pair.fits ? 'pair' : 'pair bad'})),
    ...(suggestion?.pixel && !open && !accepted ? [{number: 'next', pixel: suggestion.pixel, name: 'target'}] : []),
    ...(open?.pixel ? [{number: 'open', pixel: open.pixel, name: 'chosen'}] : []),
  ]);
}
