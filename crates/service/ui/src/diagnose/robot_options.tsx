/** Robots to choose from. */
import * as plan from "../plan/state";

export const listRobotsOptions = () =>
  plan.robots.value?.map(({ id, robot, isStored }) => (
    <option key={id} value={id}>
      {robot.name}
      {isStored ? ` · stored ${id.slice(0, 6)}` : ""}
    </option>
  ));
