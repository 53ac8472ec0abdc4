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

// Watch: the live picture, the objects in a list and on a map, and what was left out.

import {card, element, fillRow, row, setAttribute, setText, show, svg, sync, table, button}
  from '../base/dom.js';
import {createCapture} from '../pieces/capture.js';
import {createFused} from '../pieces/fused.js';
import {createGrid} from '../pieces/grid.js';
import {createHeights} from '../pieces/heights.js';
import {createMap} from '../pieces/map.js';
import {ago, fixed, point} from '../base/numbers.js';
import {LivePicture} from '../pieces/pictures.js';
import {createScatter} from '../pieces/scatter.js';
import {createShapes} from '../pieces/shapes.js';

const KINDS = {
  annotated: ['With outlines', 'The live picture, with the outline and the number of each object.'],
  frame: ['Camera', 'The live picture as the camera takes it.'],
  mask: ['Mask', 'The pixels that belong to objects, in white.'],
  background: ['Background', 'The picture of the empty surface that frames are compared with.'],
};
const SAME_OBJECT_CM = 3;
const NEAR_SHARE = 0.08;
const AGE_AFTER_S = 1;
const MOST_PLACES = 3;
const THIRD = 2;
const [BASE_XY, CAMERA_XY] = ['Base frame x, y in cm', 'Camera frame x, y in cm'];

/** Make the part. */
export function createWatch(store) {
  const selection = new Selection();
  const picture = new LivePicture('annotated', KINDS.annotated[1]);
  const map = createMap((object) => selection.choose(object));
  const list = table('Largest first; ± holds 95 % of the errors', [
    'No.', BASE_XY, CAMERA_XY, 'Direction, size in cm', '± mm'], {class: 'numbers'});
  const empty = element('p', {class: 'quiet'}, 'No object.');
  const figures = createFigures();
  const leftOut = createLeftOut();
  const scatter = createScatter();
  const rings = svg('g');
  const grid = createGrid(store, picture);
  const shapes = createShapes(store);
  picture.overlay.append(grid.layer, shapes.layer, rings);
  const own = element('div', {}, element('div', {class: 'choices-row'}, kindChoice(picture), grid.node,
    element('div', {class: 'choices'}, shapes.node)), picture.node,
  element('p', {class: 'quiet'}, 'Click an object to find it in the list and on the map.'));
  const fused = createFused();
  const capture = createCapture(store).node;
  let isShown = false;
  const play = (cameras) => {
    if (isShown && !cameras) picture.start();
    else picture.stop();
    fused.update(isShown ? cameras ?? [] : []);
    for (const node of [own, capture]) show(node, !cameras);
  };

  const draw = () => {
    const watch = store.get('watch');
    if (!watch) return;
    play(watch.cameras);
    setText(list.heads[THIRD], watch.cameras ? 'Height in cm' : CAMERA_XY);
    selection.follow(watch.objects);
    const sizes = new Map((store.get('shapes') ?? []).map((shape) => [shape.number, shape.size_cm]));
    sync(list.body, watch.objects, (object) => object.number,
      (object) => objectRow(object, () => selection.choose(selection.numbered(object.number))),
      (node, object) => fillObject(node, object, selection.is(object), sizes.get(object.number)));
    show(empty, !watch.objects.length);
    show(list.node, watch.objects.length);
    figures.update(store.get('connection') === 'open' ? watch : {objects: watch.objects});
    leftOut.update(watch.left_out ?? [], watch.cameras ? BASE_XY : CAMERA_XY);
    map.update(watch, selection, store.get('shapes') ?? []);
    ring(picture, rings, selection.current);
    scatter.update(watch, selection.current);
  };
  selection.onchange = draw;
  ['connection', 'watch'].forEach((part) => store.on(part, draw));
  // Objects move during a press: where it began counts.
  let pressed = null;
  picture.node.addEventListener('pointerdown', (event) => {
    const watch = store.get('watch');
    pressed = nearest(watch?.objects ?? [], picture.pixelAt(event), picture.size);
  });
  picture.node.addEventListener('click', () => selection.choose(pressed));

  const node = element('div', {class: 'watch'}, element('div', {class: 'columns'},
    element('div', {},
      card('Picture', own, fused.node, figures.node, capture)),
    element('div', {},
      // Above what comes and goes.
      card('Seen from above', map.node),
      card('Objects', list.node, empty, createHeights(store).node, leftOut.node)), scatter.node));
  const turn = (isOn) => {
    isShown = isOn;
    play(store.get('watch')?.cameras);
  };
  return {node, shown: () => turn(true), hidden: () => turn(false)};
}

/** The object that a person has chosen; it is followed by its place, for numbers change. */
class Selection {
  current = null;
  #kept = null;
  #objects = [];
  onchange = () => {};

  choose(object) {
    this.#kept = object && this.same(object) ? null : object;
    this.current = this.#kept;
    this.onchange();
  }

  is(object) {
    return this.current?.number === object.number;
  }

  same(object) {
    return this.#kept && apart(object, this.#kept) < SAME_OBJECT_CM;
  }

