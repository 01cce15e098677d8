/** The answer: one sentence, three paths side by side, and the charge that is left. */
import type { Objective, Plan } from "../api/plans";
import { OBJECTIVES } from "../api/plans";
import { clock, energy, energyUnit, metres, percent, type EnergyUnit } from "../format";
import { STYLE } from "../map/draw";
import { ProblemCard } from "../widgets/problem_card";
import { Progress } from "../widgets/progress";
import { Warnings } from "../widgets/warnings";
import { arrivalCharge } from "./charge";
import { followsAnswer } from "./slow";
import * as state from "./state";

export function Answer() {
  const plans = state.comparison.value;
  if (state.problem.value) return <ProblemCard problem={state.problem.value} />;
  if (!plans) return <NoAnswer />;
  const unit = energyUnit(plans.distance.energy_j);
  return (
    <section
      class="answer"
      aria-label="Paths compared"
      aria-busy={state.isPlanning.value}
      data-slow={followsAnswer.value && !state.isDragging.value}
    >
      {followsAnswer.value && <progress class="answer-wait" aria-label="Planning" />}
      <Headline />
      <div class="answer-scroll">
        <table>
          <caption class="unseen">
            Energy-minimal, shortest and fastest paths. Choose one to follow it on the map and in the charts.
          </caption>
          <thead>
            <tr>
              <th scope="col">Path</th>
              <th scope="col">
                Energy <small>{unit.name}</small>
              </th>
              <th scope="col">
                Time <small>min</small>
              </th>
              <th scope="col">
                Length <small>m</small>
              </th>
              <th scope="col">
                Climb <small>m</small>
              </th>
            </tr>
          </thead>
          <tbody>
            {OBJECTIVES.map((objective) => (
              <Row key={objective} objective={objective} plan={plans[objective]} unit={unit} />
            ))}
            {state.former.value && <Figures name="former" plan={state.former.value} unit={unit} />}
          </tbody>
        </table>
      </div>
      <Charge plan={plans[state.focus.value]} />
      <Warnings label="Doubts about the path" list={ofPath(plans[state.focus.value])} />
      <Proof />
    </section>
  );
}

function NoAnswer() {
  const [start, goal] = [state.start.value, state.goal.value];
  if (start && goal) {
    return (
      <section class="answer answer-none" aria-label="Paths compared" aria-busy={state.isPlanning.value}>
        <Progress label="Planning" share={null} />
      </section>
    );
  }
  return (
    <section class="answer answer-none" aria-label="Paths compared">
      <p class="answer-big">Where to?</p>
      <p>{start ? "Now click where it is to go." : "Click the map where the robot starts. Drag as you click to set its heading."}</p>
    </section>
  );
}

function Headline() {
  const plans = state.comparison.value;
  if (!plans) return null;
  const { energy: best, distance: shortest } = plans;
  const further_m = best.distance_m - shortest.distance_m;
  const saved = plans.saving_fraction;
  const detour = further_m > 0.5 ? `by driving ${metres(further_m)} further` : "at the same length";
  const small = Math.abs(saved) < 0.0005;
  const isMore = saved <= -0.0005;
  return (
    <header class="answer-head">
      <p class="answer-big">
        <span class="number">{energy(best.energy_j)}</span>
        {!small && !isMore && <span class="answer-saving">{percent(saved)} less</span>}
      </p>
      <p>
        {isMore
          ? `This path takes ${energy(best.energy_j - shortest.energy_j)} more than the shortest: areas or options weigh more than energy alone.`
          : small
            ? "The shortest path is also the energy-minimal one."
            : `The energy-minimal path saves ${energy(shortest.energy_j - best.energy_j)} against the shortest, ${detour}.`}
      </p>
      {best.short_of_goal_m !== undefined && (
        <p class="short-of-goal">No path leads to the goal: this one ends {metres(best.short_of_goal_m)} short of it.</p>
      )}
      <Correction now={best} />
    </header>
  );
}

/** What a correction of the robot has changed. */
function Correction({ now }: { now: Plan }) {
  const before = state.former.value;
  if (!before) return null;
  const more_j = now.energy_j - before.energy_j;
  const size = `${energy(Math.abs(more_j))} (${percent(Math.abs(more_j / before.energy_j), 1)})`;
  const way = more_j < 0 ? "less" : "more";
  return (
    <p class="correction">
      {state.isCorrection.value
        ? `With the corrected robot ${size} ${way} than its file predicted before.`
        : `${size} ${way} than ${state.formerRobot.value?.robot.name ?? "the other robot"} takes.`}
    </p>
  );
}

