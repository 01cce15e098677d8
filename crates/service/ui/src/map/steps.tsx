/** Steps back and forward, over the map. */
import { isEditing } from "../areas/state";
import { canRedo, canUndo, redo, undo } from "../plan/history";

/** Areas have steps of their own while they are drawn. */
export function Steps() {
  if (isEditing.value || !(canUndo.value || canRedo.value)) return null;
  return (
    <div class="choice map-steps" role="group" aria-label="Steps">
      <button type="button" aria-label="Step back" title="Undo the last change (Ctrl+Z)" disabled={!canUndo.value} onClick={undo}>
        ↶
      </button>
      <button type="button" aria-label="Step forward" title="Do it again (Ctrl+Shift+Z)" disabled={!canRedo.value} onClick={redo}>
        ↷
      </button>
    </div>
  );
}