  numbered(number) {
    return this.#objects.find((object) => object.number === number) ?? null;
  }

  follow(objects) {
    this.#objects = objects;
    if (!this.#kept) return;
    const near = objects.filter((object) => this.same(object));
    this.current = near.sort((one, other) => apart(one, this.#kept) - apart(other, this.#kept))[0] ?? null;
    // One that is covered for a while is chosen again where it was.
    this.#kept = this.current ?? this.#kept;
  }
}

function apart(one, other) {
  const [from, to] = [one, other].map(({camera, base}) => camera ?? base);
  return Math.hypot(from.x - to.x, from.y - to.y);
}

function nearest(objects, pixel, size) {
  if (!pixel) return null;
  const away = (object) => Math.hypot(object.pixel[0] - pixel.u, object.pixel[1] - pixel.v);
  return objects.filter((object) => object.pixel && away(object) < NEAR_SHARE * size.width)
    .sort((one, other) => away(one) - away(other))[0] ?? null;
}

function ring(picture, layer, object) {
  const marks = object?.pixel ? [object.pixel] : [];
  sync(layer, marks, () => 'ring',
    () => svg('circle', {class: 'chosen', r: picture.size.width * 0.05}),
    (node, [u, v]) => {
      setAttribute(node, 'cx', u);
      setAttribute(node, 'cy', v);
    });
}

function kindChoice(picture) {
  const choices = Object.entries(KINDS).map(([kind, [name, text]]) => button(name, (event) => {
    picture.choose(kind, text);
    for (const each of choices) each.setAttribute('aria-pressed', each === event.currentTarget);
  }, {'aria-pressed': kind === 'annotated'}));
  return element('div', {class: 'choices', role: 'group', 'aria-label': 'Kind of picture'},
    ...choices);
}

function objectRow({number}, choose) {
  const node = row(5, {class: 'pickable'});
  node.addEventListener('click', choose);
  node.cells[0].append(button(String(number), () => {}, {class: 'number'}));
  node.cells[3].append(element('span'), element('small', {class: 'quiet'}));
  return node;
}

function fillObject(node, object, isChosen, size) {
  const label = node.cells[0].firstChild;
  setAttribute(label, 'aria-pressed', isChosen);
  setAttribute(label, 'aria-label', `Object ${object.number}: show it in the picture`);
  const yaw = (object.base ?? object.camera).yaw_deg;
  const [, base, camera, turned, uncertain] = node.cells;
  setText(base, point(object.base));
  // A fused cell has no camera frame, and measures heights.
  setText(camera, object.camera ? point(object.camera) : fixed(size?.at(-1), 2));
  setText(turned.firstChild, yaw === null || yaw === undefined ? 'none' : `${fixed(yaw, 0)}°`);
  // Sizes come later than places: their line is kept free, so that the map below stays where it is.
  setText(turned.lastChild, size ? size.filter(Boolean).map((side) => fixed(side, 1)).join(' × ') : '\u00a0');
  setText(uncertain, object.ellipse ? fixed(object.ellipse.major_mm, 1) : '–');
}

const TOO = {low: ['low', 'Objects that move are published late: use a faster camera or a smaller picture, or end ' +
  'other programs.'], high: ['high', 'Positions come late: an object that moves is elsewhere by then. End other ' +
  'programs, or use a smaller picture.']};

function createFigures() {
  const node = element('dl', {class: 'figures'});
  const update = ({rate_hz: rate, age_s: age, latency_ms: latency, objects, pace}) => {
    const items = [['Objects', String(objects.length)],
      ['Rate', rate ? `${fixed(rate, 1)} Hz` : '–', TOO[pace?.rate]],
      ['Latency', latency ? `${fixed(latency, 0)} ms` : '–', TOO[pace?.latency]],
      ['Last frame', age === undefined ? '–' : age !== null && age < AGE_AFTER_S ? 'now' : ago(age)]];
    sync(node, items, ([name]) => name,
      ([name]) => element('div', {}, element('dt', {}, name), element('dd')),
      (item, [, text, [word, cure] = []]) => {
        setText(item.lastChild, word ? `${text}, ${word}` : text);
        setAttribute(item, 'class', word ? 'bad' : null);
        setAttribute(item, 'title', cure ?? null);
      });
  };
  return {node, update};
}

function createLeftOut() {
  const list = table('Left out', ['Why', CAMERA_XY], {class: 'grey'});
  show(list.node, false);
  const update = (items, place) => {
    show(list.node, items.length);
    setText(list.heads[1], place);
    // Shade, for one, is left out at many places for the same reason.
    const groups = new Map(items.map(({sentence}) => [sentence, []]));
    items.forEach((item) => groups.get(item.sentence).push(item));
    sync(list.body, [...groups], ([sentence]) => sentence, () => row(2),
      (node, [sentence, found]) => fillRow(node, [
        found.length > 1 ? `${found.length} places: ${sentence}` : sentence,
        found.slice(0, MOST_PLACES).map((one) => point(one, 1)).join('; ') +
          (found.length > MOST_PLACES ? '; …' : '')]));
  };
  return {node: list.node, update};
}
