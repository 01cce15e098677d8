/** Recordings and what reading them found. */
import type { RecordingMap } from "../columns/recording_map";
import type { Column } from "../columns/table";
import { ask, send } from "./ask";
import { recordingType, upload } from "./upload";

export interface ReadingReport {
  source: string;
  format: string;
  rows: number;
  power_form: string | null;
  runs: { run: string; rows: number; duration_s: number; rate_hz: number | null; gaps: number; longest_gap_s: number | null }[];
  channels: { channel: string; from: string; unit: string; present: number; gaps: number; least: number; greatest: number }[];
  aside: string[];
  ignored: { name: string; reason: string }[];
  repairs: { place: string; what: string }[];
  suspicions: { channel: string; run?: string | null; statement: string }[];
}

export interface RecordingSummary {
  id: string;
  format: string;
  bytes: number;
  rows: number;
  runs: string[];
}

export type StoredRecording = RecordingSummary & { report: ReadingReport };

export const listRecordings = async () => (await ask<{ recordings: RecordingSummary[] }>("/v1/recordings")).recordings;
export const readRecording = (id: string) => ask<StoredRecording>(`/v1/recordings/${id}`);

/** Stores a recording, read by a map where one is given; its runs are called after the file where it does not name them itself. */
export function storeRecording(file: File, map: RecordingMap | undefined, tell: (share: number) => void): Promise<StoredRecording> {
  const name = file.name.replace(/\.[^.]*$/, "");
  const query = new URLSearchParams({ name, ...(map && { map: JSON.stringify(map) }) });
  return upload<StoredRecording>(`/v1/recordings?${query}`, file, recordingType(file.name), tell);
}

/** The first values of the columns of a log, or of the fields of its topics; the service stores nothing of it. */
export async function lookInto(name: string, beginning: Blob): Promise<Column[]> {
  const response = await send("/v1/recordings/columns", { bytes: beginning, headers: { "content-type": recordingType(name) } });
  return ((await response.json()) as { columns: Column[] }).columns;
}
