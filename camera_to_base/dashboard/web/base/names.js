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

// Everyday names of parameters; one that is not listed is made from the parameter's own name.

const NAMES = {
  'source': 'Camera',
  'period': 'Time between random pixels',
  'max_frame_age': 'Oldest picture that counts',
  'confirm_jump_px': 'Jump that a second picture must confirm',
  'background_frames': 'Pictures for the background',
  'background_retake': 'New background when the camera was moved',
  'background_file': 'File that keeps the background',
  'object_height_cm': 'Height of the objects',
  'object_heights_cm': 'Several heights of objects',
  'work_area': 'Work area',
  'ignored_areas': 'Areas to ignore',
  'camera_frame_id': 'Name of the camera frame',
  'base_frame_id': 'Name of the base frame',
  'reach_cm': 'Reach of the robot',
  'rotation_deg': 'Rotation of the camera frame in the base frame',
  'displacement_cm': 'Origin of the camera frame in the base frame',
  'base_covariance': 'Uncertainty of the base frame',
  'detector.method': 'Way of detecting',
  'detector.threshold': 'Least difference in grey',
  'detector.closing_size': 'Gaps that are closed',
  'detector.median_size': 'Smoothing',
  'detector.faintest': 'Faintest object',
  'detector.min_area_cm2': 'Smallest object',
  'detector.max_area_cm2': 'Largest object',
  'detector.split_touching': 'Take touching objects apart',
  'detector.light_or_thing': 'What may be shade or an object',
  'detector.budget_px': 'Pixels looked at closely',
  'detector.publish_cut_off': 'Publish objects at the edge of the picture',
  'view.max_shift_px': 'Movement of the view that stops positions',
  'view.max_changed_share': 'Covered share of the view that stops positions',
  'view.correct_up_to_px': 'Movement of the view that is corrected',
  'view.correct_error_mm': 'Error that a correction may have',
  'view.fixed_areas': 'What stands still with the robot',
  'surface.model': 'How the camera looks at the surface',
  'surface.image_size': 'Size of the pictures',
  'surface.hull': 'Calibrated area',
  'surface.reject_outside_hull': 'Leave out objects outside the calibrated area',
  'surface.camera_height_cm': 'Height of the camera',
  'surface.camera_foot_cm': 'Point below the camera',
  'uncertainty.centre_floor_px': 'Error of a centre through light',
  'uncertainty.height_tolerance_cm': 'Tolerance of the height',
  'debug_image.coordinates': 'Positions on the picture',
  'calibration.strict': 'Publish nothing with another camera',
};
const UNITS = /_(px|cm|cm2|mm|deg|s|hz)$/;

/** Return the everyday name of a parameter. */
export function everydayName(name) {
  if (NAMES[name]) return NAMES[name];
  if (name.startsWith('qos_overrides.')) return name.split('.').slice(1).join(' ');
  const last = name.split('.').at(-1).replace(UNITS, '').replaceAll('_', ' ');
  return last.charAt(0).toUpperCase() + last.slice(1);
}
