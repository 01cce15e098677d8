/** What the selected area changes, or the next one to be drawn. */
import { useState } from "preact/hooks";
import type { AreaProperties } from "../api/areas";
import { words } from "../format";
import { readNumber } from "../number";
import { setEffect, shownKind } from "./edit";
import { KIND, KINDS, kindsOf, USUAL, type Kind } from "./effects";
import * as state from "./state";

/** How a kind's number is written: its unit, and how many of it the SI unit is. */
const NUMBER: Partial<Record<Kind, { label: string; unit: string; factor: number; about: string }>> = {
  max_speed_mps: { label: "Highest speed", unit: "m/s", factor: 1, about: "Above 0, up to 100" },
  cost_factor: { label: "Weighs", unit: "times", factor: 1, about: "0.1 to 1000; above 1 avoids the area" },
  one_way_rad: { label: "Direction", unit: "°", factor: 180 / Math.PI, about: "0 is east, 90 north" },
};

export function EffectFields() {
  const area = state.selectedArea.value;
  const kind = shownKind();
  const value = area ? area.properties[kind] : state.nextValue(kind);
  const usual = (next: Kind) => (next === "surface" ? state.nextValue("surface") : USUAL[next]);
  const others = area ? kindsOf(area.properties).filter((other) => other !== kind) : [];
  return (
    <>
      <label class="field">
        <span class="unseen">{area ? "Selected area" : "Next area"}</span>
        <select
          aria-label="Effect of the area"
          value={kind}
          onChange={(event) => {
            const next = event.currentTarget.value as Kind;
            setEffect(next, area ? usual(next) : state.nextValue(next));
          }}
        >
          {KINDS.map((each) => (
            <option key={each} value={each}>
              {KIND[each].name}
            </option>
          ))}
        </select>
      </label>
      {kind === "surface" && <SurfaceField value={String(value ?? "")} />}
      <NumberField key={`${state.selected.value} ${kind} ${value}`} kind={kind} value={value} />
      {others.length > 0 && <small>and {others.map((other) => KIND[other].name.toLowerCase()).join(", ")}</small>}
    </>
  );
}

function SurfaceField({ value }: { value: string }) {
  const names = state.surfaceNames.value;
  return (
    <select aria-label="Surface of the area" value={value} onChange={(event) => setEffect("surface", event.currentTarget.value)}>
      {(names.includes(value) || !value ? names : [...names, value]).map((name) => (
        <option key={name} value={name}>
          {words(name)}
        </option>
      ))}
    </select>
  );
}

function NumberField({ kind, value }: { kind: Kind; value: AreaProperties[Kind] }) {
  const [isWrong, setWrong] = useState(false);
  const written = NUMBER[kind];
  if (!written) return null;
  const { label, unit, factor, about } = written;
  const take = (text: string) => {
    const number = readNumber(text);
    setWrong(number === null);
    if (number !== null) setEffect(kind, number / factor);
  };
  return (
    <label class="field area-number" title={about}>
      <span class="unseen">{label}</span>
      <input
        type="text"
        inputMode="decimal"
        value={Number((Number(value) * factor).toFixed(3))}
        aria-invalid={isWrong}
        onChange={(event) => take(event.currentTarget.value)}
      />
      <span>{isWrong ? "no number" : unit}</span>
      <small>{about}</small>
    </label>
  );
}
