/** The strip of tools over the map while areas are edited. */
import { useEffect } from "preact/hooks";
import { Choice } from "../widgets/choice";
import { redo, undo } from "./changes";
import { removeSelected, select, setMode } from "./edit";
import { EffectFields } from "./effect_fields";
import { inWords } from "./effects";
import { openFile, saveAreas } from "./files";
import { pressHistory } from "./keys";
import * as state from "./state";

export function AreaTools() {
  useEffect(() => {
    addEventListener("keydown", pressHistory);
    return () => removeEventListener("keydown", pressHistory);
  }, []);
  return (
    <section class="area-tools" aria-label="Area tools">
      <Choice
        label="Areas: a click"
        value={state.mode.value}
        choose={setMode}
        options={[
          { value: "polygon", name: "Draw polygon" },
          { value: "line", name: "Draw line" },
          { value: "select", name: "Select", isOff: state.areas.value.length === 0 },
        ]}
      />
      <EffectFields />
      <AreaChoice />
      <div class="choice" role="group" aria-label="Changes">
        <button type="button" title="Ctrl+Z" disabled={state.past.value.length === 0 || state.isStoring.value} onClick={undo}>
          Undo
        </button>
        <button type="button" title="Ctrl+Shift+Z" disabled={state.future.value.length === 0 || state.isStoring.value} onClick={redo}>
          Redo
        </button>
      </div>
      <Files />
    </section>
  );
}

function AreaChoice() {
  const areas = state.areas.value;
  const choose = (value: string) => {
    setMode("select");
    select(value === "" ? null : Number(value));
  };
  return (
    <>
      <select
        class="area-choice"
        aria-label="Area"
        disabled={areas.length === 0}
        value={state.selected.value ?? ""}
        onChange={(event) => choose(event.currentTarget.value)}
      >
        <option value="">{areas.length === 0 ? "No areas yet" : areas.length === 1 ? "1 area" : `${areas.length} areas`}</option>
        {areas.map(({ properties }, i) => (
          <option key={i} value={i}>
            {`${i + 1}: ${inWords(properties)}`}
          </option>
        ))}
      </select>
      <button type="button" title="Delete" disabled={!state.selectedArea.value} onClick={removeSelected}>
        Delete
      </button>
    </>
  );
}

function Files() {
  return (
    <div class="area-files">
      <label class="button file" title="The areas of a GeoJSON file take the place of those on the map">
        <input
          type="file"
          accept=".geojson,.json"
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (file) void openFile(file);
            event.currentTarget.value = "";
          }}
        />
        Open file…
      </label>
      <button type="button" disabled={state.areas.value.length === 0} title="GeoJSON in the map's metres" onClick={saveAreas}>
        Save file
      </button>
    </div>
  );
}
