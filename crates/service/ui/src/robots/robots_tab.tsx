/** The Robots tab: which there are, and one of them to look at and edit. */
import type { Robot } from "../api/robots";
import { loadProblem } from "../plan/load";
import { Unreachable } from "../plan/plan_tab";
import { saveFile } from "../plan/downloads";
import * as plan from "../plan/state";
import { words } from "../format";
import { DropZone } from "../widgets/drop_zone";
import { GuideLink } from "../widgets/guide_link";
import { ProblemCard } from "../widgets/problem_card";
import { Progress } from "../widgets/progress";
import { complaint, GROUPS, mechanismGroups, surfaceFields, type FieldGroup } from "./fields";
import { NumberField } from "./number_field";
import { escaped, read } from "./pointer";
import { Compare } from "./compare";
import { choose, deletingId, edited, isSaving, knownShown, mechanismRanges, open, problem, remove, save, shown, use } from "./state";

export function RobotsTab() {
  if (loadProblem.value && !plan.robots.value) return <Unreachable />;
  if (!plan.robots.value) return <Progress label="Fetching the robots" share={null} />;
  return (
    <div class="robots">
      <aside class="robot-list" aria-label="Robots">
        <h2>Robots</h2>
        <ul>
          {plan.robots.value.map(({ id, robot, isStored }) => (
            <li key={id}>
              <button type="button" aria-current={knownShown.value?.id === id ? "true" : undefined} onClick={() => choose(id)}>
                <b>{robot.name}</b>
                <small>
                  {robot.mass_kg.toFixed(0)} kg · {isStored ? `stored ${id.slice(0, 6)}` : "built in"}
                </small>
              </button>
            </li>
          ))}
        </ul>
        <DropZone label="Add a robot's file" accept=".json" take={(files) => files[0] && void open(files[0])}>
          <span>
            JSON, as “Download” and <code>joulepath robot new</code> write it
          </span>
        </DropZone>
        <p>
          <GuideLink chapter="robots">Describe your own robot</GuideLink>
        </p>
      </aside>
      {shown.value && <Editor robot={shown.value} />}
    </div>
  );
}

function Editor({ robot }: { robot: Robot }) {
  const surfaces = Object.keys(robot.surfaces ?? {});
  const grounds = surfaces.flatMap((name): FieldGroup[] => {
    const own = mechanismGroups(robot.surfaces[name]?.mechanisms, `/surfaces/${escaped(name)}`, mechanismRanges.value);
    const group = { name: `Ground: ${words(name)}`, fields: surfaceFields(name) };
    return [group, ...own.map((mechanism) => ({ ...mechanism, name: `${words(name)}: ${mechanism.name}` }))];
  });
  const groups: FieldGroup[] = [...mechanismGroups(robot.mechanisms, "", mechanismRanges.value), ...GROUPS, ...grounds];
  const wrong = groups.flatMap(({ fields }) => fields).filter((field) => complaint(field, read(robot, field.pointer)));
  return (
    <form
      class="robot-editor"
      aria-label={`Parameters of ${robot.name}`}
      onSubmit={(event) => {
        event.preventDefault();
        void save();
      }}
    >
      <header>
        <label class="robot-name">
          <span class="unseen">Name</span>
          <input type="text" value={robot.name} onInput={(event) => (edited.value = { ...robot, name: event.currentTarget.value })} />
        </label>
        <div class="robot-acts">
          <button
            type="button"
            onClick={() => saveFile(new Blob([JSON.stringify(robot, null, 2)], { type: "application/json" }), `${robot.name}.json`)}
          >
            Download
          </button>
          {edited.value && (
            <button type="button" onClick={() => choose(knownShown.value?.id ?? "")}>
              Undo
            </button>
          )}
          {knownShown.value?.isStored && !edited.value && (
            <button type="button" class="delete" onClick={() => void remove()}>
              {deletingId.value === knownShown.value.id ? "Delete for good" : "Delete"}
            </button>
          )}
          {edited.value ? (
            <button type="submit" class="primary" disabled={isSaving.value || wrong.length > 0}>
              Save as new
            </button>
          ) : (
            <button type="button" class="primary" onClick={use}>
              Plan with it
            </button>
          )}
        </div>
      </header>
      {problem.value && <ProblemCard problem={problem.value} />}
      {edited.value && wrong.length > 0 && (
        <p class="robot-wrong" role="status">
          To save, mend {wrong.map((field) => field.name).join(", ")}.
        </p>
      )}
      {!edited.value && <Compare robot={robot} />}
      <div class="robot-groups">
        {groups.map((group) => (
          <fieldset key={group.name}>
            <legend>{group.name}</legend>
            {group.fields.map((field) => (
              <NumberField key={field.pointer} field={field} />
            ))}
          </fieldset>
        ))}
      </div>
      <DefaultSurface robot={robot} surfaces={surfaces} />
    </form>
  );
}

function DefaultSurface({ robot, surfaces }: { robot: Robot; surfaces: string[] }) {
  return (
    <label class="field robot-ground">
      <span>Ground that a map leaves open</span>
      <select value={robot.default_surface} onChange={(event) => (edited.value = { ...robot, default_surface: event.currentTarget.value })}>
        {surfaces.map((name) => (
          <option key={name} value={name}>
            {words(name)}
          </option>
        ))}
      </select>
    </label>
  );
}
