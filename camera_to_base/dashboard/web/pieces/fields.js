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

// A field for a parameter, made from its descriptor: a slider, a number, a choice or a text.

import {button, element, setAttribute, setText, show} from '../base/dom.js';
import {read} from '../base/numbers.js';

const LARGEST_SLIDER = 500;
const TELL_EVERY_MS = 150;
const KEEP_OWN_MS = 700;

/**
 * Make a field.
 *
 * `change(value)` sends a value and is rejected with the node's sentence where it is refused; the
 * field then shows the sentence, and its old value again.
 */
export function createField(spec, id, change) {
  const error = element('p', {class: 'field-error', id: `${id}-error`, role: 'alert', hidden: true});
  const about = element('p', {class: 'quiet', id: `${id}-about`}, describe(spec));
  const reset = button('Default', () => {
    // What was typed last, and is not sent yet, must not come after the default.
    clearTimeout(waiting);
    lastTouch = 0;
    control.set(spec.default);
    send(spec.default);
  }, {class: 'quiet small', 'aria-label': `${spec.name}: back to the default`});
  let known = spec.value;
  let lastTouch = 0;
  let waiting = null;
  const control = makeControl(spec, id, (value) => {
    lastTouch = Date.now();
    clearTimeout(waiting);
    waiting = setTimeout(() => send(value), TELL_EVERY_MS);
  });
  const tell = (sentence) => {
    setText(error, sentence);
    show(error, sentence);
    control.inputs.forEach((input) => setAttribute(input, 'aria-invalid', Boolean(sentence)));
  };
  const send = async (value) => {
    try {
      await change(value);
      tell('');
    } catch (refusal) {
      lastTouch = 0;
      control.set(known);
      tell(refusal.errors?.[spec.name] ?? refusal.message);
    }
  };
  const update = ({value}) => {
    known = value;
    if (Date.now() - lastTouch > KEEP_OWN_MS) control.set(value);
    show(reset, !spec.read_only && spec.default !== null && spec.default !== undefined &&
      JSON.stringify(value) !== JSON.stringify(spec.default));
  };
  const label = element('label', {for: id}, spec.name);
  const node = element('div', {class: 'field'}, element('div', {class: 'field-head'}, label, reset),
    control.node, error, about);
  update(spec);
  return {node, update};
}

function describe({description, constraints, read_only: isFixed}) {
  const limits = constraints && !choicesOf({constraints}) ? `Limits: ${constraints}.` : '';
  const fixedNote = isFixed ? 'It is read at the start of the node only.' : '';
  return [description, limits, fixedNote].filter(Boolean).join(' ');
}

function makeControl(spec, id, tell) {
  const shared = {id, disabled: spec.read_only, 'aria-describedby': `${id}-about ${id}-error`};
  if (spec.type === 'bool') return switchControl(shared, tell);
  if (choicesOf(spec)) return choiceControl(choicesOf(spec), shared, tell);
  if (spec.type === 'integer' || spec.type === 'double') {
    return isNarrow(spec.range) ? sliderControl(spec, shared, tell) : numberControl(spec, shared, tell);
  }
  return textControl(spec, shared, tell);
}

function choicesOf({choices, constraints}) {
  if (choices?.length) return choices;
  const match = (constraints ?? '').match(/^one of ([\w, ]+)$/);
  return match ? match[1].split(', ') : null;
}

function isNarrow(range) {
  return range && range[1] - range[0] <= LARGEST_SLIDER;
}

function switchControl(shared, tell) {
  const input = element('input', {type: 'checkbox', ...shared, onchange: () => tell(input.checked)});
  return {node: input, inputs: [input], set: (value) => { input.checked = value; }};
}

function choiceControl(choices, shared, tell) {
  const input = element('select', {...shared, onchange: () => tell(input.value)},
    ...choices.map((choice) => element('option', {}, choice)));
  return {node: input, inputs: [input], set: (value) => { input.value = value; }};
}

function numberControl({type, unit}, shared, tell) {
  const input = element('input', {type: 'text', inputmode: 'decimal', autocomplete: 'off', ...shared,
    onchange: () => tell(number(input.value, type))});
  return {node: withUnit(input, unit), inputs: [input], set: (value) => { input.value = value; }};
}

function sliderControl(spec, shared, tell) {
  const [low, high, step] = spec.range;
  const each = step || (spec.type === 'integer' ? 1 : (high - low) / 500);
  const slider = element('input', {type: 'range', min: low, max: high, step: each,
    disabled: shared.disabled, 'aria-label': `${spec.name}, slider`, oninput: () => {
      const value = spec.type === 'integer' ? Number(slider.value) : Number(fixedPlain(slider.value));
      input.value = value;
      tell(value);
    }});
  const {node, inputs: [input]} = numberControl(spec, shared, tell);
  const set = (value) => {
    input.value = value;
    slider.value = value;
  };
  return {node: element('div', {class: 'slider'}, slider, node), inputs: [input], set};
}

function fixedPlain(text) {
  return Number(text).toPrecision(4);
}

function textControl({type, unit}, shared, tell) {
  const isList = type?.endsWith('_array');
  const input = element('input', {type: 'text', autocomplete: 'off', ...shared, onchange: () => {
    tell(isList ? list(input.value, type) : input.value);
  }});
  const set = (value) => { input.value = Array.isArray(value) ? value.join('  ') : value ?? ''; };
  return {node: withUnit(input, isList ? unit : ''), inputs: [input], set};
}

function withUnit(input, unit) {
  return element('span', {class: 'with-unit'}, input, unit ? element('span', {}, unit) : null);
}

/** Read a number; what is none is sent as it is, and the server says what is wrong. */
function number(text, type) {
  const value = read(text);
  if (!Number.isFinite(value)) return text;
  return type === 'integer' && Number.isInteger(value) ? Math.trunc(value) : value;
}

function list(text, type) {
  const parts = text.trim().split(/\s*[;,]\s+|\s+/).filter(Boolean);
  return type === 'string_array' ? parts : parts.map((part) => number(part, type));
}

