// What the gateway and the page tell each other: proto/console.proto and proto/operator.proto in
// protobuf's JSON mapping, as far as the page reads it. Every field may be absent.

export type Vec = number[];

export interface PoseMm { position_mm?: Vec; quaternion?: Vec }
export interface ForceShare { magnitude_n?: number; force_n?: Vec }

export interface ToolGeometry {
  anchor_mm?: Vec; direction?: Vec; normal?: Vec; axis?: Vec; end_mm?: Vec;
  one_way?: boolean; quaternion?: Vec; axis_tip?: Vec;
}
export interface ToolStatus {
  kind?: string; name?: string; id?: number; blending?: boolean;
  deviation_mm?: number; deviation_deg?: number; geometry?: ToolGeometry;
}
export interface WallStatus {
  stage?: number; touching?: boolean; penetration_mm?: number; proxy_mm?: Vec; locked?: boolean;
  stage_name?: string; region_name?: string; place?: string; hand_mm?: Vec; force_n?: Vec;
  turned_rad?: number; screw_c?: number; ball_mm?: Vec;
}
export interface LeaseStatus {
  holder?: string; held_s?: number; idle_s?: number; asked_by?: string; ask_left_s?: number;
}
export interface Ledger {
  sentence?: string; way_out?: string; way_out_order?: Order[];
  behind_mm?: number; behind_deg?: number; cue?: ForceShare;
}
export interface CursorStatus { sequence?: string; age_ms?: number; held?: boolean; position_mm?: Vec }
export interface DeviceStatus {
  workspace_half_mm?: Vec; max_force_n?: number; has_rotation?: boolean; cursor?: CursorStatus;
}
export interface Status {
  desired?: string; state?: string; reason?: string; slave_state?: string; slave_reason?: string;
  scene?: string; slave_scene?: string; device?: string; device_simulated?: boolean;
  packet_age_ms?: number; loss_share?: number; round_trip_ms?: number; loop_age_ms?: number;
  position_tool?: ToolStatus; orientation_tool?: ToolStatus;
  tool_force?: ForceShare; spring_force?: ForceShare; device_force?: ForceShare;
  command?: PoseMm; slave_command?: PoseMm; tip?: PoseMm; hand?: PoseMm; desired_tip?: PoseMm;
  recording?: { folder?: string; file?: string; mb?: number; problem?: string; lost?: number };
  gripper?: string; contact_force_n?: Vec; has_contact_force?: boolean; time_s?: number;
  walls?: WallStatus; lease?: LeaseStatus; link_quality?: string; peer_quality?: string;
  ledger?: Ledger; peer?: { problem?: string; name?: string };
  joints_deg?: Vec; joints_commanded_deg?: Vec; haptic?: DeviceStatus;
  named_tool?: { name?: string; kind?: string }[]; prompt?: string;
}

export interface RigScrew {
  turned_deg?: number; depth_mm?: number; off_flats_deg?: number; slipped?: boolean; jammed?: boolean;
}
export interface RigMoment { tip?: PoseMm; force_n?: Vec; torque_n_m?: Vec; screw?: RigScrew }
export interface RigNews { scene?: string; moment?: RigMoment; problem?: string }
export interface StatusNews {
  status?: Status; age_ms?: number; gateway_s?: number; round_trip_ms?: number; problem?: string;
  number?: string; pages?: number; rig?: RigNews; play?: PlayNews;
}
export interface RecordingMark { at_s?: number; kind?: 'MARK' | 'STOP' | 'FAULT' | 'GAP'; text?: string; who?: string }
export interface RecordingNews {
  file?: string; program?: string; version?: string; begins_s?: number; length_s?: number; damage?: string;
  mark?: RecordingMark[]; marks_left_out?: number; slowest?: number; fastest?: number;
}
export interface PlayNews { state?: 'PLAYING' | 'PAUSED' | 'ENDED'; position_s?: number; speed?: number; jumps?: number }
export interface PlayOrder { playing?: boolean; position_s?: number; speed?: number }
export interface Hello {
  version?: string; role?: 'OPERATOR' | 'OBSERVER'; page?: number; leader?: number;
  leader_text?: string; name?: string; master?: string; scene?: string[];
  recording?: RecordingNews;
  limits?: { hand_hz_most?: number; hand_patience_ms?: number; requests_most?: number };
}
export interface PageReply { id?: number; done?: boolean; reason?: string; lease?: LeaseStatus }
export interface CursorNews { taken?: boolean; reason?: string }

export interface ArmLink {
  twist_deg?: number; length_mm?: number; zero_deg?: number; offset_mm?: number;
  lower_deg?: number; upper_deg?: number;
}
export interface SceneBody {
  kind?: 'PLANE' | 'BOX' | 'CYLINDER' | 'TUBE' | 'SOCKET'; pose?: PoseMm; size_mm?: Vec;
}
export interface SceneMap {
  picture?: string; size_mm?: Vec;
  region?: { name?: string; kind?: string; colour?: string; one_way?: Vec }[];
  stage?: { name?: string; at_mm?: Vec; turn_deg?: number; without?: string[] }[];
  place?: { name?: string; at_mm?: Vec; radius_mm?: number }[];
  start_mm?: Vec;
}
export interface SceneNews {
  name?: string; problem?: string; kind?: 'ARM' | 'WALLS'; description?: string; scale?: number;
  rotation?: Vec; arm?: { link?: ArmLink[]; tip_mm?: number; mount?: PoseMm };
  workspace_low_mm?: Vec; workspace_high_mm?: Vec; body?: SceneBody[]; goal?: PoseMm[];
  map?: SceneMap; number?: string;
}
export interface ToPage {
  hello?: Hello; status?: StatusNews; scene?: SceneNews; reply?: PageReply; hand?: CursorNews;
}

export interface Tool {
  kind: 'POINT' | 'LINE' | 'PLANE' | 'N_ROTATION' | 'F_ROTATION';
  at_mm?: Vec; direction?: Vec; normal?: Vec; axis?: Vec; end_mm?: Vec; one_way?: boolean;
}
export interface Order {
  engage?: boolean; disengage?: boolean; clutch?: boolean; stop?: boolean; reset?: boolean;
  tool?: Tool; tool_off?: { position?: boolean; orientation?: boolean };
  scene_load?: string; stage?: string; lease?: { act: 'SHOW' | 'TAKE' | 'GRANT' | 'REFUSE' | 'RELEASE' };
  hold?: boolean; approach?: boolean; named_tool?: string; mark?: string; grip?: boolean; record?: { on: boolean; label?: string };
}
export type LeadAct = 'TAKE' | 'TAKE_OVER' | 'RELEASE';
export interface CursorOrder {
  sequence: number; position_mm: Vec; rotation_deg?: Vec; clutch?: boolean; drop_tool?: boolean;
  held: boolean;
}
export interface FromPage {
  request?: { id: number; order: Order };
  hand?: CursorOrder;
  lead?: { id: number; act: LeadAct };
  play?: PlayOrder & { id: number };
}
export interface Outcome { done: boolean; reason: string }
