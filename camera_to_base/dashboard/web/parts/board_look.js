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

// The live look at the board: what is found, how sharp it is, and which parts are covered.

import {button, card, element, setAttribute, setText, show, svg, sync} from '../base/dom.js';
import {fixed, sentence as asSentence} from '../base/numbers.js';
import {LivePicture} from '../pieces/pictures.js';
import {board} from '../base/sessions.js';

const ENOUGH_COVER = 0.1;

/** Make the card. */
export function createBoardLook() {
  const picture = new LivePicture('board', 'The live picture with the corners that were found.');
  const verdict = element('p', {class: 'verdict', role: 'status'});
  const cover = createMeter('Board in the picture');
  const total = createMeter('Covered by all placements');
  const sharp = element('p', {class: 'quiet'});
  const suggestion = element('p');
  const take = button('Keep this placement', () => board('take'), {class: 'primary'});
  const fit = button('Fit', () => board('fit'));
  const stop = button('Stop', () => board('cancel'), {
    'aria-label': 'Stop, and drop the placements'});
  const list = element('ol', {class: 'placements', 'aria-label': 'Placements of the board'});
  const tilted = element('ol', {class: 'placements', 'aria-label': 'Pictures of the tilted board'});
  let isTilting = false;
  const tilt = button('', () => board('tilt', {on: !isTilting}));
  const node = card('3. Lay the board on the table', element('div', {class: 'columns'},
    picture.node,
    element('div', {}, verdict, cover.node, total.node, sharp, suggestion,
      element('div', {class: 'buttons'}, take, tilt, fit, stop), list, tilted)));
  show(node, false);
  const update = (state) => {
    const {look, placements, busy, covered} = state;
    show(node, state.step !== 'off');
    const found = look ? asSentence(look.sentence) : 'Waiting for the first picture …';
    setText(verdict, state.accepted ? '' : found);
    verdict.classList.toggle('good', Boolean(look?.found));
    cover.update(look?.found ? look.covered : 0, ENOUGH_COVER);
    total.update(covered?.share ?? 0);
    setText(sharp, look?.sharpness ? `The picture is ${look.sharpness} ` +
      `(an edge is ${fixed(look.sharp_px, 1)} px wide).` : '');
    setText(suggestion, missing(state));
    take.disabled = Boolean(busy) || !look?.found;
    stop.disabled = Boolean(busy);
    fit.disabled = Boolean(busy) || !placements.length;
    isTilting = state.tilting;
    setText(tilt, isTilting ? 'Back to the table' : 'Hold it at a tilt');
    tilt.disabled = Boolean(busy);
    show(tilt, isTilting || placements.length && state.tilted.length < state.wanted_tilted);
    setText(take, isTilting ? 'Take it now' : 'Keep this placement');
    sync(list, placements, ({number}) => number, makePlacement, fillPlacement);
    sync(tilted, state.tilted, ({number}) => number, makeTilted, fillTilted);
    drawCover(picture, state);
  };
  return {node, update, start: () => picture.start(), stop: () => picture.stop()};
}

function missing({suggestion, covered, placements}) {
  if (suggestion) return suggestion.sentence;
  if (!placements.length || !covered?.missing?.length) return '';
  return `Not covered yet: ${covered.missing.join(', ')}.`;
}

function createMeter(name) {
  const bar = element('meter', {min: 0, max: 1, 'aria-label': name});
  const text = element('span');
  const update = (share, low = 0) => {
    bar.low = low;
    bar.value = share;
    setText(text, `${fixed(100 * share, 0)} %`);
  };
  return {update, node: element('p', {class: 'meter'}, element('span', {}, name), bar, text)};
}

function makePlacement({number}) {
  return element('li', {}, element('span'), button('Remove', () => board('remove', {number}), {
    class: 'quiet small', 'aria-label': `Remove placement ${number}`}));
}

function fillPlacement(node, {corners, doubts, error_mm: error}) {
  setText(node.firstChild, [`${corners} corners`, ...(error === null ? [] :
    [`off by ${fixed(error, 2)} mm`]), ...doubts].join('; '));
}

function makeTilted({number}) {
  return element('li', {}, element('span'), button('Remove', () =>
    board('remove', {number, tilted: true}), {
    class: 'quiet small', 'aria-label': `Remove tilted picture ${number}`}));
}

function fillTilted(node, {side, degrees, doubts, error_px: error}) {
  setText(node.firstChild, [`tilted by about ${degrees}°, raised at the ${side}`,
    ...(error === null ? [] : [`off by ${fixed(error, 2)} px`]), ...doubts].join('; '));
}

/** A bar along the side of the picture at which the board is to be raised. */
function tiltGuide(side, {width, height}) {
  const d = {left: `M4 0V${height}`, right: `M${width - 5} 0V${height}`, top: `M0 4H${width}`,
    bottom: `M0 ${height - 5}H${width}`}[side];
  return d ? [['path', {class: 'tilt-side', d}]] : [];
}

function drawCover(picture, {placements, suggestion, tilted, tilting, tilt_side: side}) {
  const shown = [...tilting ? [] : placements, ...tilted];
  const outlines = shown.map(({outline, number, degrees}) => [
    'polygon', {class: degrees === undefined ? 'placement' : 'placement tilted', 'data-number': number,
      points: outline.map(([u, v]) => `${u},${v}`).join(' ')}]);
  const numbers = shown.map(({outline, number, degrees}) => ['text', {
    class: degrees === undefined ? 'place-number' : 'place-number tilted',
    x: mean(outline.map(([u]) => u)), y: mean(outline.map(([, v]) => v)), dy: '0.35em',
    'text-anchor': 'middle', 'font-size': picture.size.width / 16}, String(number)]);
  const target = suggestion?.pixel ? [['circle', {class: 'target', cx: suggestion.pixel[0],
    cy: suggestion.pixel[1], r: picture.size.width * 0.06}]] : [];
  const shapes = [...outlines, ...numbers, ...target, ...tiltGuide(side, picture.size)];
  sync(picture.overlay, shapes, ([tag], index) => `${tag}${index}`, ([tag]) => svg(tag),
    (shape, [, attributes, text]) => {
      Object.entries(attributes).forEach(([name, value]) => setAttribute(shape, name, value));
      if (text) setText(shape, text);
    });
}

function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}
