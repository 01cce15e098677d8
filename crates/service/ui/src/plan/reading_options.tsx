/** How the next map is to be read: what its file does not say. */
import { signal } from "@preact/signals";
import { ARRAY_TYPE } from "../api/upload";
import { readNumber } from "../number";

const nodata = signal("");
const fillVoids = signal("");
const cellSize = signal("");

const isNumber = (text: string) => text.trim() === "" || readNumber(text) !== null;

/** What stands in the fields, as the query of `POST /v1/maps` takes it for a file of a type. Throws what is to be mended first. */
export function readingQuery(type: string): Record<string, string> {
  const isArray = type === ARRAY_TYPE;
  const said: Record<string, string> = {};
  for (const { query, of } of FIELDS) {
    if (!isNumber(of.value)) throw new Error("One of the reading options is no number. Mend it, and add the map again.");
    // Other files say it themselves.
    const isAsked = query !== "cell_size_m" || isArray;
    if (isAsked && of.value.trim() !== "") said[query] = String(readNumber(of.value));
  }
  if (isArray && !said.cell_size_m)
    throw new Error("An array does not say how large its cells are. Give their size under Options, and add the map again.");
  return said;
}

const FIELDS = [
  { query: "nodata_m", of: nodata, name: "Elevation of unknown cells", about: "Beside what the file marks, as −9999 or 0" },
  { query: "fill_voids_m", of: fillVoids, name: "Fill holes up to", about: "From the ground around them, 1000 m at most" },
  { query: "cell_size_m", of: cellSize, name: "Cell size of an array", about: "Of a .npy file, whose first row is the southernmost" },
];

export function ReadingOptions() {
  return (
    <details class="reading-options">
      <summary title="How the next map is to be read">Options</summary>
      <div>
        {FIELDS.map(({ query: id, of, name, about }) => {
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
