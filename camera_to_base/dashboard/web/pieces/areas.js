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

// Draws the work area and ignored areas on a picture, by clicks or by the keyboard.

import {act} from '../base/actions.js';
import {button, card, createUndo, element, setAttribute, setText, show, svg, sync} from '../base/dom.js';
import {attempt} from '../base/notices.js';

const MOVES = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
const STEP_PX = 10;
const KEYS = 'Arrow keys move the cross (with Shift by 1 px), Enter adds a corner, Backspace ' +
  'takes the last one away, F finishes, Escape cancels.';
const NAMES = {work_area: 'the work area', ignored_areas: 'an area to ignore'};

/** Make the card; the polygons appear on the picture. */
export function createAreas(store, picture) {
  const pen = new Pen(picture, (kind, corners) => save(store, kind, corners));
  const list = element('ul', {class: 'areas'});
  let removed = null;
  const undoButton = createUndo(() => attempt(() => act('/api/areas', removed), () => null)
    .then((answer) => answer && undoButton.update({undo: null})));
  const undo = {node: undoButton.node, update: ({undo: sentence, before}) => {
    removed = before;
    undoButton.update({undo: sentence});
  }};
  const needs = element('p', {class: 'quiet'});
  const choices = element('div', {class: 'buttons'},
    button('Draw the work area', () => pen.begin('work_area')),
    button('Draw an area to ignore', () => pen.begin('ignored_areas')));
  pen.onchange = () => {
    show(choices, !pen.kind);
    drawAreas(picture, store.get('areas'), pen);
  };
  store.on('areas', (areas) => {
    setText(needs, areas.needs ?? '');
    for (const each of choices.children) each.disabled = Boolean(areas.needs);
    sync(list, entries(areas), (entry) => entry.name,
      (entry) => element('li', {}, element('span'), button('Remove', () => {
        const before = asBody(store.get('areas'));
        attempt(() => act('/api/areas', entry.without()), () => null).then((answer) => {
          if (answer) undo.update({undo: `${entry.name} removed`, before});
        });
      }, {class: 'quiet small', 'aria-label': `Remove ${entry.name}`})),
      (node, entry) => setText(node.firstChild, `${entry.name}, ${entry.count} corners`));
    pen.onchange();
  });
  const node = card('Areas', element('p', {},
    'Objects count only inside the work area, and not in the areas to ignore. The areas lie on ' +
    'the surface: they stay right when the camera is calibrated again.'),
  needs, choices, list, undo.node);
  picture.node.before(pen.node);
  picture.node.after(pen.help);
  return {node};
}

/** Return the body that sets all areas as they are. */
function asBody({work_area: work, ignored_areas: ignored}) {
  return {work_area: work?.px ?? null, ignored_areas: (ignored ?? []).map(({px}) => px)};
}

function entries(areas) {
  const ignored = areas.ignored_areas ?? [];
  return [
    ...(areas.work_area ? [{name: 'work area', count: areas.work_area.px.length,
      without: () => ({work_area: null})}] : []),
    ...ignored.map((area, index) => ({name: `ignored area ${index + 1}`, count: area.px.length,
      without: () => ({ignored_areas: ignored.filter((each) => each !== area)
        .map(({px}) => px)})})),
  ];
}

function save(store, kind, corners) {
  const old = (store.get('areas')?.ignored_areas ?? []).map(({px}) => px);
  const body = kind === 'work_area' ? {work_area: corners} : {ignored_areas: [...old, corners]};
  return attempt(() => act('/api/areas', body), () => 'The area is in use now.');
}

