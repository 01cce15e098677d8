/** Stores a robot that a fit or a diagnosis has found, and plans with it, beside the path of the robot before. */
import { batch } from "@preact/signals";
import { announce } from "../announce";
import { storeRobot, type Robot } from "../api/robots";
import { loadRobots } from "../plan/load";
import * as plan from "../plan/state";
import { tab } from "../tab";

/** The robot that drove, and the ground that was chosen for it. */
interface Drove {
  id: string;
  ground: string | null;
}

/** `suffix` says what became of the robot, as `corrected`; both are planned with on the ground that was driven. */
export async function accept(robot: Robot, suffix: string, { id: before, ground }: Drove): Promise<void> {
  const name = `${robot.name.replace(/, (corrected|calibrated)$/, "")}, ${suffix}`;
  const stored = await storeRobot({ ...robot, name });
  await loadRobots();
  batch(() => {
    plan.formerId.value = before === stored.id ? null : before;
    plan.robotId.value = stored.id;
    if (ground !== null) plan.surface.value = ground;
    tab.value = "plan";
  });
  announce(`${name} is stored; the plan now uses it.`);
}
