// Streams and sounds that tests make of others.

const kHeadBytes = 32, kGroupBytes = 88, kTablesBegin = 40, kFrameBytes = 44;  // of version 3 (engine/stream/README.md)

/** The first group of a stream of version 3, so many times, at other frames a second. `nvs`: the module nvs.js. */
export function repeatedGroup(bytes, times, fps, {crc32, headBytes}) {
    const begin = headBytes(bytes, bytes.length), groups = bytes.readUInt32LE(16), frames = bytes.readUInt32LE(kHeadBytes);
    const tablesOf = group => Number(bytes.readBigUInt64LE(kHeadBytes + group * kGroupBytes + kTablesBegin));
    const body = bytes.subarray(begin, tablesOf(1)), firstFrame = kHeadBytes + groups * kGroupBytes;
    const again = (from, size) => Array(times).fill(bytes.subarray(from, from + size));
    const head = Buffer.concat([bytes.subarray(0, kHeadBytes), ...again(kHeadBytes, kGroupBytes), ...again(firstFrame, frames * kFrameBytes),
                                Buffer.alloc(4)]);
    head.writeUInt32LE(times * frames, 12);
    head.writeUInt32LE(times, 16);
    head.writeFloatLE(fps, 20);
    for (let i = 0; i < times; ++i)
        head.writeBigUInt64LE(BigInt(head.length + i * body.length), kHeadBytes + i * kGroupBytes + kTablesBegin);
    head.writeUInt32LE(crc32(head.subarray(0, -4)), head.length - 4);
    return Buffer.concat([head, ...Array(times).fill(body)]);
}

/** A tone of so many seconds, as a WAV file. */
export function tone(seconds, rate = 16000) {
    const wav = Buffer.alloc(44 + 2 * Math.round(seconds * rate));
    for (const [at, text] of [[0, 'RIFF'], [8, 'WAVE'], [12, 'fmt '], [36, 'data']]) wav.write(text, at);
    for (const [at, value] of [[4, wav.length - 8], [16, 16], [24, rate], [28, 2 * rate], [40, wav.length - 44]]) wav.writeUInt32LE(value, at);
    for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) wav.writeUInt16LE(value, at);
    for (let i = 0; 44 + 2 * i < wav.length; ++i) wav.writeInt16LE(3000 * Math.sin(0.2 * i), 44 + 2 * i);
    return wav;
}
