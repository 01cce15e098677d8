/** Numbers as people type them: with a decimal point or comma, and any minus. */

/** Returns null where a text is no number. A text with both marks, as `1.000,5`, can be read in two ways and is none. */
export function readNumber(text: string): number | null {
  const plain = text.trim().replace(/^[−–]/, "-");
  if (!/^[-+]?(\d+([.,]\d*)?|[.,]\d+)(e[-+]?\d+)?$/i.test(plain)) return null;
  return Number(plain.replace(",", "."));
}
