/** What can be done with the shape that is drawn, on the map itself: the map stays where it is. */
import { canFinish, finish, giveUp, takeCornerBack } from "./edit";
import * as state from "./state";

/** For fingers, what keys are for hands. */
export function DraftButtons() {
  if (!state.isEditing.value || state.corners.value.length === 0) return null;
  return (
    <div class="choice map-draft" role="group" aria-label="The shape that is drawn">
      <button type="button" title="Enter" disabled={!canFinish()} onClick={finish}>
        Finish
      </button>
      <button type="button" title="Backspace" onClick={takeCornerBack}>
        Corner back
      </button>
      <button type="button" title="Escape" onClick={giveUp}>
        Give up
      </button>
    </div>
  );
}
