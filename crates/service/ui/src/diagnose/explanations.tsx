/** The posterior: explanations as bars with their probabilities and odds. */
import { capitalized, explanationLabel } from "./labels";
import { odds, probability } from "./odds";
import { Fact } from "./recordings";
import type { Explanation, Report } from "./report";

/** Probability outside the credible set from which it has a bar of its own. */
const WORTH_A_BAR = 5e-4;

export function Explanations({ report }: { report: Report }) {
  const { explanations = [], probability: classes } = report;
  if (explanations.length === 0) return null;
  const rest = 1 - explanations.reduce((sum, one) => sum + one.probability, 0);
  return (
    <section class="card" aria-label="Explanations">
      <h3>Explanations</h3>
      <p class="bars-note">Posterior probability of each explanation, and its odds against nothing missing.</p>
      <div class="bars">
        {explanations.map((one) => (
          <Bar
            key={explanationLabel(one.mechanisms)}
            label={explanationLabel(one.mechanisms)}
            kind={kindOf(one)}
            share={one.probability}
            note={classes && one.mechanisms.length > 0 ? `odds ${odds(one.probability, classes.nothing)}` : ""}
          />
        ))}
        {rest > WORTH_A_BAR && <Bar label="all others together" kind="others" share={rest} note="outside the credible set" />}
      </div>
      <p>{lead(explanations, Math.max(rest, 0))}</p>
      {classes && (
        <dl class="facts">
          <Fact name="Nothing missing" value={probability(classes.nothing)} />
          <Fact name="Listed mechanisms" value={probability(classes.listed)} />
          <Fact name="Outside the list" value={probability(classes.unlisted)} />
        </dl>
      )}
    </section>
  );
}

function kindOf({ mechanisms }: Explanation): string {
  if (mechanisms.length === 0) return "nothing";
  return mechanisms.includes("unknown") ? "unlisted" : "after";
}

/** The likeliest explanation against the second, or against all others where the credible set holds no second. */
function lead([first, second]: Explanation[], rest: number): string {
  if (!first) return "";
  const of = `Odds of “${explanationLabel(first.mechanisms)}” against`;
  return second
    ? `${of} the runner-up, “${explanationLabel(second.mechanisms)}”: ${odds(first.probability, second.probability)}.`
    : `${of} all others together: ${odds(first.probability, rest)}.`;
}

function Bar({ label, kind, share, note }: { label: string; kind: string; share: number; note: string }) {
  const value = probability(share);
  const percent = Math.round(1000 * Math.min(share, 1)) / 10;
  return (
    <div class="bar explanation" data-kind={kind}>
      <span>{capitalized(label)}</span>
      <div
        class="bar-track"
        role="meter"
        aria-label={label}
        aria-valuemin={0}
        aria-valuemax={100}
        aria-valuenow={percent}
        aria-valuetext={note ? `${value}, ${note}` : value}
      >
        <i style={{ width: `${percent}%` }} />
      </div>
      <span class="number">
        <b>{value}</b> <small>{note}</small>
      </span>
    </div>
  );
}