interface RowProps {
  plan: Plan;
  unit: EnergyUnit;
}

function Row({ objective, ...row }: RowProps & { objective: Objective }) {
  return <Figures name={objective} isChosen={state.focus.value === objective} choose={() => (state.focus.value = objective)} {...row} />;
}

function Figures({ name, plan, unit, isChosen, choose }: RowProps & { name: keyof typeof STYLE; isChosen?: boolean; choose?: () => void }) {
  const written = (value_j: number) => (value_j / unit.joules).toFixed(1);
  const [low, high] = plan.energy_interval_j;
  const label = (
    <>
      <Swatch name={name} />
      {name === "former" && !state.isCorrection.value ? (state.formerRobot.value?.robot.name ?? "Other robot") : STYLE[name].name}
    </>
  );
  return (
    <tr data-chosen={isChosen} onClick={choose}>
      <th scope="row">
        {choose ? (
          <button type="button" aria-pressed={isChosen}>
            {label}
          </button>
        ) : (
          <span class="row-name">{label}</span>
        )}
      </th>
      <td>
        <b>{written(plan.energy_j)}</b>
        <small title="95 % interval, from what is not known of the robot exactly">
          {written(low)} – {written(high)}
        </small>
      </td>
      <td>{clock(plan.duration_s)}</td>
      <td>{plan.distance_m.toFixed(plan.distance_m < 100 ? 1 : 0)}</td>
      <td>{plan.climb_m.toFixed(plan.climb_m < 10 ? 1 : 0)}</td>
    </tr>
  );
}

/** The path's line as it is on the map. */
export function Swatch({ name }: { name: keyof typeof STYLE }) {
  const { color, dash } = STYLE[name];
  return (
    <svg class="swatch" viewBox="0 0 26 8" width="26" height="8" aria-hidden="true">
      <line
        x1="2"
        y1="4"
        x2="24"
        y2="4"
        stroke={`var(--${color})`}
        stroke-width="3.5"
        stroke-linecap="round"
        stroke-dasharray={dash.map((length) => length * 0.7).join(" ") || undefined}
      />
    </svg>
  );
}

function Charge({ plan }: { plan: Plan }) {
  const robot = state.robot.value?.robot;
  const left = robot && arrivalCharge(plan, robot, state.charge.value);
  if (!left) return null;
  const fine = left.least >= left.reserve;
  const share = (charge: number) => `${100 * Math.max(0, charge)}%`;
  const words = left.charge < 0 ? "The battery is empty before the goal." : fine ? "" : `Below the reserve of ${percent(left.reserve)}.`;
  return (
    <div class="charge" data-fine={fine}>
      <span>Arrives with</span>
      <b class="number">{percent(Math.max(left.charge, 0), 1)}</b>
      <div
        class="charge-bar"
        role="img"
        aria-label={`Charge at the goal between ${percent(left.least, 1)} and ${percent(left.greatest, 1)}, reserve ${percent(left.reserve)}`}
      >
        <i style={{ width: share(left.charge) }} />
        <em style={{ left: share(left.reserve) }} />
      </div>
      {words && <small>{words}</small>}
    </div>
  );
}

/** What is proven of the energy-minimal path of the lattice, and what the shown one, which leaves the lattice, takes less. */
function Proof() {
  const path = state.comparison.value?.energy;
  if (!path) return null;
  const search = path.search;
  const lattice = energy(path.lattice_energy_j);
  const within = search.bound === null ? `at most ${energy(search.excess_at_most)} above` : `within ${percent(search.bound - 1)} of`;
  const near = `Proven: ${lattice} on the planner's lattice is ${within} the least`;
  const text = search.optimal
    ? `Proven: no path of the planner's lattice takes less than ${lattice}.`
    : state.isDragging.value
      ? `${near}, which follows.`
      : `${near}.`;
  const freed_j = path.lattice_energy_j - path.energy_j;
  const freed = freed_j > 0 ? ` Freed from the lattice, the path shown takes ${energy(freed_j)} less.` : "";
  const cut = path.finished === false ? " Time ran out while it was freed from the lattice." : "";
  return <p class="proof">{`${search.timed_out ? "Time ran out. " : ""}${text}${freed}${cut}`}</p>;
}

/** The doubts about a path that are not of its map, which stand beside the map. */
function ofPath(plan: Plan) {
  const ofMap = state.map.value?.warnings ?? [];
  return plan.warnings.filter(({ kind }) => !ofMap.some((other) => other.kind === kind));
}