function drawAreas(picture, areas, pen) {
  const shapes = [
    ...(areas?.work_area ? [['work-area', areas.work_area.px]] : []),
    ...(areas?.ignored_areas ?? []).map(({px}) => ['ignored-area', px]),
    ...(pen.kind ? [[`pen ${pen.kind}`, pen.corners]] : []),
  ];
  const nodes = shapes.map(([name, corners]) => svg('polygon', {
    class: name, points: corners.map(([u, v]) => `${u},${v}`).join(' ')}));
  if (pen.kind) {
    const size = picture.size.width / 100;
    nodes.push(...pen.corners.map(([u, v]) => svg('circle', {class: 'corner', cx: u, cy: v, r: size})));
    const [u, v] = pen.cross;
    nodes.push(svg('path', {class: 'cross',
      d: `M${u - 3 * size} ${v}h${6 * size}M${u} ${v - 3 * size}v${6 * size}`}));
  }
  picture.overlay.replaceChildren(...nodes);
}

/** Collects corners; `kind` is null while nothing is drawn. */
class Pen {
  kind = null;
  corners = [];
  cross = [0, 0];
  onchange = () => {};
  #picture;
  #finish;

  constructor(picture, finish) {
    this.#picture = picture;
    this.#finish = finish;
    this.said = element('p', {role: 'status'});
    this.done = button('Finish', () => this.end(), {class: 'primary'});
    this.node = element('div', {class: 'pen', hidden: true}, this.said,
      element('div', {class: 'buttons'}, this.done,
        button('Undo', () => this.#undo()), button('Cancel', () => this.#close())));
    this.help = element('p', {class: 'quiet', hidden: true}, KEYS);
    picture.node.addEventListener('click', (event) => this.#onClick(event));
    picture.node.addEventListener('keydown', (event) => this.#onKey(event));
  }

  begin(kind) {
    this.kind = kind;
    this.corners = [];
    const {width, height} = this.#picture.size;
    this.cross = [Math.round(width / 2), Math.round(height / 2)];
    for (const [name, value] of [['tabindex', 0], ['role', 'application'],
      ['aria-label', `Drawing ${NAMES[kind]}. ${KEYS}`]]) {
      setAttribute(this.#picture.node, name, value);
    }
    show(this.node, true);
    show(this.help, true);
    this.#picture.node.focus({preventScroll: true});
    this.node.scrollIntoView({block: 'nearest'});
    this.#changed(`Click the corners of ${NAMES[kind]} on the picture, one after the other.`);
  }

  async end() {
    if (this.corners.length < 3) {
      this.#changed('An area needs three corners at least.');
    } else if (await this.#finish(this.kind, this.corners)) {
      this.#close();
    }
  }

  #close() {
    this.kind = null;
    for (const name of ['tabindex', 'role', 'aria-label']) {
      setAttribute(this.#picture.node, name, null);
    }
    show(this.node, false);
    show(this.help, false);
    this.onchange();
  }

  #add() {
    this.corners.push([...this.cross]);
    this.#changed(`Corner ${this.corners.length} at pixel ${this.cross.map(Math.round).join(', ')}.`);
  }

  #undo() {
    this.corners.pop();
    this.#changed(`${this.corners.length} corners.`);
  }

  #changed(sentence) {
    setText(this.said, sentence);
    this.done.disabled = this.corners.length < 3;
    this.onchange();
  }

  #onClick(event) {
    const pixel = this.#picture.pixelAt(event);
    if (!this.kind || !pixel) return;
    this.cross = [Math.round(10 * pixel.u) / 10, Math.round(10 * pixel.v) / 10];
    this.#add();
  }

  #onKey(event) {
    if (!this.kind || event.target !== this.#picture.node) return;
    const keys = {Enter: () => this.#add(), ' ': () => this.#add(), Escape: () => this.#close(),
      Backspace: () => this.#undo(), f: () => this.end(), F: () => this.end()};
    const action = MOVES[event.key] ? () => this.#move(event) : keys[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  #move({key, shiftKey}) {
    const step = shiftKey ? 1 : STEP_PX;
    const {width, height} = this.#picture.size;
    const within = (value, end) => Math.min(Math.max(value, 0), end - 1);
    this.cross = [within(this.cross[0] + step * MOVES[key][0], width),
      within(this.cross[1] + step * MOVES[key][1], height)];
    this.#changed(`Cross at pixel ${this.cross.map(Math.round).join(', ')}.`);
  }
}
