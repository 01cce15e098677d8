/** Doubts about the recordings that a refusal names, and that may be overruled. */
export const doubtsOf = (detail: string) => [...new Set([...detail.matchAll(/--despite (\w+)/g)].map(([, name]) => name!))];
