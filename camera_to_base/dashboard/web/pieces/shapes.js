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

// The shapes of the objects: what they stand on, and the boxes around them, on the picture.

import {button, setAttribute, svg, sync} from '../base/dom.js';

const KEPT_AS = 'shapes';

/** Make the layer above the picture, and the button that shows and hides it. */
export function createShapes(store) {
  let isShown = localStorage.getItem(KEPT_AS) !== 'no';
  const layer = svg('g', {class: 'shapes'});
  const node = button('Shapes', () => {
    isShown = !isShown;
    localStorage.setItem(KEPT_AS, isShown ? 'yes' : 'no');
    update();
  }, {title: 'Boxes around the objects; filled: what they stand on; dotted: what the camera sees'});
  const update = () => {
    setAttribute(node, 'aria-pressed', isShown);
    sync(layer, isShown ? store.get('shapes') ?? [] : [], ({number}) => number, () => svg('g'),
      (group, shape) => drawShape(group, shape.picture));
  };
  store.on('shapes', update);
  update();
  return {node, layer};
}

/** The paths of an object's shape by name: those of its footprint, its silhouette and its box. */
export function paths({footprint, silhouette, box, top}) {
  const edges = top && box ? box.map((corner, index) => line([corner, top[index]])).join('') : '';
  return [['footprint', footprint && closed(footprint)], ['silhouette', silhouette && closed(silhouette)],
    ['box', box && closed(box)], ['box top', top && closed(top) + edges]].filter(([, path]) => path);
}

function drawShape(group, picture) {
  sync(group, paths(picture), ([name]) => name, ([name]) => svg('path', {class: name}),
    (node, [, path]) => setAttribute(node, 'd', path));
}

function line(points) {
  return points.map(([x, y], index) => `${index ? 'L' : 'M'}${x} ${y}`).join('');
}

function closed(points) {
  return `${line(points)}Z`;
}
