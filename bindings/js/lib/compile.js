// A WebAssembly.Module of what users may have: one, its bytes, a Response, or an address.
export async function compile(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  const response = source instanceof Response ? source : await fetch(source);
  if (!response.ok) throw new Error(`${response.url}: ${response.status} ${response.statusText}`);
  // Not compileStreaming(), which refuses servers that do not know the type application/wasm.
  return WebAssembly.compile(await response.arrayBuffer());
}
