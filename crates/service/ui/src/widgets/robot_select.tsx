/** One of the robots at hand. */
import * as state from "../plan/state";

interface Props {
  label: string;
  value: string;
  choose: (id: string) => void;
}

export function RobotSelect({ label, value, choose }: Props) {
  return (
    <label class="field">
      <span>{label}</span>
      <select value={value} onChange={(event) => choose(event.currentTarget.value)}>
        {state.robots.value?.map(({ id, robot, isStored }) => (
          <option key={id} value={id}>
            {robot.name}
            {isStored ? ` · stored ${id.slice(0, 6)}` : ""}
          </option>
        ))}
      </select>
    </label>
  );
}
