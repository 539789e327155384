/* The payload: everything that was measured. Arrays are decoded when first asked for. */

export const payload = JSON.parse(document.getElementById("payload").textContent);

const decodedArrays = new WeakMap();
const NO_VALUE = 65535;

export function bytesOf(base64) {
  const characters = atob(base64);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

/* {"f32": ...}, {"u8": ...} or {"u16": ..., low, high} as a typed array; an empty one for nothing. */
export function arrayOf(packed) {
  if (!packed) return new Float32Array(0);
  if (!decodedArrays.has(packed)) decodedArrays.set(packed, decoded(packed));
  return decodedArrays.get(packed);
}

function decoded({f32, u8, u16, low, high}) {
  if (u8 !== undefined) return bytesOf(u8);
  if (f32 !== undefined) return new Float32Array(bytesOf(f32).buffer);
  return Float32Array.from(new Uint16Array(bytesOf(u16).buffer),
    code => (code === NO_VALUE ? NaN : low + (code / (NO_VALUE - 1)) * (high - low)));
}
