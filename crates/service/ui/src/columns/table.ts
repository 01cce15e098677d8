/** The beginning of a CSV file as columns, to show what is in it. The service reads the whole file by its own rules. */

export interface Column {
  name: string;
  /** As they stand in the file. */
  cells: string[];
}

/** So much of a file is looked at [bytes]. */
const LOOKED_AT = 400_000;
/** Names of files that hold text in columns, compressed or not. */
const TEXT = /\.(csv|tsv|txt)(\.gz)?$/i;

export const isTable = (name: string) => TEXT.test(name);

/** Reads the beginning of a file; null where it has no columns. */
export async function beginningOf(file: File): Promise<Column[] | null> {
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

/** A cell as a number; NaN where it is none. */
export function numberOf(cell: string): number {
  const plain = /^[-+]?\d*,\d+(e[-+]?\d+)?$/i.test(cell) ? cell.replace(",", ".") : cell;
  return plain === "" ? NaN : Number(plain);
}

/** A date with a time, as `2025-11-28T14:00:00Z`. */
export const isDate = (cell: string) => /^\d{4}-\d\d-\d\d[T ]\d\d:\d\d/.test(cell);
