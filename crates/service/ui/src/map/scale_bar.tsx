/** How long a metre is. */
import { metres } from "../format";
import { roundLength_m, type View } from "./view";

const LONGEST_PX = 110;

export function ScaleBar({ view }: { view: View }) {
  const length_m = roundLength_m(view, LONGEST_PX);
  const text = length_m < 1 ? `${Math.round(length_m * 100)}\u202fcm` : metres(length_m).replace(".0", "");
  return (
    <div class="scale-bar" role="img" aria-label={`Scale: this bar is ${text} long`}>
      <span>{text}</span>
      <div style={{ width: `${length_m * view.px_per_m}px` }} />
    </div>
  );
}
