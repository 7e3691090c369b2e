// The columns of a frame: what each holds, in which unit, and how it comes out of a moment of a recording.

export const FPS = 100;
export const WINDOW = 10; // samples of the wrench, 1 ms apart, the last at the frame

const POSE = ['x', 'y', 'z', 'qw', 'qx', 'qy', 'qz'];
const WRENCH = ['force_x', 'force_y', 'force_z', 'torque_x', 'torque_y', 'torque_z'];
const WRENCH_UNITS = ['N', 'N', 'N', 'N m', 'N m', 'N m'];
const JOINTS = ['J1', 'J2', 'J3', 'J4', 'J5', 'J6'];
const STAGES = ['tool', 'smoother', 'link', 'tube', 'bumper', 'reach', 'limits', 'singularity'];
const AXES = ['x', 'y', 'z'];
const OLDEST_S = 1000; // an age that is not known, or longer

const axes = (...names) => names.flatMap((name) => AXES.map((axis) => `${name}_${axis}`));
const units = (count, unit) => new Array(count).fill(unit);
const poseUnits = (prefix) => ({ names: POSE.map((name) => prefix + name), units: [...units(3, 'm'), ...units(4, '1')] });
const joined = (...parts) => ({ names: parts.flatMap((part) => part.names), units: parts.flatMap((part) => part.units) });
const joints = (prefix) => ({ names: JOINTS.map((name) => prefix + name), units: units(6, 'rad') });
const age = (ns) => Math.min(Number(ns.toString()) / 1e9, OLDEST_S);
const position = {
  names: ['position_kind', ...axes('anchor', 'direction', 'normal'), 'end', 'stiffness'],
  units: ['kind', ...units(3, 'm'), ...units(6, '1'), 'm', 'N/m'],
};
const orientation = {
  names: ['orientation_kind', ...axes('turn_normal', 'turn_axis'), 'turn_qw', 'turn_qx', 'turn_qy', 'turn_qz', 'turn_stiffness'],
  units: ['kind', ...units(6, '1'), ...units(4, '1'), 'N m/rad'],
};
const column = (dtype, shape, { names = null, units: unit = null } = {}, about, of) => ({ dtype, shape, names, units: unit, about, of });
const one = (dtype, unit, about, of) => column(dtype, [1], { units: [unit] }, about, of);

/**
 * key -> {dtype, shape, names, units, about, of}. `of` gives the values of a moment {tick, state, window, target}.
 * `both`: the slave's own cycles are there, so that commanded joints are known.
 */
