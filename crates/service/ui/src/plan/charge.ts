/** What is left in the battery at the goal. */
import type { Plan } from "../api/plans";
import type { Robot } from "../api/robots";

/** Charges at the goal, 0 to 1, with least and greatest; negative where the battery would be empty before. */
export interface ArrivalCharge {
  charge: number;
  least: number;
  greatest: number;
  reserve: number;
}

export const J_PER_WH = 3600;
/** The reserve of a battery whose file says none, as the service takes it. */
export const USUAL_RESERVE = 0.2;

/** Charge less the plan's energy, by the battery's nominal capacity; null without a battery. */
export function arrivalCharge(plan: Plan, robot: Robot, charge: number): ArrivalCharge | null {
  const { battery } = robot;
  if (!battery) return null;
  const capacity_j = battery.capacity_wh * J_PER_WH;
  const left = (energy_j: number) => Math.min(charge - energy_j / capacity_j, 1);
  return {
    charge: left(plan.energy_j),
    least: left(plan.energy_interval_j[1]),
    greatest: left(plan.energy_interval_j[0]),
    reserve: battery.reserve_fraction ?? USUAL_RESERVE,
  };
}
