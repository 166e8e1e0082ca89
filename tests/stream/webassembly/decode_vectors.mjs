// Decodes the test vectors by the codec that `build` made, and compares them with what they should be.
// Usage: node decode_vectors.mjs CODEC.wasm FOLDER
import {readFileSync} from 'node:fs';
import {inflateSync} from 'node:zlib';
import {isDeepStrictEqual} from 'node:util';

const kParts = 5, kFixedBytes = 32, kGroupBytes = 88, kFrameBytes = 4 + 8 * kParts;

// The groups of a .nvs file that is whole, with the bytes of their tables and of their frames' parts.
function readGroups(file) {
    const head = new DataView(file.buffer, file.byteOffset, file.byteLength);
    const frameCount = head.getUint32(12, true), groupCount = head.getUint32(16, true);
    const groups = [];
    let at = kFixedBytes;
    for (let i = 0; i < groupCount; ++i, at += kGroupBytes) {
        const number = (offset) => head.getUint32(at + offset, true);
        groups.push({frames: [], count: number(0), depth: number(4), degree: number(8), most: number(12),
                     offset: Number(head.getBigUint64(at + 40, true)), tableBytes: number(48)});
    }
    for (const group of groups)
        for (let i = 0; i < group.count; ++i, at += kFrameBytes)
            group.frames.push({sizes: Array.from({length: kParts}, (_, part) => head.getUint32(at + 4 + 4 * part, true)),
                               parts: []});
    if (groups.reduce((sum, group) => sum + group.count, 0) !== frameCount) throw new Error('frames are missing');
    for (const group of groups) {
        let begin = group.offset + group.tableBytes;
        group.tables = inflateSync(file.subarray(group.offset, begin));
        for (let part = 0; part < kParts; ++part)
            for (const frame of group.frames) {
                frame.parts.push(file.subarray(begin, begin + frame.sizes[part]));
                begin += frame.sizes[part];
            }
    }
    return groups;
}

// The functions of the module. What it imports is called only where memory grows, or where it aborts.
async function instantiated(bytes) {
    const module = await WebAssembly.compile(bytes), imports = {};
    for (const {module: from, name} of WebAssembly.Module.imports(module))
        (imports[from] ??= {})[name] = () => {
            if (name !== 'emscripten_notify_memory_growth') throw new Error(`the codec calls ${name}`);
        };
    const {exports} = await WebAssembly.instantiate(module, imports);
    exports._initialize?.();
    return exports;
}

class Decoder {
    constructor(codec, group) {
        this.codec = codec;
        this.planes = 1 + 3 * (group.degree + 1) ** 2;
        const tables = this.copied(group.tables);
        this.group = codec.neuvv_group_new(tables, group.tables.length, group.depth, group.degree, group.most);
        codec.free(tables);
        if (!this.group) throw new Error('the group was refused');
    }
    copied(bytes) {
        const place = this.codec.malloc(bytes.length + 1);
        new Uint8Array(this.codec.memory.buffer).set(bytes, place);
        return place;
    }
    // The leaves and planes of the next frame, from its first `parts`; throws what is wrong.
    decode(frame, parts = kParts) {
        const codec = this.codec, bytes = Buffer.concat(frame.parts.slice(0, parts));
        const place = this.copied(bytes), sizes = this.copied(new Uint8Array(Uint32Array.from(frame.sizes).buffer));
        const count = codec.neuvv_group_decode(this.group, place, bytes.length, sizes, parts);
        codec.free(place);
        codec.free(sizes);
        if (count < 0) throw new Error(this.error());
        const leaves = [], planes = [], heap = new DataView(codec.memory.buffer);
        const first = codec.neuvv_group_leaves(this.group);
        for (let leaf = 0; leaf < count; ++leaf)
            leaves.push([Number(heap.getBigUint64(first + 16 * leaf, true)), heap.getUint32(first + 16 * leaf + 8, true)]);
        for (let plane = 0; plane < this.planes; ++plane) {
            const numbers = codec.neuvv_group_plane(this.group, plane);
            planes.push(Array.from({length: count}, (_, leaf) => heap.getInt16(numbers + 2 * leaf, true)));
        }
        return {leaves, planes};
    }
    error() {
        const bytes = new Uint8Array(this.codec.memory.buffer), from = this.codec.neuvv_group_error(this.group);
        return new TextDecoder().decode(bytes.slice(from, bytes.indexOf(0, from)));
    }
    free() { this.codec.neuvv_group_free(this.group); }
}

function refuses(decode, message) {
    try {
        decode();
    } catch (error) {
        if (String(error.message).includes(message)) return;
        throw error;
    }
    throw new Error(`was not refused: ${message}`);
}

const [module, folder] = process.argv.slice(2);
let repeating = 0;
const codec = await instantiated(readFileSync(module));
for (const name of ['small', 'usual', 'fine']) {
    const expected = JSON.parse(readFileSync(`${folder}/${name}.json`, 'utf8'));
    const groups = readGroups(readFileSync(`${folder}/${name}.nvs`));
    const frames = [], firstParts = [];
    for (const group of groups) {
        const decoder = new Decoder(codec, group);
        for (const frame of group.frames) frames.push(decoder.decode(frame));
        decoder.free();
    }
    for (let parts = 1; parts < kParts; ++parts) {
        const decoder = new Decoder(codec, groups[0]);
        firstParts.push(decoder.decode(groups[0].frames[0], parts));
        decoder.free();
    }
    if (!isDeepStrictEqual({frames, first_parts: firstParts}, expected)) throw new Error(`${name}.nvs is decoded wrongly`);

    const [key, next] = groups[0].frames, decoder = new Decoder(codec, groups[0]);
    refuses(() => decoder.decode({...key, parts: [key.parts[0].subarray(1)]}, 1), 'ends early');
    if (next.parts[0][0] === 0) {  // it repeats some of the key frame
        refuses(() => decoder.decode(next), 'needs the frame before it');
        decoder.decode(key, 2);
        refuses(() => decoder.decode(next), 'as many parts');
        ++repeating;
    }
    decoder.free();
    refuses(() => new Decoder(codec, {...groups[0], depth: 13}), 'refused');
    refuses(() => new Decoder(codec, {...groups[0], tables: groups[0].tables.subarray(2)}), 'refused');
    console.log(`${name}.nvs: ${frames.length} frames`);
}
if (repeating === 0) throw new Error('no vector repeats anything');
