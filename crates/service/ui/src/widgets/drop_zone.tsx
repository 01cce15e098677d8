/** A place to drop files on, or to choose them. */
import type { ComponentChildren } from "preact";
import { useRef, useState } from "preact/hooks";

interface Props {
  label: string;
  /** File name endings, as `.csv,.bag`. */
  accept: string;
  take: (files: File[]) => void;
  isMany?: boolean;
  children?: ComponentChildren;
}

export function DropZone({ label, accept, take, isMany = false, children }: Props) {
  const [isOver, setOver] = useState(false);
  const input = useRef<HTMLInputElement>(null);
  const takeList = (list: FileList | null | undefined) => {
    const files = [...(list ?? [])];
    if (files.length > 0) take(isMany ? files : files.slice(0, 1));
  };
  return (
    <label
      class={`drop-zone${isOver ? " is-over" : ""}`}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        takeList(event.dataTransfer?.files);
      }}
    >
      <input
        ref={input}
        type="file"
        accept={accept}
        multiple={isMany}
        onChange={() => {
          takeList(input.current?.files);
          if (input.current) input.current.value = "";
        }}
      />
      <strong>{label}</strong>
      {children}
    </label>
  );
}
