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
import {everydayName} from '../base/names.js';
import {read} from '../base/numbers.js';

const LARGEST_SLIDER = 500;
const TELL_EVERY_MS = 150;
const KEEP_OWN_MS = 700;

/**
 * Make a field.
 *
 * `change(value)` sends a value and is rejected with the node's sentence where it is refused; the
 * field then shows the sentence, and its old value again. What a person types is never
 * overwritten: a value that comes meanwhile is told below the field.
 */
export function createField(spec, id, change) {
  const error = element('p', {class: 'field-error', id: `${id}-error`, role: 'alert', hidden: true});
  const elsewhere = element('p', {class: 'elsewhere', role: 'status', hidden: true});
  const about = element('p', {class: 'about', id: `${id}-about`}, describe(spec));
  const reset = button('Default', () => {
    // What was typed last, and is not sent yet, must not come after the default.
    clearTimeout(waiting);
    control.set(spec.default);
    send(spec.default);
  }, {class: 'quiet small', 'aria-label': `${everydayName(spec.name)}: back to the default`});
  let known = spec.value;
  let told = spec.value;
  let keepOwnUntil = 0;
  let waiting = null;
  let sending = 0;
  let isEdited = false;
  const control = makeControl(spec, id, (value, wait = 0) => {
    clearTimeout(waiting);
    keepOwnUntil = Infinity;
    waiting = setTimeout(() => send(value), wait);
  });
  const isTyped = () => isEdited || document.activeElement === control.typed;
  const showKnown = () => {
    control.set(known);
    setText(elsewhere, '');
    show(elsewhere, false);
  };
  const tell = (sentence) => {
    setText(error, sentence);
    show(error, sentence);
    control.inputs.forEach((input) => setAttribute(input, 'aria-invalid', Boolean(sentence)));
  };
  const send = async (value) => {
    isEdited = false;
    sending += 1;
    keepOwnUntil = Infinity;
    try {
      await change(value);
      known = value;
      tell('');
    } catch (refusal) {
      if (!isEdited && sending === 1) showKnown();
      tell(refusal.errors?.[spec.name] ?? refusal.message);
    }
    sending -= 1;
    if (sending) return;
    keepOwnUntil = Date.now() + KEEP_OWN_MS;
    setTimeout(takeTold, KEEP_OWN_MS + 1);
  };
  control.typed?.addEventListener('input', () => { isEdited = true; });
  control.typed?.addEventListener('blur', () => {
    if (!isEdited && Date.now() > keepOwnUntil) showKnown();
  });
  const takeTold = () => {
    // What is sent comes back by itself, after values that are older.
    if (Date.now() <= keepOwnUntil) return;
    const isOther = JSON.stringify(told) !== JSON.stringify(known);
    known = told;
    if (!isTyped()) showKnown();
    else if (isOther) {
      setText(elsewhere, `It has been set to ${textOf(told)} elsewhere.`);
      show(elsewhere, true);
    }
  };
  const update = ({value}) => {
    told = value;
    takeTold();
    show(reset, !spec.read_only && spec.default !== null && spec.default !== undefined &&
      JSON.stringify(value) !== JSON.stringify(spec.default));
  };
  const head = element('div', {class: 'field-head'}, element('div', {},
    element('label', {for: id}, everydayName(spec.name)), ' ', element('code', {}, spec.name)), reset);
  const node = element('div', {class: 'field'}, head, control.node, elsewhere, error, about);
  update(spec);
  return {node, update};
}

function textOf(value) {
  return Array.isArray(value) ? value.join('  ') || 'an empty list' : String(value);
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
  return {node: withUnit(input, unit), inputs: [input], typed: input,
    set: (value) => { input.value = value; }};
}

function sliderControl(spec, shared, tell) {
  const [low, high, step] = spec.range;
  const each = step || (spec.type === 'integer' ? 1 : (high - low) / 500);
  const slider = element('input', {type: 'range', min: low, max: high, step: each,
    disabled: shared.disabled, 'aria-label': `${everydayName(spec.name)}, slider`, oninput: () => {
      const value = spec.type === 'integer' ? Number(slider.value) : Number(fixedPlain(slider.value));
      input.value = value;
      tell(value, TELL_EVERY_MS);
    }});
  const {node, inputs: [input]} = numberControl(spec, shared, tell);
  const set = (value) => {
    input.value = value;
    slider.value = value;
  };
  return {node: element('div', {class: 'slider'}, slider, node), inputs: [input], typed: input, set};
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
  return {node: withUnit(input, isList ? unit : ''), inputs: [input], typed: input, set};
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

