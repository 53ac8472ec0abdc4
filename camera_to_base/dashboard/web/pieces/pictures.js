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

// A live picture: the server sends the newest one whenever the last one was shown.

import {button, element, setAttribute, setText, show, svg} from '../base/dom.js';
import {ago} from '../base/numbers.js';
import {chosenCell, socket} from '../base/state.js';

const LEAST_GAP_MS = 70;
const RETRY_MS = 1500;
const OLD_AFTER_MS = 3000;
const LATE_MS = 1000;

/** A picture with a layer for drawing above it, in the pixels of the camera. */
export class LivePicture {
  /** Called when the size of the picture has changed. */
  onsize = () => {};
  #image = element('img', {draggable: 'false'});
  #waiting = element('p', {class: 'waiting'});
  #line = null;
  #isWanted = false;
  #kind;
  #cell;
  #sentSize = null;
  #age = null;
  #old = element('p', {class: 'age', hidden: true});
  #shownAt = 0;
  #timer = null;

  /** `kind` is what the server sends; `text` says what can be seen; `cell` is the chosen one if it is not given. */
  constructor(kind, text, cell = chosenCell()) {
    this.#cell = cell;
    this.overlay = svg('svg', {preserveAspectRatio: 'xMidYMid meet', 'aria-hidden': 'true'});
    this.node = element('div', {class: 'picture empty'}, this.#image, this.overlay, this.#waiting,
      this.#old, this.#fullScreen());
    this.size = {width: 640, height: 480};
    this.#image.onload = () => this.#onShown();
    this.#image.onerror = () => this.#askNext();
    this.choose(kind, text);
    setText(this.#waiting, 'Waiting for a picture …');
  }

  /** Show another kind of picture. */
  choose(kind, text) {
    this.#kind = kind;
    this.#image.alt = text;
    if (this.#line) {
      this.stop();
      this.start();
    }
  }

  /** Begin to ask for pictures. */
  start() {
    if (this.#isWanted) return;
    this.#isWanted = true;
    this.#open();
  }

  /** Ask for no more; the last picture stays. */
  stop() {
    this.#isWanted = false;
    clearTimeout(this.#timer);
    this.#line?.close();
    this.#line = null;
  }

  /** Return the pixel of a pointer's event, or null where it is beside the picture. */
  pixelAt(event) {
    const box = this.#image.getBoundingClientRect();
    // On a full screen, the picture has bars beside it.
    const {width, height} = this.size;
    const scale = Math.min(box.width / width, box.height / height);
    const u = (event.clientX - box.left - (box.width - scale * width) / 2) / scale - 0.5;
    const v = (event.clientY - box.top - (box.height - scale * height) / 2) / scale - 0.5;
    const isInside = u >= -0.5 && v >= -0.5 && u < width && v < height;
    return isInside ? {u, v} : null;
  }

  #fullScreen() {
    const change = (event) => {
      event.stopPropagation();
      if (document.fullscreenElement) document.exitFullscreen();
      else this.node.requestFullscreen();
    };
    const icon = svg('svg', {viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true'},
      svg('path', {d: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5'}));
    return button(icon, change, {class: 'full-screen', 'aria-label': 'Full screen', title: 'Full screen',
      hidden: !document.fullscreenEnabled, onpointerdown: (event) => event.stopPropagation()});
  }

  #open() {
    if (!this.#isWanted) return;
    const line = socket('/ws/picture', {cell: this.#cell, kind: this.#kind, adapts: 'yes'});
    this.#line = line;
    line.binaryType = 'blob';
    line.onopen = () => line.send('next');
    line.onmessage = ({data}) => this.#onMessage(line, data);
    line.onclose = () => {
      if (this.#line !== line) return;
      this.node.classList.add('old');
      setTimeout(() => this.#line === line && this.#open(), RETRY_MS);
    };
  }

  #onMessage(line, data) {
    if (this.#line !== line) return;
    if (typeof data === 'string') {
      const content = JSON.parse(data);
      this.#sentSize = content.width ? content : null;
      this.#age = content.age_ms;
      return;
    }
    const old = this.#image.src;
    this.#image.src = URL.createObjectURL(data);
    if (old) URL.revokeObjectURL(old);
  }

  #onShown() {
    const before = this.size;
    this.size = this.#sentSize ?? {
      width: this.#image.naturalWidth, height: this.#image.naturalHeight};
    if (before.width !== this.size.width || before.height !== this.size.height) this.onsize();
    setAttribute(this.overlay, 'viewBox', `-0.5 -0.5 ${this.size.width} ${this.size.height}`);
    this.node.classList.remove('empty');
    show(this.#waiting, false);
    this.#shownAt = performance.now();
    this.#tellAge();
    this.#askNext();
  }

  /** It grows older while no other one comes. */
  #tellAge() {
    const shownFor = performance.now() - this.#shownAt;
    const age = this.#age === null ? 0 : this.#age + shownFor;
    show(this.#old, age > LATE_MS);
    if (age > LATE_MS) setText(this.#old, `This picture was taken ${ago(age / 1000)}.`);
    this.node.classList.toggle('old', shownFor > OLD_AFTER_MS);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#tellAge(), LATE_MS);
  }

  #askNext() {
    const line = this.#line;
    setTimeout(() => line?.readyState === WebSocket.OPEN && line.send('next'), LEAST_GAP_MS);
  }
}
