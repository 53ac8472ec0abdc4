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

// Puts the page together: the store, the connection, the parts and their tabs.

import {connect, Store} from './base/state.js';
import {createCalibrate} from './parts/calibrate.js';
import {createDetect} from './parts/detect.js';
import {createHealth} from './parts/health.js';
import {createProve} from './parts/prove.js';
import {createRobot} from './parts/robot.js';
import {createSave} from './parts/save.js';
import {createWatch} from './parts/watch.js';
import {createBanner} from './pieces/banner.js';
import {createCells} from './pieces/cells.js';
import {createSetup} from './pieces/setup.js';
import {createSimulated} from './pieces/simulated.js';
import {createTabs} from './pieces/tabs.js';

const ALL = ['watch', 'detect', 'calibrate', 'robot', 'prove', 'health', 'save'];
const OF_FUSED = ['watch', 'health'];

const store = new Store();

const tabs = createTabs(document.getElementById('tabs'), document.getElementById('main'), {
  watch: ['Watch', createWatch(store)],
  detect: ['Detect', createDetect(store)],
  calibrate: ['Calibrate', createCalibrate(store)],
  robot: ['Robot', createRobot(store)],
  prove: ['Prove', createProve(store)],
  health: ['Health', createHealth(store)],
  save: ['Save', createSave(store)],
});
// What is set up, is set up in the cell of each camera.
store.on('watch', ({cameras}) => tabs.offer(cameras ? OF_FUSED : ALL));
createBanner(store);
createCells(store);
createSetup(store);
createSimulated(store);
connect(store);
