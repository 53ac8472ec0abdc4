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

// The axes and the grid of a coordinate frame, drawn on the picture.

import {button, element, setAttribute, setText, show, svg} from '../base/dom.js';

const FRAMES = {none: 'No grid', camera: 'Camera frame', base: 'Base frame'};
const KEPT_AS = 'grid';

/** Make the choice of the frame, and the layer above the picture. */
export function createGrid(store, picture) {
  let chosen = localStorage.getItem(KEPT_AS) ?? 'camera';
  const layer = svg('g', {class: 'frame-grid'});
  const choices = Object.entries(FRAMES).map(([frame, name]) => [frame, button(name, () => {
    chosen = frame;
    localStorage.setItem(KEPT_AS, frame);
    update();
  })]);
  const note = element('span', {class: 'quiet'});
  const node = element('div', {class: 'choices', role: 'group', 'aria-label': 'Grid on the picture'},
    ...choices.map(([, one]) => one), note);
  const update = () => {
    const grids = store.get('grid') ?? {};
    for (const [frame, one] of choices) {
      setAttribute(one, 'aria-pressed', frame === chosen);
      one.disabled = frame !== 'none' && !grids[frame];
    }
    const grid = grids[chosen];
    show(note, grid);
    setText(note, grid ? `Lines every ${grid.step_cm} cm` : '');
    layer.replaceChildren(...grid ? shapes(grid, picture.size, chosen) : []);
  };
  store.on('grid', update);
  picture.onsize = update;
  return {node, layer};
}

function shapes({lines, axes}, {width, height}, frame) {
  const font = width / 38;
  const isSeen = ([u, v]) => u > 0 && v > font && u < width - 2.5 * font && v < height;
  const path = (points) => points.map(([u, v], index) => `${index ? 'L' : 'M'}${u} ${v}`).join('');
  const text = (content, [u, v], name) => svg('text', {class: name, x: u + font / 4, y: v - font / 4,
    'font-size': font}, content);
  const drawn = lines.flatMap(({name, points}) => {
    // The node's note is above, so the numbers of x stand below.
    const seen = points.filter(isSeen).sort((one, other) => other[1] - one[1]);
    const at = name.startsWith('x') ? seen[0] : points.filter(isSeen).filter(([, v]) => v < height - 4 * font).at(1);
    return [svg('path', {d: path(points)}), ...(at ? [text(name, at, 'number')] : [])];
  });
  if (axes) {
    const {origin, x, y} = axes;
    drawn.push(svg('path', {class: 'axis-x', d: path([origin, x])}), text('x', x, 'axis-x'),
      svg('path', {class: 'axis-y', d: path([origin, y])}), text('y', y, 'axis-y'));
  }
  const place = axes && isSeen(axes.origin) ? axes.origin : [font / 2, height - font / 2];
  drawn.push(text(`${FRAMES[frame]}, cm`, place, 'frame-name'));
  return drawn;
}
