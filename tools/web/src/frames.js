// The frames of a stream as slice trees: fetched by ranges, decoded in workers.
import {StreamError, crc32, headBytes, kParts, readHead} from './nvs.js';
import {RangeSource} from './source.js';

const kWorkers = Math.max(1, Math.min(4, (navigator.hardwareConcurrency ?? 2) - 1));
const kMostTableBytes = 1 << 20;  // inflated

/** A worker, which decodes what it is asked for in order. */
class Decoder {
    #worker = new Worker(new URL('worker.js', import.meta.url), {type: 'module'});
    #waiting = new Map(); #next = 0; #problem = '';
    last = -1;                  // the frame that it is asked for last; −1 where that failed
    load = 0;                   // how many frames it is asked for and has not answered
    turn = Promise.resolve();   // when it has answered all of them
    constructor() {
        this.#worker.onmessage = ({data}) => {
            const {resolve, reject} = this.#waiting.get(data.id);
            this.#waiting.delete(data.id);
            data.error ? reject(new StreamError(data.error)) : resolve(data.tree);
        };
        this.#worker.onerror = () => this.#fail('the decoder could not be loaded');
    }
    decode(request) {
        if (this.#problem) return Promise.reject(new StreamError(this.#problem));
        const id = this.#next++;
        const result = new Promise((resolve, reject) => this.#waiting.set(id, {resolve, reject}));
        this.#worker.postMessage({id, ...request});
        return result;
    }
    end() {
        this.#worker.terminate();
        this.#fail('the player has ended');
    }
    #fail(problem) {
        this.#problem = problem;
        for (const {reject} of this.#waiting.values()) reject(new StreamError(problem));
        this.#waiting.clear();
    }
}

async function inflated(bytes) {
    const pieces = [];
    let size = 0;
    try {
        for (const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')).getReader();;) {
            const {done, value} = await reader.read();
            if (done) break;
            pieces.push(value);
            if ((size += value.length) > kMostTableBytes) throw new StreamError('too large');
        }
    } catch {
        throw new StreamError('the tables of the stream are damaged');
    }
    return new Uint8Array(await new Blob(pieces).arrayBuffer());
}

function expectWhole(bytes, crc) {
    if (crc32(bytes) !== crc) throw new StreamError('a part of the stream is damaged');
    return bytes;
}

export class FrameReader {
    #source; #decoders = [];
    fps = 0; frames = []; box = null;  // as readHead has them

    /** Opens the stream at an address. Throws StreamError. */
    static async open(url) {
        const reader = new FrameReader(), source = new RangeSource(url);
        const bytes = await source.read(0, headBytes(await source.begin(), source.size));
        const {fps, end, box, frames} = readHead(bytes);
        if (source.size < end) throw new StreamError('the file ends early');
        reader.#source = source;
        return Object.assign(reader, {fps, box, frames});
    }

    /**
     * The slice tree of a frame, as worker.js makes it, with the box of its group; of a key frame also from its first
     * `partCount` parts alone. Throws StreamError.
     */
    async tree(frame, partCount = kParts) {
        if (this.#decoders.length === 0) this.#decoders = Array.from({length: kWorkers}, () => new Decoder());
        let first = frame;
        while (!this.frames[first].isKey) --first;
        const decoder = this.#decoderFor(frame, first);
        if (decoder.last >= first && decoder.last < frame) first = decoder.last + 1;
        const isWhole = partCount === kParts;
        this.#source.readsAhead = isWhole;
        const requests = Array.from({length: frame - first + 1}, (_, i) => this.#fetched(first + i, partCount));
        for (const one of requests) one.catch(() => {});  // it is thrown when its turn comes
        decoder.last = isWhole ? frame : -1;
        ++decoder.load;
        const result = decoder.turn.then(async () => {
            let tree = null;
            for (const [i, one] of requests.entries())
                tree = await decoder.decode({...await one, wantsTree: i === requests.length - 1});
            return tree;
        });
        decoder.turn = result.catch(() => decoder.last = -1).finally(() => --decoder.load);
        const {boxMin, boxSize} = this.frames[frame].group;
        return {...await result, boxMin, boxSize};
    }
    /** Whether all bytes of a frame have come. */
    isFetched(frame) { return this.frames[frame].parts.every(({begin, bytes}) => this.#source.has(begin, bytes)); }
    end() {
        this.#source.cancel();
        for (const decoder of this.#decoders) decoder.end();
    }

    // One that has decoded what the frame repeats; else the one with the least to do.
    #decoderFor(frame, first) {
        if (first < frame)
            for (const decoder of this.#decoders)
                if (decoder.last >= first && decoder.last < frame) return decoder;
        return this.#decoders.reduce((a, b) => b.load < a.load ? b : a);
    }
    async #fetched(number, partCount) {
        const {group, isKey, parts: all} = this.frames[number], parts = all.slice(0, partCount);
        group.inflated ??= this.#source.read(group.tables.begin, group.tables.bytes)
            .then(bytes => inflated(expectWhole(bytes, group.tables.crc)))
            .catch(error => {
                group.inflated = undefined;
                throw error;
            });
        const [tables, ...read] = await Promise.all(
            [group.inflated, ...parts.map(({begin, bytes}) => this.#source.read(begin, bytes))]);
        const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.bytes, 0));
        let at = 0;
        for (const [i, part] of parts.entries()) {
            bytes.set(expectWhole(read[i], part.crc), at);
            at += part.bytes;
        }
        if (isKey !== (bytes[0] === 1)) throw new StreamError('a frame is a key frame or not, other than the head says');
        const {depth, degree, mostLeaves, boxSize} = group;
        return {group: {key: group.tables.begin, tables, depth, degree, mostLeaves, boxSize}, bytes,
                sizes: all.map(part => part.bytes), partCount};
    }
}
