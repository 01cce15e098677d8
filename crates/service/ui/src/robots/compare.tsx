/** Two robots side by side: what differs between their files, and a plan with both. */
import { signal } from "@preact/signals";
import type { Robot } from "../api/robots";
import * as plan from "../plan/state";
import { tab } from "../tab";
import { words } from "../format";
import { GROUPS, surfaceFields } from "./fields";
import { read } from "./pointer";
import { knownShown } from "./state";

/** The robot beside the shown one; null while none is. */
const otherId = signal<string | null>(null);

interface Difference {
  name: string;
  unit: string;
  one: unknown;
  other: unknown;
}

/** Fields of which two robots have different values, those of grounds that either has among them. */
export function differences(one: Robot, other: Robot): Difference[] {
  const grounds = [...new Set([...Object.keys(one.surfaces), ...Object.keys(other.surfaces)])];
  const groups = [...GROUPS, ...grounds.map((name) => ({ name: words(name), fields: surfaceFields(name) }))];
  return groups.flatMap(({ name: group, fields }) =>
    fields.flatMap(({ pointer, name, unit }) => {
      const [a, b] = [read(one, pointer), read(other, pointer)];
      return a === b ? [] : [{ name: `${group}: ${name}`, unit, one: a, other: b }];
    }),
  );
}

const shown = (value: unknown) => (typeof value === "number" ? String(Number(value.toPrecision(6))).replace("-", "\u2212") : "–");

export function Compare({ robot }: { robot: Robot }) {
  const others = plan.robots.value?.filter(({ id }) => id !== knownShown.value?.id) ?? [];
  const other = others.find(({ id }) => id === otherId.value);
  if (others.length === 0) return null;
  return (
    <section class="robot-compare" aria-label="Compare robots">
      <label class="field">
        <span>Compare with</span>
        <select value={other?.id ?? ""} onChange={(event) => (otherId.value = event.currentTarget.value || null)}>
          <option value="">no other robot</option>
          {others.map(({ id, robot: each, isStored }) => (
            <option key={id} value={id}>
              {each.name}
              {isStored ? ` · stored ${id.slice(0, 6)}` : ""}
            </option>
          ))}
        </select>
      </label>
      {other && <Table one={robot} other={other.robot} />}
      {other && (
        <button type="button" onClick={() => planWithBoth(other.id)}>
          Plan with both
        </button>
      )}
    </section>
  );
}

function Table({ one, other }: { one: Robot; other: Robot }) {
  const list = differences(one, other);
  if (list.length === 0) return <p>Their parameters are the same.</p>;
  return (
    <div class="table-scroll" tabIndex={0} role="region" aria-label="Differences">
      <table>
        <thead>
          <tr>
            <th scope="col">Parameter</th>
            <th scope="col">{one.name}</th>
            <th scope="col">{other.name}</th>
          </tr>
        </thead>
        <tbody>
          {list.map(({ name, unit, one: a, other: b }) => (
            <tr key={name}>
              <th scope="row">
                {name} <small>{unit}</small>
              </th>
              <td>{shown(a)}</td>
              <td>{shown(b)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** The plan of the shown robot, with the energy-minimal path of the other beside it. */
function planWithBoth(other: string): void {
  const id = knownShown.value?.id;
  if (!id) return;
  plan.robotId.value = id;
  plan.formerId.value = other;
  tab.value = "plan";
}
