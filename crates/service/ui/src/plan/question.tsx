/** The robot and what the sliders change of it; every change is planned anew. */
import { duration, metres, percent, words } from "../format";
import { chooseJourney } from "../map/stops";
import { Choice } from "../widgets/choice";
import { RobotSelect } from "../widgets/robot_select";
import { Slider } from "../widgets/slider";
import { EndField } from "./place_field";
import { focusedPath } from "./shown_paths";
import * as state from "./state";
import { SteeringOptions } from "./steering";
import { StopFields } from "./stop_fields";

/** No robot is loaded with more than this share of its own mass here. */
const MOST_PAYLOAD = 0.8;

/** The slowest that is asked for, as a share of the wheels' top speed. */
const LEAST_SPEED = 0.1;
/** The least charge that is asked for, 0 to 1. */
const LEAST_CHARGE = 0.05;

const speed = (value_mps: number) => `${value_mps.toFixed(2)}\u202fm/s`;
const kilograms = (value_kg: number) => `${value_kg.toFixed(0)}\u202fkg`;

export function Question() {
  const known = state.robot.value;
  if (!known) return null;
  const { robot } = known;
  const speed_mps = Math.min(state.speed_mps.value ?? state.usualSpeed(robot), robot.max_wheel_speed_mps);
  const { battery } = robot;
  const most_kg = Math.round(MOST_PAYLOAD * robot.mass_kg);
  return (
    <section class="question" aria-label="Question">
      <Choice
        label="Where to"
        value={state.journey.value}
        choose={chooseJourney}
        options={[
          { value: "goal", name: "One goal" },
          { value: "stops", name: "Several stops" },
        ]}
      />
      <EndField end="start" name="Start at" />
      {state.journey.value === "goal" ? <EndField end="goal" name="Goal at" /> : <StopFields />}
      <RobotChoice />
      <Slider
        label="Speed"
        value={speed_mps}
        least={LEAST_SPEED * robot.max_wheel_speed_mps}
        greatest={robot.max_wheel_speed_mps}
        step={0.01 * robot.max_wheel_speed_mps}
        written={speed(speed_mps)}
        ends={[speed(LEAST_SPEED * robot.max_wheel_speed_mps), speed(robot.max_wheel_speed_mps)]}
        change={(value) => (state.speed_mps.value = value)}
      />
      <Slider
        label="Payload"
        value={state.payload_kg.value}
        least={0}
        greatest={most_kg}
        step={1}
        written={kilograms(state.payload_kg.value)}
        ends={[kilograms(0), kilograms(most_kg)]}
        change={(value) => (state.payload_kg.value = value)}
      />
      {battery && (
        <Slider
          label="Charge"
          value={state.charge.value}
          least={LEAST_CHARGE}
          greatest={1}
          step={0.01}
          written={`${percent(state.charge.value)} of ${battery.capacity_wh}\u202fWh`}
          ends={[percent(LEAST_CHARGE), percent(1)]}
          change={(value) => (state.charge.value = value)}
        />
      )}
      <Ground />
      <SteeringOptions />
      <Along />
    </section>
  );
}

function RobotChoice() {
  const choose = (id: string) => {
    state.robotId.value = id;
    state.formerId.value = null;
  };
  return <RobotSelect label="Robot" value={state.robotId.value} choose={choose} />;
}

function Ground() {
  const robot = state.robot.value?.robot;
  if (!robot) return null;
  const isNamed = (state.map.value?.surfaces.length ?? 0) > 0;
  return (
    <label class="field">
      <span>{isNamed ? "Ground the map leaves open" : "Ground"}</span>
      <select
        value={state.surface.value !== null && state.surface.value in robot.surfaces ? state.surface.value : robot.default_surface}
        onChange={(event) => {
          const name = event.currentTarget.value;
          state.surface.value = name === robot.default_surface ? null : name;
        }}
      >
        {Object.keys(robot.surfaces).map((name) => (
          <option key={name} value={name}>
            {words(name)}
          </option>
        ))}
      </select>
    </label>
  );
}

/** Where along the path the robot is shown: for keys and fingers, what pointing at the charts is for a mouse. */
function Along() {
  const plan = focusedPath.value;
  if (!plan) return null;
  const at_m = Math.min(state.along_m.value ?? 0, plan.distance_m);
  const t_s = plan.poses.find(({ distance_m }) => distance_m >= at_m)?.t_s ?? 0;
  return (
    <Slider
      label="Along the path"
      value={at_m}
      least={0}
      greatest={plan.distance_m}
      step={plan.distance_m / 500}
      written={`${metres(at_m)} · ${duration(t_s)}`}
      ends={[metres(0), metres(plan.distance_m)]}
      change={(value) => (state.along_m.value = value)}
    />
  );
}
