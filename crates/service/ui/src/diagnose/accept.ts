/** Stores a robot that a fit or a diagnosis has found, and plans with it, beside the path of the robot before. */
import { batch } from "@preact/signals";
import { announce } from "../announce";
import { storeRobot, type Robot } from "../api/robots";
import { loadRobots } from "../plan/load";
import * as plan from "../plan/state";
import { tab } from "../tab";

/** `suffix` says what became of the robot, as `corrected`; `before` is the id of the robot that drove. */
export async function accept(robot: Robot, suffix: string, before: string): Promise<void> {
  const name = `${robot.name.replace(/, (corrected|calibrated)$/, "")}, ${suffix}`;
  const stored = await storeRobot({ ...robot, name });
  await loadRobots();
  batch(() => {
    plan.formerId.value = before === stored.id ? null : before;
    plan.robotId.value = stored.id;
    tab.value = "plan";
  });
  announce(`${name} is stored; the plan now uses it.`);
}
