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

// Numbers as the page writes them.

/** Write a number with so many decimals; a dash where there is none. */
export function fixed(value, decimals = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
}

/** Write x and y in cm. */
export function point(place, decimals = 2) {
  return place ? `${fixed(place.x, decimals)}, ${fixed(place.y, decimals)}` : '–';
}

/** Read a number as a person types it, with a decimal point or a comma; NaN where it is none. */
export function read(text) {
  const plain = String(text).trim().replace('−', '-').replace(',', '.');
  return plain === '' ? NaN : Number(plain);
}

/** Write how long ago something was. */
export function ago(seconds) {
  if (seconds === null || seconds === undefined) return 'never';
  if (seconds < 1) return `${Math.round(1000 * seconds)} ms ago`;
  if (seconds < 90) return `${Math.round(seconds)} s ago`;
  return `${Math.round(seconds / 60)} min ago`;
}

/** Begin a sentence with a capital letter, unless it begins with a name such as reach_cm. */
export function sentence(text) {
  return text && !/^\S*[_./~]/.test(text) ? text.charAt(0).toUpperCase() + text.slice(1) : text;
}

/** Write a time of day. */
export function clock(unixSeconds) {
  return new Date(1000 * unixSeconds).toLocaleTimeString([], {hour12: false});
}
