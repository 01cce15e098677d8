/** One number of a robot, with its unit, its range and what is wrong with it. */
import { useEffect, useState } from "preact/hooks";
import type { Robot } from "../api/robots";
import { readNumber } from "../number";
import { bounds, complaint, type Field } from "./fields";
import { changed, read } from "./pointer";
import { edited, problem, shown } from "./state";

/** As people write it: no `0.30000000000000004`. */
const written = (value: unknown) => (typeof value === "number" ? String(Number(value.toPrecision(6))) : "");

export function NumberField({ field }: { field: Field }) {
  const robot = shown.value;
  const value = read(robot, field.pointer);
  const [typed, setTyped] = useState<string | null>(null);
  const wrong = complaint(field, value) ?? problem.value?.at(field.pointer);
  const id = `field${field.pointer.replace(/[^a-z0-9]/gi, "-")}`;
  // A robot that is undone or chosen anew takes the place of what was typed.
  useEffect(() => {
    if (!edited.value) setTyped(null);
  }, [edited.value === null, robot?.name]);
  const change = (text: string) => {
    setTyped(text);
    const number = text.trim() === "" ? undefined : (readNumber(text) ?? NaN);
    edited.value = changed(robot as Robot, field.pointer, number);
    problem.value = null;
  };
  return (
    <div class="number-field" data-wrong={wrong !== undefined}>
      <label for={id}>{field.name}</label>
      <div class="number-box">
        <input
          id={id}
          type="text"
          inputMode="decimal"
          value={typed ?? written(value)}
          aria-invalid={wrong !== undefined}
          aria-describedby={`${id}-about`}
          onInput={(event) => change(event.currentTarget.value)}
          // What is no number stays as it was typed, beside what is wrong with it.
          onBlur={() => typed !== null && readNumber(typed) !== null && setTyped(null)}
        />
        <span>{field.unit}</span>
      </div>
      <small id={`${id}-about`}>{wrong ?? [field.about, bounds(field)].filter(Boolean).join("; ")}</small>
    </div>
  );
}
