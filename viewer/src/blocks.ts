/** Blocks of numbers in the page; the inverse of src/carat/report/page_blocks.cpp. */

const digitValues = new Uint8Array(128);
for (const [value, digit] of [
  ...'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/',
].entries())
  digitValues[digit.charCodeAt(0)] = value;

const pieceLength = 1 << 22;

/** Lets the page draw and answer between two pieces of long work. */
export function breathe(): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve));
}

async function decodeBase64(text: string): Promise<Uint8Array<ArrayBuffer>> {
  const padding = text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0;
  const bytes = new Uint8Array((text.length / 4) * 3);
  for (let begin = 0; begin < text.length; begin += pieceLength) {
    const end = Math.min(text.length, begin + pieceLength);
    let at = (begin / 4) * 3;
    for (let i = begin; i < end; i += 4) {
      const group =
        (digitValues[text.charCodeAt(i)] << 18) |
        (digitValues[text.charCodeAt(i + 1)] << 12) |
        (digitValues[text.charCodeAt(i + 2)] << 6) |
        digitValues[text.charCodeAt(i + 3)];
      bytes[at++] = group >> 16;
      bytes[at++] = group >> 8;
      bytes[at++] = group;
    }
    if (end < text.length) await breathe();
  }
  return bytes.subarray(0, bytes.length - padding);
}

async function inflate(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  if (typeof DecompressionStream === 'undefined')
    throw new Error('This browser is too old: it lacks DecompressionStream (2023).');
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export async function readBytes(block: number): Promise<Uint8Array<ArrayBuffer>> {
  const text = document.getElementById(`block-${block}`)?.textContent;
  if (!text) throw new Error('Data is missing: the file was cut off.');
  return inflate(await decodeBase64(text));
}

async function readWords(block: number): Promise<Uint32Array<ArrayBuffer>> {
  const planes = await readBytes(block);
  const n = planes.length / 4;
  const words = new Uint32Array(n);
  for (let i = 0; i < n; ++i)
    words[i] =
      planes[i] | (planes[n + i] << 8) | (planes[2 * n + i] << 16) | (planes[3 * n + i] << 24);
  return words;
}

export async function readFloats(block: number): Promise<Float32Array<ArrayBuffer>> {
  return new Float32Array((await readWords(block)).buffer);
}

export async function readIntegers(block: number): Promise<Uint32Array<ArrayBuffer>> {
  const words = await readWords(block);
  let value = 0;
  for (let i = 0; i < words.length; ++i) {
    value = (value + ((words[i] >>> 1) ^ -(words[i] & 1))) | 0;
    words[i] = value;
  }
  return words;
}
