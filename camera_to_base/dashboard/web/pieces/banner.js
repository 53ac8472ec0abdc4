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
import {setAttribute, setText, show} from '../base/dom.js';
import {isOfTheView, wayOut} from '../base/reasons.js';

const LOST = 'The dashboard does not answer.';
const LOST_CURE = 'What you see is old. Check that the program "dashboard" runs and that the ' +
  'network works; this page connects again by itself.';

const BOARD_COVERS = 'No positions are published while the board covers the view. This is normal.';

/** Keep the sentence and the mark of the connection up to date. */
export function createBanner(store) {
  const update = () => {
    const {level, sentence, more, reason} = state(store);
    document.getElementById('banner').className = `banner ${level}`;
    setText(document.getElementById('banner-text'), sentence);
    setText(document.getElementById('banner-more'), more ?? '');
    fillWay(document.getElementById('banner-way'), reason ?? '');
    const isOpen = store.get('connection') === 'open';
    document.body.classList.toggle('offline', !isOpen);
    const pill = document.getElementById('connection');
    pill.className = `pill ${isOpen ? 'ok' : 'error'}`;
    setText(pill, isOpen ? 'Connected' : 'Not connected');
  };
  ['connection', 'watch', 'cells', 'board'].forEach((part) => store.on(part, update));
}

function state(store) {
  const connection = store.get('connection');
  const watch = store.get('watch');
  if (connection === 'lost') return {level: 'error', sentence: LOST, more: LOST_CURE};
  if (connection !== 'open') return {level: 'error', sentence: connection};
  if (!watch) return {level: 'warn', sentence: 'Waiting for the nodes …'};
  const problem = watch.silence ?? watch.warning;
  const board = store.get('board');
  const isCovered = board && board.step !== 'off' && !board.accepted;
  if (isCovered && isOfTheView(problem?.reason ?? '')) {
    return {level: 'calm', sentence: BOARD_COVERS};
  }
  if (problem) return problemState(problem);
  return {level: 'ok', sentence: published(watch)};
}

function fillWay(link, reason) {
  const way = wayOut(reason);
  show(link, way);
  if (!way) return;
  setAttribute(link, 'href', way.href);
  setText(link, way.words);
}

function problemState({level, sentence, reason}) {
  // The first sentence or clause is the problem, the rest is the cure.
  const [, problem, cure] = sentence.match(/^(.+?[.:;])\s+(.+)$/s) ?? [null, sentence, ''];
  return {level, reason, sentence: asSentence(problem).replace(/[:;]$/, '.'), more: asSentence(cure)};
}

function published({objects}) {
  // No rate: a screen reader would read out each change of it.
  if (!objects?.length) return 'The surface is empty: an empty list of objects is published.';
  return objects.length === 1 ? '1 object is published.' : `${objects.length} objects are published.`;
}
