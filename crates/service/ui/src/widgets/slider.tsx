/** A number to drag, with its value and unit; whoever drags it is told when they hold it. */
import { isDragging } from "../plan/state";

interface Props {
  label: string;
  value: number;
  least: number;
  greatest: number;
  step: number;
  written: string;
  change: (value: number) => void;
  /** Its ends as they are written. */
  ends: [string, string];
}

const release = () => (isDragging.value = false);

/** From now until it is let go, wherever that is. */
function hold(): void {
  isDragging.value = true;
  for (const end of ["pointerup", "pointercancel", "blur"]) addEventListener(end, release, { once: true });
}

export function Slider({ label, value, least, greatest, step, written, change, ends }: Props) {
  const id = `slider-${label.toLowerCase().replaceAll(" ", "-")}`;
  const share = (value - least) / (greatest - least || 1);
  return (
    <div class="slider">
      <label for={id}>{label}</label>
      <output for={id}>{written}</output>
      <input
        id={id}
        type="range"
        min={least}
        max={greatest}
        step={step}
        value={value}
        aria-valuetext={written}
        aria-describedby={`${id}-ends`}
        style={{ "--share": `${100 * share}%` }}
        onInput={(event) => change(event.currentTarget.valueAsNumber)}
        onPointerDown={hold}
        onKeyDown={(event) => event.repeat && hold()}
        onKeyUp={release}
      />
      <small id={`${id}-ends`} class="slider-ends">
        <span>{ends[0]}</span> <span class="unseen">to</span> <span>{ends[1]}</span>
      </small>
    </div>
  );
}
