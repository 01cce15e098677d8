/** A link to the guide that the service carries. */
import type { ComponentChildren } from "preact";

interface Props {
  /** A chapter, as `maps`, with a place in it if one is meant, as `maps.html#on-earth`; none: the first page. */
  chapter?: string;
  class?: string;
  children?: ComponentChildren;
}

export function GuideLink({ chapter, class: style, children }: Props) {
  return (
    <a href={`/docs/guide/${chapter ? `${chapter}.html` : ""}`} target="_blank" rel="noreferrer" class={style}>
      {children ?? "Guide"}
    </a>
  );
}
