/** A place as text: it is what the map shows, and may be typed. */
import { useState } from "preact/hooks";
import type { Place } from "../api/plans";
import { setEnd, settle, type End } from "../map/ends";
import { placeOf } from "../map/earth";
import { extentOf } from "../map/view";
import * as state from "./state";
import { FORMS, readTyped, Unreadable, type Typed } from "./typed_place";

/** To the tenth of a degree. */
const degrees = (angle_rad: number) => Number(((angle_rad * 180) / Math.PI).toFixed(1));

export const written = ({ x_m, y_m, heading_rad }: Place) =>
  `${x_m}, ${y_m}${heading_rad === undefined ? "" : `, ${degrees(heading_rad)}°`}`;

function isOnMap(place: Place | null): place is Place {
  const map = state.map.value;
  if (!place || !map) return false;
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  return place.x_m >= west_m && place.x_m <= west_m + width_m && place.y_m >= south_m && place.y_m <= south_m + height_m;
}

/** Plain numbers are metres where that is on the map, and else latitude and longitude where those are. */
function located({ kind, pair: [first, second] }: Typed): Place {
  const map = state.map.value;
  if (!map) throw new Unreadable("there is no map yet");
  const { west_m, south_m, width_m, height_m } = extentOf(map);
  if (kind === "parts") return { x_m: west_m + first * width_m, y_m: south_m + second * height_m };
  if (kind === "degrees") {
    const place = placeOf({ lon_deg: first, lat_deg: second });
    if (!place) throw new Unreadable("the map does not say where on earth it lies: give x, y in metres, or @0.2,0.8 in parts of it");
    return place;
  }
  const metres = { x_m: first, y_m: second };
  const isLatitude = Math.abs(first) <= 90 && Math.abs(second) <= 180;
  const place = isLatitude ? placeOf({ lat_deg: first, lon_deg: second }) : null;
  if (isOnMap(place) && isOnMap(metres)) throw new Unreadable("this may be metres or degrees: write 46.5046N, 93.9217W for degrees");
  return isOnMap(place) ? place : metres;
}

function readPlace(text: string): Place {
  const typed = readTyped(text);
  const place = located(typed);
  const map = state.map.value;
  if (!isOnMap(place) && map) {
    const { west_m, south_m, width_m, height_m } = extentOf(map);
    const range = (from_m: number, length_m: number) => `${Number(from_m.toFixed(1))} to ${Number((from_m + length_m).toFixed(1))}`;
    throw new Unreadable(`this lies off the map, which has x ${range(west_m, width_m)} m and y ${range(south_m, height_m)} m`);
  }
  return typed.heading_deg === undefined ? place : { ...place, heading_rad: (typed.heading_deg * Math.PI) / 180 };
}

/** Start or goal. */
export function EndField({ end, name }: { end: End; name: string }) {
  const take = (place: Place) => {
    setEnd(end, place);
    settle(end);
  };
  return <PlaceField id={end} name={name} place={state[end].value} take={take} />;
}

interface Props {
  id: string;
  name: string;
  /** What stands in the field until it is typed in. */
  place: Place | null;
  take: (place: Place) => void;
}

export function PlaceField({ id, name, place, take: accept }: Props) {
  const [typed, setTyped] = useState<string | null>(null);
  const [wrong, setWrong] = useState<string | null>(null);
  const take = () => {
    if (typed === null) return;
    try {
      if (typed.trim() !== "") accept(readPlace(typed));
      setTyped(null);
      setWrong(null);
    } catch (thrown) {
      setWrong(thrown instanceof Unreadable ? thrown.message : String(thrown));
    }
  };
  const leave = () => {
    setTyped(null);
    setWrong(null);
  };
  return (
    <div class="place-field" data-wrong={wrong !== null}>
      <label for={`place-${id}`}>{name}</label>
      <input
        id={`place-${id}`}
        type="text"
        autocomplete="off"
        spellcheck={false}
        placeholder="x, y or 46.5N, 93.9W"
        title={FORMS}
        value={typed ?? (place ? written(place) : "")}
        aria-invalid={wrong !== null}
        aria-describedby={`place-${id}-about`}
        onInput={(event) => setTyped(event.currentTarget.value)}
        onChange={take}
        onKeyDown={(event) => {
          if (event.key === "Enter") take();
          if (event.key === "Escape") leave();
        }}
      />
      <small id={`place-${id}-about`} role={wrong ? "alert" : undefined}>
        {wrong ? `${wrong.charAt(0).toUpperCase()}${wrong.slice(1)}.` : <span class="unseen">{FORMS}</span>}
      </small>
    </div>
  );
}
