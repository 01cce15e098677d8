/** Labels of mechanisms and of explanations, which are sets of them. */
import { words } from "../format";

const LABELS: Record<string, string> = {
  unknown: "something outside the list",
  speed_dependent_friction: "speed-dependent friction",
  grade_dependent_friction: "grade-dependent friction",
};

export const mechanismLabel = (name: string) => LABELS[name] ?? words(name);

export const explanationLabel = (mechanisms: string[]) =>
  mechanisms.length === 0 ? "nothing missing" : mechanisms.map(mechanismLabel).join(" + ");

export const capitalized = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);
