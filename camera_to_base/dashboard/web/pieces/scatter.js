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

// The scatter of the chosen object: where each frame of the last ten minutes has seen it.

import {keepFile} from '../base/actions.js';
import {button, card, element, setAttribute, setText, show, svg, sync} from '../base/dom.js';
import {fixed} from '../base/numbers.js';

const LONGEST_S = 600;
const SIZE = 200;
const MOST_DOTS = 600;
const HEAD = 'stamp_s,frame,x_cm,y_cm,yaw_deg';

/** Make the card; `update(watch, object)` adds a frame of the chosen object, or of none. */
export function createScatter() {
  let points = [];
  let frame = null;
  const words = element('p', {role: 'status'});
  const dots = svg('g');
  const drawing = svg('svg', {class: 'scatter', viewBox: `0 0 ${SIZE} ${SIZE}`, role: 'img'},
    svg('path', {class: 'grid', d: `M${SIZE / 2} 0V${SIZE}M0 ${SIZE / 2}H${SIZE}`}), dots);
  const scale = element('p', {class: 'quiet'});
  const file = button('Download as CSV', () => keepFile(new Blob(
    [[HEAD, ...points.map((one) => [one.stamp, frame, one.x, one.y, one.yaw ?? ''].join(','))]
      .join('\n') + '\n'], {type: 'text/csv'}), 'scatter.csv'));
  const node = card('Scatter of the chosen object', words, drawing, scale, element('div',
    {class: 'buttons'}, button('Start again', () => { points = []; }), file));
  show(node, false);
  const update = (watch, object) => {
    show(node, object);
    if (!object) {
      points = [];
      return;
    }
    const [name, place] = object.base ? ['base', object.base] : ['camera', object.camera];
    if (name !== frame) points = [];
    frame = name;
    if (watch.stamp_s !== points.at(-1)?.stamp) {
      points.push({stamp: watch.stamp_s, x: place.x, y: place.y, yaw: place.yaw_deg});
      points = points.filter(({stamp}) => watch.stamp_s - stamp < LONGEST_S);
    }
    draw();
  };
  const draw = () => {
    const x = spread(points.map((one) => one.x));
    const y = spread(points.map((one) => one.y));
    const seconds = points.at(-1).stamp - points[0].stamp;
    const most = Math.max(0.01, ...points.map((one) =>
      Math.max(Math.abs(one.x - x.mean), Math.abs(one.y - y.mean))));
    setText(words, `${points.length} frames in ${fixed(seconds, 0)} s, in the ${frame} frame: x ` +
      `${fixed(x.mean, 2)} cm ± ${fixed(10 * x.deviation, 2)} mm, y ${fixed(y.mean, 2)} cm ± ` +
      `${fixed(10 * y.deviation, 2)} mm (standard deviation).`);
    setAttribute(drawing, 'aria-label', words.textContent);
    setText(scale, `The picture is ${fixed(20 * most, 1)} mm wide.`);
    const to = (value) => SIZE / 2 + value / most * SIZE * 0.48;
    sync(dots, points.slice(-MOST_DOTS), ({stamp}) => stamp, () => svg('circle', {r: 2}),
      (dot, one) => {
        setAttribute(dot, 'cx', to(one.x - x.mean).toFixed(1));
        setAttribute(dot, 'cy', to(y.mean - one.y).toFixed(1));
      });
  };
  return {node, update};
}

function spread(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const square = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
  return {mean, deviation: Math.sqrt(square / Math.max(values.length - 1, 1))};
}
