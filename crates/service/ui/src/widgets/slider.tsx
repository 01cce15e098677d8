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
  /** More to say about the value. */
  note?: string;
}

const release = () => (isDragging.value = false);

/** From now until it is let go, wherever that is. */
function hold(): void {
  isDragging.value = true;
  for (const end of ["pointerup", "pointercancel", "blur"]) addEventListener(end, release, { once: true });
}

export function Slider({ label, value, least, greatest, step, written, change, note }: Props) {
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
        style={{ "--share": `${100 * share}%` }}
        onInput={(event) => change(event.currentTarget.valueAsNumber)}
        onPointerDown={hold}
        onKeyDown={(event) => event.repeat && hold()}
        onKeyUp={release}
      />
      {note && <small>{note}</small>}
    </div>
  );
}
