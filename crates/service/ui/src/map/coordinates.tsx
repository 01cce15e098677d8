/** Where the pointer or the keyboard's cursor is. */
import { degreesOf, degreesWords } from "./earth";
import { cursor } from "./cursor";
import { pointedAt } from "./pointed";

/** Map metres to the decimetre. */
const written = (value_m: number) => value_m.toFixed(1).replace("-", "\u2212");

export function Coordinates() {
  const place = pointedAt.value ?? cursor.value;
  if (!place) return null;
  const degrees = degreesOf(place);
  return (
    <p class="map-coordinates">
      {degrees && <span>{degreesWords(degrees)}</span>}
      <span>
        x {written(place.x_m)}, y {written(place.y_m)}&#x202f;m
      </span>
    </p>
  );
}