export function featuresOf(both) {
  const tip = poseUnits('tip_');
  return {
    'observation.state': column('float32', [13], joined(joints(''), tip),
      'measured joints; measured pose of the tip X_ST in the base frame of the arm',
      ({ state }) => [...state.joints, ...state.measured_pose]),
    'observation.wrench': column('float32', [6], { names: WRENCH, units: WRENCH_UNITS },
      'f_E_S: of the environment on the tip, axes of the base frame, torque about the origin of the sensor; newest at the frame; 0 while it is not valid',
      ({ window }) => window.slice(-6)),
    'observation.wrench_window': column('float32', [WINDOW, 6], { names: ['sample', 'axis'], units: WRENCH_UNITS },
      'the wrench 9 ms before the frame, 8 ms, ... and at it: the newest that was there at each moment',
      ({ window }) => window),
    'observation.environment_state': column('float32', [24], joined(position, orientation),
      'the tools that are called, as the goal of the motion, in the base frame; 0 without one. Kinds: 0 none, 1 point, 2 line, 3 plane, 4 N-rotation, 5 F-rotation',
      ({ tick: { command } }) => [command.position_kind, ...(command.position_kind ? command.position_geometry : units(11, 0)),
        command.orientation_kind, ...(command.orientation_kind ? command.orientation_geometry : units(11, 0))]),
    action: column('float32', [both ? 13 : 7], both ? joined(joints('target_'), poseUnits('command_')) : poseUnits('command_'),
      `${both ? 'joints that the slave sent to the controller; ' : ''}pose X_SU that the hand asks the tip for, behind the tools; where the arm is held while no command is valid`,
      ({ tick: { command }, state, target }) => [...(both ? target : []), ...(command.command_valid ? command.command_pose : state.command_pose)]),
    'tool.kinds': column('int64', [2], { names: ['position', 'orientation'], units: units(2, 'kind') },
      '0 none, 1 point, 2 line, 3 plane, 4 N-rotation, 5 F-rotation',
      ({ tick: { command } }) => [command.position_kind, command.orientation_kind]),
    'tool.ids': column('int64', [2], { names: ['position', 'orientation'], units: units(2, '1') }, 'numbers of the tools that are called, 0 for none',
      ({ tick: { command } }) => [command.position_id, command.orientation_id]),
    reason: one('int64', 'code', 'why the arm is not where the hand is, a code of server/model/reason.h; 0 for nothing', ({ tick }) => [tick.reason]),
    session_state: one('int64', 'code', 'of the master: 0 off, 1 aligning, 2 engaged, 3 clutched, 4 hold, 5 fault, 6 homing', ({ tick }) => [tick.command.state]),
    stage_offsets: column('float32', [24], { names: STAGES.flatMap((stage) => axes(stage)), units: units(24, 'm') },
      'how far each stage moved the tip, from the hand to the arm, base frame', ({ tick }) => tick.motion),
    link_age: column('float32', [3], { names: ['slave_state', 'loop', 'slave_heard'], units: units(3, 's') },
      `age of the slave's newest state; of the newest command that the slave is known to have; how long it had had none when it sent its newest state; ${OLDEST_S} where it is not known`,
      ({ tick }) => [age(tick.slave_age_ns), age(tick.link.loop_age_ns), age(tick.link.peer_age_ns)]),
    energy_margin: one('float32', 'J', 'minus the energy that was made at the hand and that the governor has yet to take back; 0: none', ({ tick }) => [0 - tick.energy_made]),
    hand_wrench: column('float32', [6], { names: WRENCH, units: WRENCH_UNITS }, 'f_H_M: what the device gives to the hand, axes of the device', ({ tick }) => tick.wrench),
    hand_wrench_felt: column('float32', [6], { names: WRENCH, units: WRENCH_UNITS }, 'the same as a sensor on the handle measured it, torque about the hand; 0 where it is not valid',
      ({ tick }) => (tick.handle?.length ? tick.handle : [0, 0, 0, 0, 0, 0])),
    hand_wrench_felt_valid: one('bool', '1', 'it is measured now', ({ tick }) => [tick.handle?.length ? 1 : 0]),
    command_valid: one('bool', '1', 'the hand commands the arm', ({ tick }) => [tick.command.command_valid ? 1 : 0]),
    pose_valid: one('bool', '1', 'joints and tip are measured now', ({ state }) => [state.pose_valid ? 1 : 0]),
    wrench_valid: one('bool', '1', 'the wrench is measured now', ({ state }) => [state.wrench_valid ? 1 : 0]),
    payload_removed: one('bool', '1', 'the wrench is without what hangs on the sensor', ({ state }) => [state.payload_removed ? 1 : 0]),
    'next.done': one('bool', '1', 'the last frame of the episode', () => [0]),
    'next.success': one('bool', '1', 'the last frame of an episode whose trial was done; false also where that is not known (handrail/result of meta/episodes)', () => [0]),
    timestamp: one('float32', 's', 'frame_index / fps', () => [0]),
    frame_index: one('int64', '1', 'within the episode', () => [0]),
    episode_index: one('int64', '1', 'of the data set', () => [0]),
    index: one('int64', '1', 'of the frame in the data set', () => [0]),
    task_index: one('int64', '1', 'row of meta/tasks.parquet', () => [0]),
  };
}

export const widthOf = ({ shape }) => shape.reduce((a, b) => a * b, 1);
