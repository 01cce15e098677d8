/** Whether the battery lasts there, or there and back, with the uncertainty of robot, battery and ground. */
import type { RangeAnswer } from "../api/missions";
import { turnsEarly } from "../map/markers";
import { energy, metres, percent } from "../format";
import { Choice } from "../widgets/choice";
import { ProblemCard } from "../widgets/problem_card";
import { Progress } from "../widgets/progress";
import { Swatch } from "./answer";
import { Lasts } from "./mission_answer";
import { chargeFault, isRangePlanning, rangeProblem } from "./mission";
import * as state from "./state";

export function RangeCard() {
  if (!state.comparison.value || !state.robot.value?.robot.battery) return null;
  return (
    <section class="range" aria-label="Does the battery last?" aria-busy={isRangePlanning.value}>
      <div class="range-head">
        <h3>Does the battery last?</h3>
        <Choice
          label="Does the battery last"
          value={state.rangeKind.value ?? "none"}
          choose={(kind) => (state.rangeKind.value = kind === "none" ? null : kind)}
          options={[
            { value: "none", name: "–" },
            { value: "there", name: "There" },
            { value: "return", name: "There and back" },
          ]}
        />
      </div>
      {isRangePlanning.value && <Progress label="Driving it a thousand times" share={null} />}
      {rangeProblem.value && state.rangeKind.value && <ProblemCard problem={rangeProblem.value} />}
      {chargeFault.value && state.rangeKind.value && <p role="status">{chargeFault.value}</p>}
      <Found />
    </section>
  );
}

/** The way home is drawn from the goal; the last place to turn back may come before. */
function turningWords({ distance_m, charge_at_home }: NonNullable<RangeAnswer["turning_point"]>, range: RangeAnswer): string {
  if (!turnsEarly(range))
    return `Way back. The robot may turn back as late as at the goal, and is home with ${percent(charge_at_home, 1)}.`;
  return `Way back. The last place to turn back (T) is ${metres(distance_m)} along the way: from there it is home with ${percent(charge_at_home, 1)}.`;
}

function Found() {
  const range = state.range.value;
  if (!range || !state.rangeKind.value) return null;
  const { turning_point: turning, best_speed: best, energy_j, distance_m } = range;
  return (
    <>
      <Lasts of={range} isFine={range.reachable} />
      <p>
        {`${metres(distance_m)} take ${energy(energy_j.p50)}; nine in ten such drives ${energy(energy_j.p05)} to ${energy(energy_j.p95)}.`}
      </p>
      {range.legs.length > 1 && (
        <p>
          <Swatch name="back" />{" "}
          {turning ? turningWords(turning, range) : "There is no place to turn back from: the battery does not last."}
        </p>
      )}
      {best.saving_j > 0.01 * energy_j.p50 && (
        <p>{`At ${best.speed_mps.toFixed(2)}\u202fm/s the same way would take ${energy(best.saving_j)} less.`}</p>
      )}
    </>
  );
}
