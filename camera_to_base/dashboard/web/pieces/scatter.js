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

// The scatter of the chosen object: where each frame of the last minutes has seen it.

import {keepFile} from '../base/actions.js';
import {button, card, element, setText, show} from '../base/dom.js';
import {fixed} from '../base/numbers.js';
import {createPlane, createSpans, createTimeChart, LONGEST_S} from './charts.js';

const HEAD = 'stamp_s,frame,x_cm,y_cm,yaw_deg';
const MM_PER_CM = 10;
// A long trace costs more to draw, and moves less.
const DRAWN_EVERY_MS = {60: 500, 180: 1000, [LONGEST_S]: 2000};
const SMALLEST_MM = 0.1;
// More points in the plane cannot be told apart.
const MOST_DOTS = 500;
// A frame may be told after the next one; one that is older than this is of another time.
const CLOCK_WAS_SET_S = 10;

/** Make the card; `update(watch, object)` adds a frame of the chosen object, or of none. */
export function createScatter() {
  let points = [];
  let frame = null;
  let span = 60;
  let most = SMALLEST_MM;
  let drawnAt = -Infinity;
  let count = 0;
  const words = element('p', {class: 'scatter-words'});
  const range = () => [-most, most];
  const x = createTimeChart('x, from its mean', 'mm', {range, decimals: 2});
  const y = createTimeChart('y, from its mean', 'mm', {range, decimals: 2});
  const plane = createPlane();
  const inSpan = () => points.filter(({stamp}) => points.at(-1).stamp - stamp < span);
  const file = button('Download as CSV', () => keepFile(new Blob(
    [[HEAD, ...inSpan().map((one) => [one.stamp, frame, one.x, one.y, one.yaw ?? ''].join(','))]
      .join('\n') + '\n'], {type: 'text/csv'}), 'scatter.csv'));
  const again = button('Start again', () => { points = points.slice(-1); });
  const spans = createSpans((seconds) => {
    span = seconds;
    draw();
  });
  const node = card('Scatter of the chosen object', spans, words, element('div', {class: 'charts'},
    element('div', {}, x.node, y.node), element('figure', {class: 'chart-box'},
      element('figcaption', {}, 'x and y, from their means, in mm'), plane.node)),
  element('div', {class: 'buttons'}, again, file));
  node.classList.add('scatter');
  show(node, false);
  const update = (watch, object) => {
    show(node, object);
    if (!object) {
      points = [];
      return;
    }
    const [name, place] = object.base ? ['base', object.base] : ['camera', object.camera];
    const last = points.at(-1)?.stamp ?? -Infinity;
    if (name !== frame || last - watch.stamp_s > CLOCK_WAS_SET_S) points = [];
    frame = name;
    if (!points.length || watch.stamp_s > last) {
      count += 1;
      points.push({count, stamp: watch.stamp_s, x: place.x, y: place.y, yaw: place.yaw_deg});
      const oldest = points.findIndex(({stamp}) => watch.stamp_s - stamp < LONGEST_S);
      points.splice(0, oldest);
    }
    if (performance.now() - drawnAt > DRAWN_EVERY_MS[span]) draw();
  };
  const draw = () => {
    drawnAt = performance.now();
    const shown = inSpan();
    const times = shown.map(({stamp}) => stamp);
    const [along, up] = ['x', 'y'].map((name) => spread(shown.map((one) => one[name])));
    most = Math.max(SMALLEST_MM, 1.1 * along.most, 1.1 * up.most);
    setText(words, `${shown.length} frames in ${fixed(times.at(-1) - times[0], 0)} s, in the ${frame} frame: x ` +
      `${said(along)}, y ${said(up)} (standard deviation).`);
    for (const [chart, {offsets}] of [[x, along], [y, up]]) {
      const [low, high] = [Math.min, Math.max].map((end) => fixed(offsets.reduce((one, other) => end(one, other)), 2));
      chart.update({times, values: offsets, span, now: times.at(-1), text: `${low} to ${high} mm`});
    }
    // The same ones at each time: the picture is calm.
    const each = Math.ceil(shown.length / MOST_DOTS);
    const [xs, ys] = [along, up].map(({offsets}) => offsets.filter((_, index) => shown[index].count % each === 0));
    plane.update(xs, ys, most, words.textContent);
  };
  return {node, update};
}

function said({mean, deviation}) {
  return `${fixed(mean, 2)} cm ± ${fixed(deviation, 2)} mm`;
}

/** Return the mean in cm, and how far the values are from it, in mm. */
function spread(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const offsets = values.map((value) => MM_PER_CM * (value - mean));
  const square = offsets.reduce((sum, offset) => sum + offset ** 2, 0);
  return {mean, offsets, most: offsets.reduce((most, offset) => Math.max(most, Math.abs(offset)), 0),
    deviation: Math.sqrt(square / Math.max(values.length - 1, 1))};
}
