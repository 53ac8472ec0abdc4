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

// The map: the surface seen from above, in the base frame, in cm.

import {fixed} from '../base/numbers.js';
import {element, setAttribute, setText, svg, sync} from '../base/dom.js';
import {paths} from './shapes.js';

const STEPS_CM = [1, 2, 5, 10, 20, 50, 100, 200, 500];
const LARGEST_CM = 400;

/** Make the map; `choose(object)` is called when an object is clicked. */
export function createMap(choose) {
  const layers = ['grid', 'areas', 'shapes', 'base', 'objects'].map((name) => svg('g', {'data-layer': name}));
  const drawing = svg('svg', {class: 'map', role: 'img'}, ...layers);
  const note = element('p', {class: 'quiet'}, 'Waiting for the surface …');
  let objects = [];
  let pressed = null;
  // Objects move and change their numbers during a press: the one that was pressed counts.
  drawing.addEventListener('pointerdown', (event) => {
    const number = event.target.closest('.object')?.dataset.key;
    pressed = objects.find((object) => String(object.number) === number) ?? null;
  });
  // No click comes where the pressed node was taken away meanwhile, as in a frame without the object.
  drawing.addEventListener('pointerup', () => {
    if (pressed) choose(pressed);
    pressed = null;
  });
  const update = (watch, selection, shapes) => {
    const box = frame(watch);
    objects = watch.objects.filter((object) => object.base);
    setAttribute(drawing, 'viewBox', `${box.left} ${-box.top} ${box.width} ${box.height}`);
    setAttribute(drawing, 'aria-label', summary(watch));
    const drawn = [grid(box), areas(watch.map), shapes.map(outline), base(box),
      objects.map((object) => mark(object, box, selection.is(object)))];
    layers.forEach((layer, index) => draw(layer, drawn[index]));
    setText(note, legend(watch, box));
  };
  return {node: element('div', {}, drawing, note), update};
}

function outline({number, map}) {
  const upwards = Object.fromEntries(Object.entries(map).map(([name, points]) =>
    [name, points?.map(([x, y]) => [x, -y])]));
  return [number, 'g', {class: 'shapes'}, paths(upwards).map(([name, d]) => [name, 'path', {class: name, d}])];
}

/** Draw shapes, each [key, tag, attributes, text or shapes in it]; nodes of known keys are kept. */
function draw(parent, shapes) {
  sync(parent, shapes, ([key]) => key, ([, tag]) => svg(tag), (node, [, , attributes, content]) => {
    Object.entries(attributes).forEach(([name, value]) => setAttribute(node, name, value));
    if (Array.isArray(content)) draw(node, content);
    else if (content !== undefined) setText(node, content);
  });
}

function summary({objects, map}) {
  const placed = objects.filter(({base: place}) => place);
  const list = placed.map(({number, base: {x, y}}) =>
    `object ${number} at ${fixed(x, 1)}, ${fixed(y, 1)} cm`).join('; ');
  return `Map in the base frame: ${list || 'no object'}${map?.view ? '; the view of the camera' : ''}.`;
}

function legend({map}, box) {
  return ['Base frame, in cm.', map?.view && 'Blue: what the camera sees.',
    isInside(map, box) && 'Dashed: the reach of the robot.', map?.work_area && 'Green: the work area.',
  ].filter(Boolean).join(' ');
}

function reach(map) {
  return map?.reach_cm && map.reach_cm[1] <= LARGEST_CM ? map.reach_cm : null;
}

/** Tell whether the line of the reach can be seen. */
function isInside(map, {left, top, width, height}) {
  const far = Math.hypot(Math.max(-left, left + width), Math.max(top, height - top));
  return (reach(map) ?? []).some((radius) => radius > 0 && radius < far);
}

/** Return what the map shows: the view, the objects, and the robot's base. */
function frame({map, objects}) {
  const points = [[0, 0], ...(map?.view ?? [[-20, 0], [20, 30]]), ...(map?.work_area ?? []),
    ...objects.filter((object) => object.base).map(({base: {x, y}}) => [x, y])]
    .filter(([x, y]) => Math.abs(x) < LARGEST_CM && Math.abs(y) < LARGEST_CM);
  const xs = points.map(([x]) => x);
  const ys = points.map(([, y]) => y);
  const size = Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys), 10);
  const margin = 0.1 * size;
  const left = Math.min(...xs) - margin;
  const top = Math.max(...ys) + margin;
  return {left, top, size, width: Math.max(...xs) + margin - left,
    height: top - Math.min(...ys) + margin};
}

function grid(box) {
  const step = STEPS_CM.find((each) => box.size / each <= 8) ?? 1000;
  const lines = [];
  const font = box.size * 0.035;
  for (let x = Math.ceil(box.left / step) * step; x <= box.left + box.width; x += step) {
    lines.push([`x${x}`, 'line', {class: 'grid', x1: x, x2: x, y1: -box.top, y2: box.height - box.top}],
      [`x${x} text`, 'text', {class: 'scale', x: x + font * 0.2, y: box.height - box.top - font * 0.3,
        'font-size': font}, String(x)]);
  }
  for (let y = Math.ceil((box.top - box.height) / step) * step; y <= box.top; y += step) {
    lines.push([`y${y}`, 'line', {class: 'grid', y1: -y, y2: -y, x1: box.left, x2: box.left + box.width}],
      [`y${y} text`, 'text', {class: 'scale', x: box.left + font * 0.2, y: -y - font * 0.2,
        'font-size': font}, String(y)]);
  }
  return lines;
}

function areas(map) {
  const polygon = (corners, name) => [name, 'polygon', {
    class: name, points: corners.map(([x, y]) => `${x},${-y}`).join(' ')}];
  return [
    ...(reach(map) ?? []).filter(Boolean).map((r) => [`reach${r}`, 'circle', {class: 'reach', r}]),
    map?.view && polygon(map.view, 'view'),
    map?.work_area && polygon(map.work_area, 'work-area'),
  ].filter(Boolean);
}

function base(box) {
  const unit = box.size * 0.05;
  return [['base', 'g', {class: 'base'}, [
    ['x', 'path', {class: 'axis x', d: `M0 0H${2 * unit}`}],
    ['y', 'path', {class: 'axis y', d: `M0 0V${-2 * unit}`}],
    ['foot', 'rect', {x: -unit / 2, y: -unit / 2, width: unit, height: unit, rx: unit / 5}],
    ['name', 'text', {x: 0, y: unit * 1.5, 'font-size': unit * 0.8, 'text-anchor': 'middle'}, 'robot'],
  ]]];
}

function mark(object, box, isChosen) {
  const {x, y, yaw_deg: yaw} = object.base;
  const unit = box.size * 0.03;
  const parts = [];
  if (object.ellipse?.frame === 'base') {
    const {major_mm: major, minor_mm: minor, angle_deg: angle} = object.ellipse;
    parts.push(['ellipse', 'ellipse', {class: 'ellipse', rx: major / 10, ry: minor / 10,
      transform: `rotate(${-angle})`}]);
  }
  if (yaw !== null && yaw !== undefined) {
    parts.push(['yaw', 'line', {class: 'yaw', x1: -2 * unit, x2: 2 * unit,
      transform: `rotate(${-yaw})`}]);
  }
  parts.push(['disc', 'circle', {r: unit}], ['number', 'text', {
    'font-size': unit * 1.3, 'text-anchor': 'middle', dy: '0.36em'}, String(object.number)]);
  return [object.number, 'g', {class: isChosen ? 'object chosen' : 'object',
    transform: `translate(${x} ${-y})`}, parts];
}
