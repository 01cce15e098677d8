/** Recordings at hand, the job under way, and its report. */
import { computed, signal } from "@preact/signals";
import { announce } from "../announce";
import { cancelJob, follow, startDiagnosis, type KnownJob } from "../api/jobs";
import { problemOf, type Problem } from "../api/problem";
import { lookInto, storeRecording, type StoredRecording } from "../api/recordings";
import type { RecordingMap } from "../columns/recording_map";
import { beginningOf, titleOf, type Column } from "../columns/table";
import * as plan from "../plan/state";
import { accept as acceptRobot } from "./accept";
import type { Report } from "./report";

export type Role = "suspect" | "healthy";

/** A file that was dropped: on its way, read, or refused. */
export interface Taken {
  key: number;
  name: string;
  bytes: number;
  role: Role;
  share: number;
  /** Whether it is part of what is asked. */
  isUsed: boolean;
  /** What was dropped; none of a stored recording. */
  file?: File;
  /** Its beginning as columns, or as fields of topics. */
  columns?: Column[];
  /** What was said of its columns on the page, where anything was. */
  map?: RecordingMap;
  recording?: StoredRecording;
  problem?: Problem;
}

export const taken = signal<Taken[]>([]);
/** The job; of one that a link names only the id is known at first. */
export const job = signal<KnownJob<Report> | null>(null);
export const problem = signal<Problem | null>(null);
export const robotId = signal<string | null>(null);
/** The ground that was driven, where recordings do not name it; null: the robot's default. */
export const ground = signal<string | null>(null);

/** The robot that drove, on the ground that was chosen. */
export const drove = computed(() => {
  const id = robotId.value ?? plan.robotId.value;
  const robot = plan.robots.value?.find((known) => known.id === id)?.robot;
  const chosen = robot && ground.value !== null && ground.value in robot.surfaces ? ground.value : null;
  return { id, robot, ground: chosen, asked: robot && chosen !== null ? { ...robot, default_surface: chosen } : id };
});

let count = 0;

function change(key: number, with_: Partial<Taken>): void {
  taken.value = taken.value.map((one) => (one.key === key ? { ...one, ...with_ } : one));
}

/** Columns as they were picked before, by the header that they were picked for. */
const picked = new Map<string, RecordingMap>();

const headerOf = (columns: Column[]) => JSON.stringify(columns.map(titleOf));

export function take(files: File[], role: Role): void {
  for (const file of files) {
    const key = count++;
    taken.value = [...taken.value, { key, name: file.name, bytes: file.size, role, share: 0, isUsed: true, file }];
    void beginningOf(file, lookInto)
      .catch(() => null)
      .then((columns) => {
        const map = columns ? picked.get(headerOf(columns)) : undefined;
        change(key, { ...(columns && { columns }), ...(map && { map }) });
        send(key, file, map);
      });
  }
}

/** Sends a file to be read, by a map where its columns were picked. */
function send(key: number, file: File, map: RecordingMap | undefined): void {
  storeRecording(file, map, (share) => change(key, { share })).then(
    (recording) => {
      change(key, { recording });
      announce(`${file.name} is read: ${recording.rows} rows.`);
    },
    (thrown) => change(key, { problem: problemOf(thrown) }),
  );
}

/** Recordings of the same columns as one, itself among them, that could not be read or were read as was said on the page. */
export function alike(key: number): Taken[] {
  const header = headerOf(taken.value.find((one) => one.key === key)?.columns ?? []);
  return taken.value.filter(
    (one) => one.file && (one.key === key || ((one.problem || one.map) && one.columns && headerOf(one.columns) === header)),
  );
}

/** Reads a file by the columns that were picked, and with it all that are alike. */
export function readAs(key: number, map: RecordingMap): void {
  picked.set(headerOf(taken.value.find((one) => one.key === key)?.columns ?? []), map);
  const again = alike(key);
  const keys = again.map((one) => one.key);
  taken.value = taken.value.map((one) => {
    if (!keys.includes(one.key)) return one;
    const { problem: _problem, recording: _recording, ...rest } = one;
    return { ...rest, map, share: 0 };
  });
  for (const { key: each, file } of again) if (file) send(each, file, map);
}

export function takeStored(recording: StoredRecording, role: Role): void {
  const name = `${recording.report.source}.${recording.format}`;
  taken.value = [...taken.value, { key: count++, name, bytes: recording.bytes, role, share: 1, isUsed: true, recording }];
}

/** Takes a recording into what is asked next, or leaves it out for now. */
export const use = (key: number, isUsed: boolean) => change(key, { isUsed });

export function leave(key: number): void {
  taken.value = taken.value.filter((one) => one.key !== key);
}

export const idsOf = (role: Role) =>
  taken.value.flatMap((one) => (one.role === role && one.isUsed && one.recording ? [one.recording.id] : []));

export async function begin(): Promise<void> {
  problem.value = null;
  try {
    job.value = await startDiagnosis<Report>({ robot: drove.value.asked, recordings: idsOf("suspect"), reference: idsOf("healthy") });
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

export async function cancel(): Promise<void> {
  const { id } = job.value ?? {};
  if (!id) return;
  await cancelJob<Report>(id).catch((thrown: unknown) => (problem.value = problemOf(thrown)));
}

/** Back to the recordings. */
export function again(): void {
  job.value = null;
  problem.value = null;
}

/** Stores the corrected robot and plans with it, beside the path of the robot before. */
export async function accept(report: Report): Promise<void> {
  problem.value = null;
  try {
    await acceptRobot(report.robot, "corrected", drove.value);
  } catch (thrown) {
    problem.value = problemOf(thrown);
  }
}

export const followDiagnosis = () => follow(job, problem, ({ sentence }) => announce(sentence));
