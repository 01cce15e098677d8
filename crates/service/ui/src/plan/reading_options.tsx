/** How the next map is to be read: what its file does not say. */
import { signal } from "@preact/signals";
import { readNumber } from "../number";

const nodata = signal("");
const fillVoids = signal("");

const isNumber = (text: string) => text.trim() === "" || readNumber(text) !== null;

/** What stands in the fields, as the query of `POST /v1/maps` takes it; null where one of them is no number. */
export function readingQuery(): Record<string, string> | null {
  const said: Record<string, string> = {};
  for (const [name, { value }] of [["nodata_m", nodata] as const, ["fill_voids_m", fillVoids] as const]) {
    if (!isNumber(value)) return null;
    if (value.trim() !== "") said[name] = String(readNumber(value));
  }
  return said;
}

const FIELDS = [
  { id: "nodata", of: nodata, name: "Elevation of unknown cells", about: "Beside what the file marks, as −9999 or 0" },
  { id: "fill-voids", of: fillVoids, name: "Fill holes up to", about: "From the ground around them, 1000 m at most" },
];

export function ReadingOptions() {
  return (
    <details class="reading-options">
      <summary title="How the next map is to be read">Options</summary>
      <div>
        {FIELDS.map(({ id, of, name, about }) => {
          const isWrong = !isNumber(of.value);
          return (
            <div key={id} class="number-field" data-wrong={isWrong}>
              <label for={`reading-${id}`}>{name}</label>
              <div class="number-box">
                <input
                  id={`reading-${id}`}
                  type="text"
                  inputMode="decimal"
                  value={of.value}
                  aria-invalid={isWrong}
                  aria-describedby={`reading-${id}-about`}
                  onInput={(event) => (of.value = event.currentTarget.value)}
                />
                <span>m</span>
              </div>
              <small id={`reading-${id}-about`}>{isWrong ? "This is no number of metres." : about}</small>
            </div>
          );
        })}
      </div>
    </details>
  );
}
