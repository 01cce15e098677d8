/** The sheet of keys. */
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { GuideLink } from "./widgets/guide_link";

export const isHelpOpen = signal(false);

const KEYS: { where: string; keys: [string, string][] }[] = [
  {
    where: "Everywhere",
    keys: [
      ["?", "This sheet"],
      ["Ctrl Z", "Undo the last change of the question"],
      ["Ctrl Shift Z", "Do it again"],
      ["Tab", "The next field"],
    ],
  },
  {
    where: "On the map",
    keys: [
      ["← → ↑ ↓", "Move the cursor; with Shift further"],
      ["Enter", "Set what the chosen tool sets"],
      ["S, G", "Start here, goal here"],
      ["[ ]", "Turn the start"],
      ["+ − 0", "Zoom in, zoom out, show all"],
      ["Escape", "Begin measuring anew"],
    ],
  },
  {
    where: "While areas are drawn",
    keys: [
      ["Enter", "Set a corner, take hold of an area, let it go"],
      ["Backspace", "Take a corner back"],
      ["Delete", "Remove the selected area"],
      ["Escape", "Give up what was begun"],
    ],
  },
];

const isTyping = ({ target }: KeyboardEvent) =>
  target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && !["checkbox", "range"].includes(target.type));

/** Begins to listen for `?`. */
export function listenForHelp(): void {
  addEventListener("keydown", (event) => {
    if (event.key !== "?" || isTyping(event) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    isHelpOpen.value = !isHelpOpen.value;
  });
}

export function Help() {
  const dialog = useRef<HTMLDialogElement>(null);
  const isOpen = isHelpOpen.value;
  useEffect(() => {
    if (isOpen) dialog.current?.showModal();
    else dialog.current?.close();
  }, [isOpen]);
  return (
    <dialog ref={dialog} class="help" aria-labelledby="help-title" onClose={() => (isHelpOpen.value = false)}>
      <header>
        <h2 id="help-title">Keys</h2>
        <button type="button" onClick={() => (isHelpOpen.value = false)}>
          Close
        </button>
      </header>
      {KEYS.map(({ where, keys }) => (
        <section key={where}>
          <h3>{where}</h3>
          <dl>
            {keys.map(([key, does]) => (
              <div key={key}>
                <dt>
                  <kbd>{key}</kbd>
                </dt>
                <dd>{does}</dd>
              </div>
            ))}
          </dl>
        </section>
      ))}
      <p>
        With a mouse: drag an end to move it, drag as you place it to set its heading, scroll to zoom. With fingers: drag to pan, two
        fingers to zoom.
      </p>
      <p>
        <GuideLink>The guide</GuideLink> · <a href="/docs">Reference of the API</a>
      </p>
    </dialog>
  );
}
