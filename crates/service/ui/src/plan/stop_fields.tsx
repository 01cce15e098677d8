/** The stops of a mission as a list, which may be typed. */
import type { Place } from "../api/plans";
import { addStop, MOST_STOPS, removeStop, visitOf } from "../map/stops";
import { PlaceField, written } from "./place_field";
import * as state from "./state";

export function StopFields() {
  const stops = state.stops.value;
  return (
    <>
      {stops.length > 0 && (
        <ol class="stops" aria-label="Stops">
          {stops.map((stop, i) => (
            <Stop key={i} stop={stop} index={i} />
          ))}
        </ol>
      )}
      {stops.length < MOST_STOPS && <PlaceField id="stop" name="Add a stop at" place={null} take={addStop} />}
      <label class="check-line">
        <input
          type="checkbox"
          checked={state.returnsHome.value}
          onChange={(event) => (state.returnsHome.value = event.currentTarget.checked)}
        />
        Return to the start
      </label>
    </>
  );
}

function Stop({ stop, index }: { stop: Place; index: number }) {
  return (
    <li>
      <span class="stop-number" title="On the map and in the order of visits">
        {visitOf(index)}
      </span>
      <span class="number">{written(stop)}</span>
      <button type="button" class="quiet" aria-label={`Remove stop ${index + 1}`} title="Remove it" onClick={() => removeStop(index)}>
        ×
      </button>
    </li>
  );
}
