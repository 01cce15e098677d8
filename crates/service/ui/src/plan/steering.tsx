/** How the path is steered: what the robot is not to do, and what else counts. Only what differs from the service's own is asked. */
import { computed, signal } from "@preact/signals";
import { useState } from "preact/hooks";
import type { Place, Steering } from "../api/plans";
import { readNumber } from "../number";
import { goal } from "./state";

export const mayReverse = signal(false);
export const forbidsSpin = signal(false);
/** Null: what the service takes by itself. */
export const leastRadius_m = signal<number | null>(null);
export const weighsStops = signal(false);
export const isPartial = signal(false);
export const isEitherWay = signal(false);

/** The steering as the service takes it. */
export const steering = computed<Steering>(() => ({
  ...(mayReverse.value && { reverse: true as const }),
  ...(forbidsSpin.value && { forbid: ["spin" as const] }),
  ...(leastRadius_m.value !== null && { least_radius_m: leastRadius_m.value }),
  ...(weighsStops.value && { prices: { stops: true as const } }),
  ...(isPartial.value && { partial: true as const }),
}));

/** The goal, for which the opposite heading may do too. */
export const steeredGoal = (place: Place) =>
  isEitherWay.value && place.heading_rad !== undefined ? { ...place, heading: "either" as const } : place;

const CHECKS = [
  { of: mayReverse, name: "Allow reversing", about: "The robot may back up" },
  { of: forbidsSpin, name: "No turns on the spot", about: "It drives arcs only" },
  { of: weighsStops, name: "Weigh stops", about: "Slowing down and speeding up count as energy" },
  { of: isPartial, name: "Partial path", about: "Where nothing leads to the goal: as near to it as can be" },
];

export function SteeringOptions() {
  const hasHeading = goal.value?.heading_rad !== undefined;
  const count = CHECKS.filter(({ of }) => of.value).length + Number(leastRadius_m.value !== null) + Number(isEitherWay.value && hasHeading);
  return (
    <details class="steering">
      <summary>{count > 0 ? `Options (${count} chosen)` : "Options"}</summary>
      <div>
        {CHECKS.map(({ of, name, about }) => (
          <Check key={name} name={name} about={about} isOn={of.value} set={(isOn) => (of.value = isOn)} />
        ))}
        <Check
          name="Goal heading either way"
          about={hasHeading ? "The opposite heading will do too" : "Drag from the goal to give it a heading first"}
          isOn={isEitherWay.value}
          isOff={!hasHeading}
          set={(isOn) => (isEitherWay.value = isOn)}
        />
        <Radius />
      </div>
    </details>
  );
}

interface CheckProps {
  name: string;
  about: string;
  isOn: boolean;
  isOff?: boolean;
  set: (isOn: boolean) => void;
}

function Check({ name, about, isOn, isOff = false, set }: CheckProps) {
  const id = `steering-${name.toLowerCase().replaceAll(" ", "-")}`;
  return (
    <div class="check">
      <input
        id={id}
        type="checkbox"
        checked={isOn}
        disabled={isOff}
        aria-describedby={`${id}-about`}
        onChange={(event) => set(event.currentTarget.checked)}
      />
      <div>
        <label for={id}>{name}</label>
        <small id={`${id}-about`}>{about}</small>
      </div>
    </div>
  );
}

function Radius() {
  const [wrong, setWrong] = useState<string | null>(null);
  const take = (text: string) => {
    const number = text.trim() === "" ? null : (readNumber(text) ?? NaN);
    const isNumber = number === null || number >= 0;
    setWrong(isNumber ? null : "Give metres from 0 up, or nothing.");
    if (isNumber) leastRadius_m.value = number;
  };
  return (
    <div class="number-field" data-wrong={wrong !== null}>
      <label for="least-radius">Least turning radius</label>
      <div class="number-box">
        <input
          id="least-radius"
          type="text"
          inputMode="decimal"
          value={leastRadius_m.value ?? ""}
          aria-invalid={wrong !== null}
          aria-describedby="least-radius-about"
          onChange={(event) => take(event.currentTarget.value)}
        />
        <span>m</span>
      </div>
      <small id="least-radius-about">{wrong ?? "0 or more; above 0 there are no turns on the spot"}</small>
    </div>
  );
}
