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

// The sessions of the server, such as the board's and the robot's. Their states live there.

import {act} from './actions.js';
import {attempt} from './notices.js';

const SILENT = () => null;

/** Make the runner of a session's actions; the new state comes by itself. */
function session(name) {
  return (action, body) => attempt(() => act(`/api/${name}/${action}`, body), SILENT);
}

export const board = session('board');
export const markers = session('markers');
export const robot = session('robot');
export const prove = session('prove');
export const record = session('record');
