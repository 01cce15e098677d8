/** A job that is queued or runs, with its step and a way to call it off. */
import type { KnownJob } from "../api/jobs";
import { Progress } from "./progress";

interface Props {
  title: string;
  about: string;
  job: KnownJob<unknown>;
  cancel: () => Promise<void>;
}

export function UnderWay({ title, about, job: { progress }, cancel }: Props) {
  const step = progress?.step ?? "Asking for the job";
  return (
    <div class="under-way" role="status">
      <h2>{title}</h2>
      <Progress label={step.charAt(0).toUpperCase() + step.slice(1)} share={progress?.fraction ?? null} />
      <p>{about} You may leave this page open, or come back by its link.</p>
      <button type="button" onClick={() => void cancel()}>
        Call it off
      </button>
    </div>
  );
}
