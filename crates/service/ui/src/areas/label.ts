/** What is written on areas: all that each of them changes. */
import type { Area, Position } from "../api/areas";
import { inWords, KIND, kindOf } from "./effects";
import { middleOf } from "./shape";

export interface Label {
  words: string;
  /** The name of its colour in the style sheet. */
  ink: string;
  /** The place that it is written on. */
  at: Position;
}

export const labelsOf = (areas: Area[]): Label[] =>
  areas.map(({ properties, geometry }) => ({
    words: inWords(properties),
    ink: KIND[kindOf(properties)].color,
    at: middleOf(geometry),
  }));

/** Room that a line of text takes, with its rim [CSS pixels]. */
export const LABEL_PX = 20;

/** Sets how labels are written, so that they can be measured. */
export function setLabelStyle(context: CanvasRenderingContext2D): void {
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 4;
}

/** Writes a label about a point of a canvas. */
export function writeLabel(
  context: CanvasRenderingContext2D,
  { words, ink }: Label,
  color: (name: string) => string,
  x: number,
  y: number,
) {
  setLabelStyle(context);
  context.strokeStyle = color("casing");
  context.fillStyle = color(ink);
  context.strokeText(words, x, y);
  context.fillText(words, x, y);
}
