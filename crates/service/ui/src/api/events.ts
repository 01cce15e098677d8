/** Server-sent events, read by `fetch`: the browser's own reader cannot carry a token. */

export interface ServerEvent {
  id: string;
  data: string;
}

/** The events of an answer, as they come. */
export async function* eventsOf(body: ReadableStream<Uint8Array>): AsyncGenerator<ServerEvent> {
  const [reader, decoder] = [body.getReader(), new TextDecoder()];
  let [text, event] = ["", { id: "", data: "" }];
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    text += decoder.decode(value, { stream: true });
    const lines = text.split("\n").map((line) => line.replace(/\r$/, ""));
    text = lines.pop() ?? "";
    for (const line of lines) {
      if (line === "" && event.data !== "") {
        yield event;
        event = { id: event.id, data: "" };
      } else if (line.startsWith("id:")) {
        event.id = line.slice(3).trim();
      } else if (line.startsWith("data:")) {
        event.data += (event.data && "\n") + line.slice(5).trimStart();
      }
    }
  }
}
