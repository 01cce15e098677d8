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

export function Slider({ label, value, least, greatest, step, written, change, note }: Props) {
  const id = `slider-${label.toLowerCase().replaceAll(" ", "-")}`;
  const hold = () => (isDragging.value = true);
  const release = () => (isDragging.value = false);
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
        onPointerUp={release}
        onPointerCancel={release}
        onBlur={release}
      />
      {note && <small>{note}</small>}
    </div>
  );
}
