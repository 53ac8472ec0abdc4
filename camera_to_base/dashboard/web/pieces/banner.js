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

// The sentence above all parts: whether positions are published, and if not, why.

import {sentence as asSentence} from '../base/numbers.js';
import {button, setAttribute, setText, show} from '../base/dom.js';

const WAYS = {
  calibrate: 'Calibrate', save: 'Keep the correction', watch: 'Say how high they are', robot: 'Measure with the robot', health: 'Look at Health',
  detect: 'Take the background again',
};
const LOST = 'The dashboard does not answer.';
const LOST_CURE = 'What you see is old. Check that the program "dashboard" runs and that the ' +
  'network works; this page connects again by itself.';

/** Keep the sentence and the mark of the connection up to date. */
export function createBanner(store) {
  const fold = createFold(document.getElementById('banner-more'));
  const update = () => {
    const {level, sentence, more, way} = bannerState(store);
    document.getElementById('banner').className = `banner ${level}`;
    setText(document.getElementById('banner-text'), sentence);
    setText(document.getElementById('banner-more'), more ?? '');
    fillWay(document.getElementById('banner-way'), way);
    fold();
    leaveRoom();
    const isOpen = store.get('connection') === 'open';
    document.body.classList.toggle('offline', !isOpen);
    const pill = document.getElementById('connection');
    pill.className = `pill ${isOpen ? 'ok' : 'error'}`;
    setText(pill, isOpen ? 'Connected' : 'Not connected');
  };
  ['connection', 'watch'].forEach((part) => store.on(part, update));
}

/** On a small screen, a long cure is cut to some lines; return what keeps its button up to date. */
function createFold(more) {
  const read = button('', () => {
    more.classList.toggle('whole');
    fold();
  }, {class: 'quiet small', 'aria-controls': more.id, hidden: true});
  more.after(read);
  const fold = () => {
    const isWhole = more.classList.contains('whole');
    if (isWhole && !more.textContent) more.classList.remove('whole');
    show(read, isWhole || more.scrollHeight > more.clientHeight + 1);
    setText(read, isWhole ? 'Less' : 'Read on');
    setAttribute(read, 'aria-expanded', isWhole);
  };
  return fold;
}

/** Keep what is scrolled to, or sticks, below a banner that stays in sight. */
function leaveRoom() {
  const banner = document.getElementById('banner');
  const height = getComputedStyle(banner).position === 'sticky' ? banner.offsetHeight : 0;
  document.documentElement.style.setProperty('--banner', `${height}px`);
}

/** Return what the banner says; the server decides the state of the cell, see `state` in `watch`. */
function bannerState(store) {
  const connection = store.get('connection');
  const watch = store.get('watch');
  if (connection === 'lost') return {level: 'error', sentence: LOST, more: LOST_CURE};
  if (connection !== 'open') return {level: 'error', sentence: connection};
  if (!watch) return {level: 'warn', sentence: 'Waiting for the nodes …'};
  return watch.state.reason === 'ok' ? watch.state : withCure(watch.state);
}

function fillWay(link, way) {
  show(link, way);
  if (!way) return;
  setAttribute(link, 'href', `#${way}`);
  setText(link, WAYS[way]);
}

function withCure({level, sentence, way, also}) {
  // The first sentence or clause is the problem, the rest is the cure.
  const [, problem, cure] = sentence.match(/^(.+?[.:;])\s+(.+)$/s) ?? [null, sentence, ''];
  const others = (also ?? []).map((each) => `Also: ${asEnded(each)}`);
  return {level, way, sentence: asSentence(problem).replace(/[:;]$/, '.'),
    more: [asEnded(asSentence(cure)), ...others].filter(Boolean).join(' ')};
}

function asEnded(text) {
  return !text || /[.!?]$/.test(text) ? text : `${text}.`;
}
