/** The answer for several stops: their order, when and on what charge each is reached, and whether the battery lasts. */
import type { Mission, MissionStop, Spread } from "../api/missions";
import { clock, duration, energy, metres, percent } from "../format";
import { ProblemCard } from "../widgets/problem_card";
import { Progress } from "../widgets/progress";
import { Warnings } from "../widgets/warnings";
import { chargeFault, isMissionPlanning } from "./mission";
import * as state from "./state";

export function MissionAnswer() {
  const mission = state.mission.value;
  if (state.problem.value) return <ProblemCard problem={state.problem.value} />;
  if (!mission) return <NoMission />;
  return (
    <section class="answer mission" aria-label="Mission" aria-busy={isMissionPlanning.value} data-slow={isMissionPlanning.value}>
      {isMissionPlanning.value && <progress class="answer-wait" aria-label="Planning" />}
      <header class="answer-head">
        <p class="answer-big">
          <span class="number">{energy(mission.energy_j.p50)}</span>
        </p>
        <p>
          {`${mission.stops.length - 1} ways, ${metres(mission.distance_m)} in ${duration(mission.duration_s)}. `}
          {`Nine in ten such drives take ${energy(mission.energy_j.p05)} to ${energy(mission.energy_j.p95)}.`}
        </p>
      </header>
      <Lasts of={mission} isFine={mission.feasible} />
      <Stops mission={mission} />
      <Warnings label="Doubts about the mission" list={mission.warnings} />
      <p class="proof">{proof(mission)}</p>
    </section>
  );
}

function NoMission() {
  if (isMissionPlanning.value) {
    return (
      <section class="answer answer-none" aria-label="Mission" aria-busy="true">
        <Progress label="Planning the mission" share={null} />
      </section>
    );
  }
  return (
    <section class="answer answer-none" aria-label="Mission">
      <p class="answer-big">{chargeFault.value ? "Too little charge" : "Where to?"}</p>
      <p>
        {chargeFault.value
          ? chargeFault.value
          : state.start.value
            ? "Click two or more places to visit, or one and return to the start; the order is found."
            : "Click the map where the robot starts."}
      </p>
    </section>
  );
}

interface OnCharge {
  arrival_charge: Spread;
  success_probability: number;
  reserve_fraction: number;
  missing_j: number;
}

/** Whether the battery lasts, with the charge at the end as an interval. */
export function Lasts({ of, isFine }: { of: OnCharge; isFine: boolean }) {
  const { p05, p50, p95 } = of.arrival_charge;
  const share = (charge: number) => `${100 * Math.min(Math.max(charge, 0), 1)}%`;
  return (
    <div class="charge" data-fine={isFine}>
      <span>Ends with</span>
      <b class="number">{percent(Math.max(p50, 0), 1)}</b>
      <div
        class="charge-bar"
        role="img"
        aria-label={`Charge at the end between ${percent(p05, 1)} and ${percent(p95, 1)}, reserve ${percent(of.reserve_fraction)}`}
      >
        <i style={{ width: share(p50) }} />
        <em style={{ left: share(of.reserve_fraction) }} />
      </div>
      <small>
        {`${percent(p05, 1)} to ${percent(p95, 1)}; keeps the reserve of ${percent(of.reserve_fraction)} with a probability of ${percent(of.success_probability, 1)}.`}
        {of.missing_j > 0 && ` ${energy(of.missing_j)} are missing.`}
      </small>
    </div>
  );
}

const NAMES: Record<MissionStop["kind"], string> = { start: "Start", waypoint: "Stop", charger: "Charger", home: "Back at the start" };

function Stops({ mission: { stops } }: { mission: Mission }) {
  return (
    <div class="answer-scroll">
      <table>
        <caption class="unseen">Stops in the order of least energy</caption>
        <thead>
          <tr>
            <th scope="col">Visit</th>
            <th scope="col">
              At <small>min</small>
            </th>
            <th scope="col">
              Energy <small>kJ</small>
            </th>
            <th scope="col">
              Charge <small>%</small>
            </th>
          </tr>
        </thead>
        <tbody>
          {stops.map((stop, i) => (
            <tr key={i}>
              <th scope="row">
                <span class="row-name">
                  {stop.kind === "waypoint" && <span class="stop-number">{i}</span>}
                  {NAMES[stop.kind]}
                  {stop.kind === "waypoint" && stop.index !== null && <small>{`given as ${stop.index + 1}`}</small>}
                </span>
              </th>
              <td>{clock(stop.arrival_s)}</td>
              <td>{(stop.energy_j / 1000).toFixed(1)}</td>
              <td>{(100 * stop.arrival_charge).toFixed(1)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** How good the order is. */
function proof({ search: { excess_at_most_j, ways_energy_j } }: Mission): string {
  const share = ways_energy_j > 0 ? excess_at_most_j / ways_energy_j : 0;
  return share < 1e-3
    ? "Proven: no order of these stops takes less."
    : `Proven: this order is within ${energy(excess_at_most_j)} (${percent(share, 1)}) of the least.`;
}
