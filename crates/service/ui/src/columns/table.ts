/** The beginning of a log as columns, to show what is in it. The service reads the whole file by its own rules, and looks into what is no text. */

export interface Column {
  name: string;
  /** The topic, of a field of a bag's messages. */
  topic?: string;
  /** As they stand in the file. */
  cells: string[];
}

/** So much of a file is looked at [bytes]. */
const LOOKED_AT = 400_000;
/** Names of files that hold text in columns, compressed or not. */
const TEXT = /\.(csv|tsv|txt)(\.gz)?$/i;

const isTable = (name: string) => TEXT.test(name);
/** Logs that are read front to back: their beginning shows what is in them. Of others the end or all is needed. */
const FRONT_TO_BACK = /\.(mcap|bag|ulg)$/i;
const BINARY = /\.(parquet|mcap|bag|db3|ulg)$/i;
/** So much of a log that is read front to back is sent to be looked into [bytes]. */
const SENT = 16 << 20;

/** Asks the service what is in a file by its beginning. */
type LookInto = (name: string, beginning: Blob) => Promise<Column[]>;

/** Reads the beginning of a file; null where it has no columns. */
export async function beginningOf(file: File, lookInto: LookInto): Promise<Column[] | null> {
  if (BINARY.test(file.name)) {
    const columns = await lookInto(file.name, FRONT_TO_BACK.test(file.name) ? file.slice(0, SENT) : file);
    return columns.length > 0 ? columns : null;
  }
  if (!isTable(file.name)) return null;
  const beginning = /\.gz$/i.test(file.name) ? await unpacked(file) : await file.slice(0, LOOKED_AT).text();
  return columnsOf(beginning, file.size > LOOKED_AT);
}

async function unpacked(file: File): Promise<string> {
  const reader = file.stream().pipeThrough(new DecompressionStream("gzip")).getReader();
  const decoder = new TextDecoder();
  let text = "";
  while (text.length < LOOKED_AT) {
    const { done, value } = await reader.read();
    if (done) break;
    text += decoder.decode(value, { stream: true });
  }
  await reader.cancel();
  return text;
}

const SEPARATORS = [",", ";", "\t", "|"];

/** The columns of a text; its last line is left out where the text is cut. */
export function columnsOf(text: string, isCut: boolean): Column[] | null {
  const lines = text
    .replace(/^\uFEFF/, "")
    .split(/\r?\n|\r/)
    .filter((line) => line.trim() !== "" && !/^\s*(#|%|\/\/|sep=)/.test(line));
  if (isCut) lines.pop();
  const [header, ...rows] = lines;
  if (header === undefined || rows.length === 0) return null;
  const count = (separator: string) => cellsOf(header, separator).length;
  const separator = SEPARATORS.reduce((best, each) => (count(each) > count(best) ? each : best));
  const names = cellsOf(header, separator);
  if (names.length < 2) return null;
  const cells = rows.map((row) => cellsOf(row, separator));
  return names.map((name, i) => ({ name, cells: cells.map((row) => row[i] ?? "") }));
}

/** Cells of a line; within quotes separators stand for themselves, and a doubled quote for one. */
function cellsOf(line: string, separator: string): string[] {
  const cells: string[] = [];
  let [cell, isQuoted] = ["", false];
  for (let i = 0; i < line.length; i++) {
    const character = line[i];
    if (isQuoted && character === '"' && line[i + 1] === '"') {
      cell += '"';
      i++;
    } else if (character === '"') isQuoted = !isQuoted;
    else if (character === separator && !isQuoted) {
      cells.push(cell.trim());
      cell = "";
    } else cell += character;
  }
  return [...cells, cell.trim()];
}

/** What a column is called: of a field, with its topic. */
export const titleOf = ({ name, topic }: Column) => (topic ? `${topic} ${name}` : name);

/** Whether columns are fields of topics, of which each has its own times. */
export const isOfTopics = (columns: Column[]) => columns.some(({ topic }) => topic !== undefined);

/** A cell as a number; NaN where it is none. */
export function numberOf(cell: string): number {
  const plain = /^[-+]?\d*,\d+(e[-+]?\d+)?$/i.test(cell) ? cell.replace(",", ".") : cell;
  return plain === "" ? NaN : Number(plain);
}

/** A date with a time, as `2025-11-28T14:00:00Z`. */
export const isDate = (cell: string) => /^\d{4}-\d\d-\d\d[T ]\d\d:\d\d/.test(cell);
