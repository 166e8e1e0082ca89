// The head of a .nvs file (engine/stream/README.md): its groups of frames, and where the parts of each frame lie.

export const kParts = 5;
export const kCoarseParts = 3;  // those that say nothing of the finest leaves
export const kLeastParts = 2;   // of a frame that are shown: its shape, and coarse colours without harmonics
export const kBeginnings = 1;   // the shape, and the beginnings of those: for a first picture, of a key frame
const kHeadBytes = 32, kFrameBytes = 4 + 8 * kParts, kMostFrames = 1e6;  // those of 9 hours
const kMostGroupFrames = 1000, kMostLeaves = 1 << 24, kMostDepth = 12, kMostDegree = 3, kLeastBox = 1e-6;  // metres
const kGroupBytes = {2: 64, 3: 88};  // by version

// What is wrong with a stream or its server, in a line that a viewer can understand.
export class StreamError extends Error {}

const kCrcTable = Uint32Array.from({length: 256}, (_, byte) => {
    let crc = byte;
    for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? 0xedb88320 ^ (crc >>> 1) : crc >>> 1;
    return crc;
});

/** The CRC-32 of zip and PNG. */
export function crc32(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) crc = kCrcTable[(crc ^ byte) & 255] ^ (crc >>> 8);
    return (crc ^ 0xffffffff) >>> 0;
}

function expect(condition, problem) {
    if (!condition) throw new StreamError(problem);
}

/** How many bytes the head of a file of `size` bytes has, by its first 32. Throws StreamError where these are of no stream. */
export function headBytes(bytes, size) {
    expect(bytes.length > 0, 'the file is empty');
    const first = new TextDecoder().decode(bytes.subarray(0, 8));
    expect(!first.trimStart().startsWith('<'), 'the server sent a web page, not a stream');
    expect(bytes.length >= kHeadBytes && first === 'NVStream', 'the file is no .nvs stream');
    const head = new DataView(bytes.buffer, bytes.byteOffset, kHeadBytes);
    const version = head.getUint32(8, true), frames = head.getUint32(12, true), groups = head.getUint32(16, true);
    expect(kGroupBytes[version], `the stream has version ${version}; this player reads 2 and 3`);
    expect(frames >= 1 && frames <= kMostFrames && groups >= 1 && groups <= frames, 'the head of the stream is damaged');
    const all = kHeadBytes + groups * kGroupBytes[version] + frames * kFrameBytes + 4;
    expect(all <= size, 'the file ends early');
    return all;
}

// The part of the box that leaves fill: nothing, or as large as a leaf.
function mayBeFilled(low, high) {
    if ([...low, ...high].every(part => part === 0)) return true;
    return low.every((part, axis) => part >= 0 && high[axis] <= 1 && high[axis] - part >= 2 ** -kMostDepth);
}

function readGroup(head, at, version) {
    const number = offset => head.getUint32(at + offset, true);
    const vector = offset => [0, 1, 2].map(axis => head.getFloat32(at + offset + 4 * axis, true));
    const group = {bytesUntil: [], frameCount: number(0), depth: number(4), degree: number(8), mostLeaves: number(12), boxMin: vector(16),
                   boxSize: vector(28), tables: {begin: Number(head.getBigUint64(at + 40, true)), bytes: number(48), crc: number(52)}};
    expect(group.frameCount >= 1 && group.frameCount <= kMostGroupFrames && group.depth >= 2 && group.depth <= kMostDepth &&
               group.depth % 2 === 0 && group.degree <= kMostDegree && group.mostLeaves <= kMostLeaves &&
               group.boxSize.every((edge, axis) => edge >= kLeastBox && Number.isFinite(Math.fround(group.boxMin[axis] + edge))),
           'the head of the stream is damaged');
    // Around the leaves of its frames: parts of the box; all 0 where there are none.
    const [low, high] = version >= 3 ? [vector(64), vector(76)] : [[0, 0, 0], [1, 1, 1]];
    expect(mayBeFilled(low, high), 'the head of the stream is damaged');
    const inWorld = parts => parts.map((part, axis) => group.boxMin[axis] + part * group.boxSize[axis]);
    group.filled = high.some(part => part > 0) ? {min: inWorld(low), max: inWorld(high)} : null;
    return group;
}

// Around the leaves of all groups, metres; around the first group's box where there are none.
function boxOf(groups) {
    const [{boxMin, boxSize}] = groups, filled = groups.map(group => group.filled).filter(Boolean);
    if (filled.length === 0) return {min: boxMin, max: boxMin.map((low, axis) => low + boxSize[axis])};
    return filled.reduce((all, one) => ({min: all.min.map((low, axis) => Math.min(low, one.min[axis])),
                                         max: all.max.map((high, axis) => Math.max(high, one.max[axis]))}));
}

/** Places the parts of a group's frames: those of one part stand behind each other, frame by frame. Returns their end. */
function placeParts(frames, group) {
    let at = group.tables.begin + group.tables.bytes;
    for (let part = 0; part < kParts; ++part) {
        for (const frame of frames) {
            frame.parts[part].begin = at;
            at += frame.parts[part].bytes;
        }
        group.bytesUntil.push(at - group.tables.begin);
    }
    return at;
}

/**
 * Reads a whole head of `bytes`: {fps, end, box: {min, max}, frames: [{group, isKey, parts: [{begin, bytes, crc}]}]};
 * `end`: how many bytes the file must have; `box`: around all leaves, metres. Throws StreamError where it is damaged.
 */
export function readHead(bytes) {
    const head = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    expect(bytes.length >= 4 && crc32(bytes.subarray(0, -4)) === head.getUint32(bytes.length - 4, true),
           'the head of the stream is damaged');
    const version = head.getUint32(8, true), frameCount = head.getUint32(12, true), groupCount = head.getUint32(16, true);
    const fps = head.getFloat32(20, true), groups = [], frames = [];
    expect(fps >= 0.001 && fps <= 10000, 'the head of the stream is damaged');
    let at = kHeadBytes, end = bytes.length;
    for (let i = 0; i < groupCount; ++i, at += kGroupBytes[version]) groups.push(readGroup(head, at, version));
    expect(groups.reduce((sum, group) => sum + group.frameCount, 0) === frameCount, 'the head of the stream is damaged');
    for (const [number, group] of groups.entries()) {
        const first = frames.length;
        Object.assign(group, {number, seconds: group.frameCount / fps});
        expect(group.tables.begin === end, 'the head of the stream is damaged');  // they stand behind each other
        for (let i = 0; i < group.frameCount; ++i, at += kFrameBytes) {
            const parts = Array.from({length: kParts}, (_, part) => ({begin: 0, bytes: head.getUint32(at + 4 + 4 * part, true),
                                                                      crc: head.getUint32(at + 24 + 4 * part, true)}));
            const key = head.getUint32(at, true);
            expect(key === 1 || (key === 0 && i > 0), 'the head of the stream is damaged');
            frames.push({group, isKey: key === 1, parts});
        }
        end = placeParts(frames.slice(first), group);
    }
    return {fps, end, box: boxOf(groups), frames};
}
