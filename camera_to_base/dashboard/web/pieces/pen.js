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

// Draws one polygon on a picture, or changes it: by pointer, by touch or by the keyboard.

import {button, element, setAttribute, setText, show, svg} from '../base/dom.js';

const MOVES = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
const STEP_PX = 10;
// How near a press must be to a corner, in px of the screen; a finger is wider than a pointer.
const NEAR_PX = 14;
const FEWEST = 3;
const DRAWING = 'Arrow keys move the cross (with Shift by 1 px), Enter adds a corner, Backspace ' +
  'undoes, F finishes, Escape cancels.';
const CHANGING = 'Drag a corner; drag the middle of a side for a new one. N chooses the next corner, ' +
  'the arrow keys move it (with Shift by 1 px), Enter adds one behind it, Delete removes it, ' +
  'Backspace undoes, F finishes, Escape cancels.';

/** Collects corners, each {pixel, place}: a place in cm is exact until its corner is moved. */
export class Pen {
  kind = null;
  onchange = () => {};
  #picture;
  #finish;
  #name = '';
  #corners = [];
  #former = [];
  #chosen = null;
  #cross = [0, 0];
  #isNew = true;
  #dragged = null;

  constructor(picture) {
    this.#picture = picture;
    this.said = element('p', {role: 'status'});
    this.done = button('Finish', () => this.end(), {class: 'primary'});
    this.undo = button('Undo', () => this.#undo());
    this.drop = button('Delete this corner', () => this.#delete());
    this.node = element('div', {class: 'pen', hidden: true}, this.said,
      element('div', {class: 'buttons'}, this.done, this.undo, this.drop,
        button('Cancel', () => this.#close())));
    this.help = element('p', {class: 'quiet', hidden: true});
    const {node} = picture;
    node.addEventListener('pointerdown', (event) => this.#onPress(event));
    node.addEventListener('pointermove', (event) => this.#onMove(event));
    node.addEventListener('pointerup', () => { this.#dragged = null; });
    node.addEventListener('pointercancel', () => { this.#dragged = null; });
    node.addEventListener('keydown', (event) => this.#onKey(event));
  }

  /** Begin; `finish(corners)` gets what the server takes, and answers null where it is refused. */
  begin(name, kind, corners, finish) {
    this.#name = name;
    this.kind = kind;
    this.#corners = corners;
    this.#finish = finish;
    this.#former = [];
    this.#isNew = !corners.length;
    this.#chosen = this.#isNew ? null : corners.findIndex(({pixel}) => pixel);
    const {width, height} = this.#picture.size;
    this.#cross = [Math.round(width / 2), Math.round(height / 2)];
    const keys = this.#isNew ? DRAWING : CHANGING;
    for (const [key, value] of [['tabindex', 0], ['role', 'application'],
      ['aria-label', `Drawing ${name}. ${keys}`]]) setAttribute(this.#picture.node, key, value);
    setText(this.help, keys);
    show(this.node, true);
    show(this.help, true);
    this.#picture.node.focus({preventScroll: true});
    this.node.scrollIntoView({block: 'nearest'});
    this.#tell(this.#isNew ? `Click the corners of ${name} on the picture, one after the other.`
      : `Drag the corners of ${name}; the middle of a side makes a new one.`);
  }

  async end() {
    if (this.#corners.length < FEWEST) this.#tell('An area needs three corners at least.');
    else if (await this.#finish(this.#corners.map(({pixel, place}) => place ?? pixel))) this.#close();
  }

  /** Return what is drawn: the polygon, its corners, and the middles of its sides. */
  shapes() {
    if (!this.kind) return [];
    const size = this.#picture.size.width / 100;
    const pixels = this.#corners.map(({pixel}) => pixel).filter(Boolean);
    const [u, v] = this.#cross;
    return [
      svg('polygon', {class: `pen ${this.kind}`, points: pixels.map((one) => one.join(',')).join(' ')}),
      ...this.#middles().map(({pixel: [x, y]}) => svg('circle', {class: 'middle', cx: x, cy: y, r: 0.7 * size})),
      ...this.#corners.flatMap(({pixel}, index) => pixel ? [svg('circle', {
        class: index === this.#chosen ? 'corner chosen-corner' : 'corner', cx: pixel[0], cy: pixel[1],
        r: index === this.#chosen ? 1.4 * size : size})] : []),
      ...(this.#isNew ? [svg('path', {class: 'cross',
        d: `M${u - 3 * size} ${v}h${6 * size}M${u} ${v - 3 * size}v${6 * size}`})] : []),
    ];
  }

  #middles() {
    if (this.#corners.length < FEWEST) return [];
    return this.#corners.flatMap(({pixel}, index) => {
      const next = this.#corners[(index + 1) % this.#corners.length].pixel;
      return pixel && next ? [{index, pixel: [(pixel[0] + next[0]) / 2, (pixel[1] + next[1]) / 2]}] : [];
    });
  }

  #close() {
    this.kind = this.#dragged = null;
    for (const name of ['tabindex', 'role', 'aria-label']) setAttribute(this.#picture.node, name, null);
    show(this.node, false);
    show(this.help, false);
    this.onchange();
  }

  #tell(sentence) {
    setText(this.said, sentence);
    this.done.disabled = this.#corners.length < FEWEST;
    this.undo.disabled = !this.#former.length;
    show(this.drop, this.#chosen !== null);
    this.drop.disabled = this.#corners.length <= FEWEST && !this.#isNew;
    this.onchange();
  }

  /** Change the corners so that it can be undone. */
  #change(corners, chosen, sentence) {
    this.#former.push([this.#corners, this.#chosen]);
    this.#corners = corners;
    this.#chosen = chosen;
    this.#tell(sentence);
  }

  #add(pixel) {
    this.#change([...this.#corners, {pixel}], null,
      `Corner ${this.#corners.length + 1} at pixel ${pixel.map(Math.round).join(', ')}.`);
  }

  #insert({index, pixel}) {
    this.#change(this.#corners.toSpliced(index + 1, 0, {pixel}), index + 1,
      `Corner ${index + 2} is new.`);
  }

  #put(index, pixel) {
    this.#corners = this.#corners.with(index, {pixel});
    this.#tell(`Corner ${index + 1} at pixel ${pixel.map(Math.round).join(', ')}.`);
  }

  #delete() {
    if (this.#chosen === null || this.drop.disabled) return;
    const left = this.#corners.toSpliced(this.#chosen, 1);
    this.#change(left, left.length ? this.#chosen % left.length : null, `${left.length} corners are left.`);
  }

  #undo() {
    if (!this.#former.length) return;
    [this.#corners, this.#chosen] = this.#former.pop();
    this.#tell(`${this.#corners.length} corners.`);
  }

  #onPress(event) {
    const pixel = this.kind && this.#picture.pixelAt(event);
    if (!pixel) return;
    event.preventDefault();
    this.#picture.node.focus({preventScroll: true});
    const at = [Math.round(10 * pixel.u) / 10, Math.round(10 * pixel.v) / 10];
    const corner = this.#near(at, this.#corners.map((one, index) => ({...one, index})));
    const middle = corner ? null : this.#near(at, this.#middles());
    if (corner && this.#isNew && corner.index === 0 && this.#corners.length >= FEWEST) {
      this.end();
      return;
    }
    if (corner) this.#change(this.#corners, corner.index, `Corner ${corner.index + 1} is chosen.`);
    else if (middle) this.#insert(middle);
    else if (this.#isNew) {
      this.#cross = at;
      this.#add(at);
      return;
    } else return;
    this.#dragged = this.#chosen;
    this.#picture.node.setPointerCapture(event.pointerId);
  }

  #onMove(event) {
    const pixel = this.#dragged !== null && this.#picture.pixelAt(event);
    if (pixel) this.#put(this.#dragged, [Math.round(10 * pixel.u) / 10, Math.round(10 * pixel.v) / 10]);
  }

  /** Return the nearest of some corners, or null where none is near. */
  #near([u, v], corners) {
    const reach = NEAR_PX * this.#picture.size.width / this.#picture.node.clientWidth;
    const away = ({pixel}) => Math.hypot(pixel[0] - u, pixel[1] - v);
    return corners.filter((one) => one.pixel && away(one) <= reach)
      .sort((one, other) => away(one) - away(other))[0] ?? null;
  }

  #onKey(event) {
    if (!this.kind || event.target !== this.#picture.node) return;
    const keys = {Enter: () => this.#enter(), ' ': () => this.#enter(), Escape: () => this.#close(),
      Backspace: () => this.#undo(), Delete: () => this.#delete(), f: () => this.end(),
      n: () => this.#next()};
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = MOVES[event.key] ? () => this.#step(event) : keys[key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  #enter() {
    if (this.#isNew && this.#chosen === null) this.#add([...this.#cross]);
    else this.#insert(this.#middles().find(({index}) => index === this.#chosen) ?? this.#middles()[0]);
  }

  #next() {
    if (!this.#corners.length) return;
    this.#chosen = this.#chosen === null ? 0 : (this.#chosen + 1) % this.#corners.length;
    this.#tell(`Corner ${this.#chosen + 1} of ${this.#corners.length} is chosen.`);
  }

  #step({key, shiftKey}) {
    const step = shiftKey ? 1 : STEP_PX;
    const {width, height} = this.#picture.size;
    const within = (value, end) => Math.min(Math.max(value, 0), end - 1);
    const from = this.#chosen === null ? this.#cross : this.#corners[this.#chosen].pixel ?? this.#cross;
    const to = [within(from[0] + step * MOVES[key][0], width), within(from[1] + step * MOVES[key][1], height)];
    if (this.#chosen !== null) {
      this.#change(this.#corners, this.#chosen, '');
      this.#put(this.#chosen, to);
      return;
    }
    this.#cross = to;
    this.#tell(`Cross at pixel ${to.map(Math.round).join(', ')}.`);
  }
}
