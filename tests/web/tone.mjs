/** A tone of so many seconds, as a WAV file. */
export function tone(seconds, rate = 16000) {
    const wav = Buffer.alloc(44 + 2 * Math.round(seconds * rate));
    for (const [at, text] of [[0, 'RIFF'], [8, 'WAVE'], [12, 'fmt '], [36, 'data']]) wav.write(text, at);
    for (const [at, value] of [[4, wav.length - 8], [16, 16], [24, rate], [28, 2 * rate], [40, wav.length - 44]]) wav.writeUInt32LE(value, at);
    for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) wav.writeUInt16LE(value, at);
    for (let i = 0; 44 + 2 * i < wav.length; ++i) wav.writeInt16LE(3000 * Math.sin(0.2 * i), 44 + 2 * i);
    return wav;
}
