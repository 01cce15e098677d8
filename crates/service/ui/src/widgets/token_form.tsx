/** Asks for the token of a guarded service, when it has refused for want of one. */
import { useRef } from "preact/hooks";
import { give, isRefused, isWanted } from "../api/token";
import { loadAll } from "../plan/load";

export function TokenForm() {
  const input = useRef<HTMLInputElement>(null);
  if (!isWanted.value) return null;
  return (
    <form
      class="token-form"
      onSubmit={(event) => {
        event.preventDefault();
        give(input.current?.value ?? "");
        void loadAll();
      }}
    >
      <label for="token">This service wants a token:</label>
      <input ref={input} id="token" type="password" autocomplete="off" aria-describedby="token-about" required />
      <button type="submit" class="primary">
        Go on
      </button>
      <small id="token-about" role={isRefused.value ? "alert" : undefined}>
        {isRefused.value && "This is none of the service's tokens. "}
        Of a line NAME:TOKEN it is what stands behind the colon. Whoever runs the service gives it out.
      </small>
    </form>
  );
}
