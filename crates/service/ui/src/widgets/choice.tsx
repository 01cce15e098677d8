/** One of a few, side by side. */
interface Props<T extends string> {
  label: string;
  value: T;
  options: { value: T; name: string; isOff?: boolean }[];
  choose: (value: T) => void;
}

export function Choice<T extends string>({ label, value, options, choose }: Props<T>) {
  return (
    <div class="choice" role="group" aria-label={label}>
      {options.map((option) => (
        <button
          key={option.value}
          type="button"
          aria-pressed={option.value === value}
          disabled={option.isOff}
          onClick={() => choose(option.value)}
        >
          {option.name}
        </button>
      ))}
    </div>
  );
}
