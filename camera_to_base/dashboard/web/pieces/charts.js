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

// Small charts of the last minute.

import {element, setAttribute, setText, svg} from '../base/dom.js';
import {fixed} from '../base/numbers.js';

const WIDTH = 240;
const HEIGHT = 64;
const LENGTH = 60;

/** Make a chart with a title and a unit; a number that is missing leaves a gap. */
export function createChart(title, unit) {
  const line = svg('path', {class: 'line'});
  const drawing = svg('svg', {
    class: 'chart', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', preserveAspectRatio: 'none'},
  svg('path', {class: 'grid', d: `M0 ${HEIGHT - 1}H${WIDTH}M0 1H${WIDTH}`}), line);
  const now = element('strong');
  const range = element('span', {class: 'quiet'});
  const update = (newest) => {
    const values = [...Array(Math.max(LENGTH - newest.length, 0)).fill(null), ...newest];
    const known = values.filter((value) => value !== null);
    const top = Math.max(...known, 1e-9) * 1.1;
    const last = values.at(-1) ?? null;
    setAttribute(line, 'd', path(values, top));
    setText(now, last === null ? '–' : `${fixed(last, 1)} ${unit}`);
    setText(range, known.length
      ? `${fixed(Math.min(...known), 1)} to ${fixed(Math.max(...known), 1)} ${unit} in the last minute`
      : 'nothing in the last minute');
    setAttribute(drawing, 'aria-label', `${title}: now ${now.textContent}, ${range.textContent}`);
  };
  const node = element('figure', {class: 'chart-box'},
    element('figcaption', {}, `${title} `, now), drawing, range);
  return {node, update};
}

function path(values, top) {
  let isDown = false;
  return values.map((value, index) => {
    if (value === null) {
      isDown = false;
      return '';
    }
    const x = WIDTH * index / Math.max(values.length - 1, 1);
    const y = HEIGHT - 1 - (HEIGHT - 2) * value / top;
    const step = `${isDown ? 'L' : 'M'}${x.toFixed(1)} ${y.toFixed(1)}`;
    isDown = true;
    return step;
  }).join('');
}
