/** How far something is; without a share, that it is under way. */
export function Progress({ label, share }: { label: string; share: number | null }) {
  return (
    <div class="progress">
      <span>{label}</span>
      <progress aria-label={label} max={1} {...(share === null ? {} : { value: share })} />
      <span class="number">{share === null ? "" : `${Math.round(100 * share)}\u202f%`}</span>
    </div>
  );
}
