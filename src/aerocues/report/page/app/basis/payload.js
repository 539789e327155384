/* The payload: everything that was measured. Arrays are decoded on first use. */

/** @type {Payload} */
export const payload = JSON.parse(document.getElementById("payload")?.textContent ?? "");

/** @type {WeakMap<Packed, Numbers>} */
const decodedArrays = new WeakMap();
const NO_VALUE = 65535;

/** @param {string} base64 */
export function bytesOf(base64) {
  const characters = atob(base64);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

/** Packed numbers as a typed array, which is empty for null.
 * @param {Packed | null | undefined} packed @returns {Numbers} */
export function arrayOf(packed) {
  if (!packed) return new Float32Array(0);
  const known = decodedArrays.get(packed) ?? decoded(packed);
  decodedArrays.set(packed, known);
  return known;
}

/** @param {Packed} packed @returns {Numbers} */
function decoded(packed) {
  if ("u8" in packed) return bytesOf(packed.u8);
  if ("f32" in packed) return new Float32Array(bytesOf(packed.f32).buffer);
  const {u16, low, high} = packed;
  return Float32Array.from(new Uint16Array(bytesOf(u16).buffer),
    code => (code === NO_VALUE ? NaN : low + (code / (NO_VALUE - 1)) * (high - low)));
}
