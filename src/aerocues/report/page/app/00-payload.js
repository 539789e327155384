/* The payload: everything that was measured. Arrays are decoded when first asked for. */

const payload = JSON.parse(document.getElementById("payload").textContent);

const decodedArrays = new WeakMap();

function bytesOf(base64) {
  const characters = atob(base64);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

/* {"f32": ...} or {"u8": ...} as a typed array; an empty one for nothing. */
function arrayOf(packed) {
  if (!packed) return new Float32Array(0);
  if (!decodedArrays.has(packed)) {
    const array = packed.u8 === undefined
      ? new Float32Array(bytesOf(packed.f32).buffer)
      : bytesOf(packed.u8);
    decodedArrays.set(packed, array);
  }
  return decodedArrays.get(packed);
}
