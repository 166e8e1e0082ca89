// The frames of a stream as slice trees: fetched by ranges, decoded in workers.
import {StreamError, crc32, headBytes, kParts, readHead} from './nvs.js';
import {RangeSource} from './source.js';

const kWorkers = 2;

/** A worker, which decodes what it is asked for in order. */
class Decoder {
    #worker = new Worker(new URL('worker.js', import.meta.url), {type: 'module'});
    #waiting = new Map(); #next = 0;
    last = -1;  // the frame that it is asked for last
    constructor() {
        this.#worker.onmessage = ({data}) => {
            const {resolve, reject} = this.#waiting.get(data.id);
            this.#waiting.delete(data.id);
            data.error ? reject(new StreamError(data.error)) : resolve(data.tree);
        };
        this.#worker.onerror = () => this.#rejectAll('the decoder could not be loaded');
    }
    get load() { return this.#waiting.size; }
    decode(request) {
        const id = this.#next++;
        const result = new Promise((resolve, reject) => this.#waiting.set(id, {resolve, reject}));
        this.#worker.postMessage({id, ...request});
        return result;
    }
    end() {
        this.#worker.terminate();
        this.#rejectAll('the player has ended');
    }
    #rejectAll(problem) {
        for (const {reject} of this.#waiting.values()) reject(new StreamError(problem));
        this.#waiting.clear();
    }
}

async function inflated(bytes) {
    try {
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
        return new Uint8Array(await new Response(stream).arrayBuffer());
    } catch {
        throw new StreamError('the tables of the stream are damaged');
    }
}

function expectWhole(bytes, crc) {
    if (crc32(bytes) !== crc) throw new StreamError('a part of the stream is damaged');
    return bytes;
}

export class FrameReader {
    #source; #decoders = Array.from({length: kWorkers}, () => new Decoder());
    fps = 0; frames = []; box = null;  // as readHead has them

    /** Opens the stream at an address. Throws StreamError. */
    static async open(url) {
        const reader = new FrameReader(), source = new RangeSource(url);
        reader.#source = source;
        try {
            const bytes = await source.read(0, headBytes(await source.begin()));
            const {fps, end, box, frames} = readHead(bytes);
            if (source.size < end) throw new StreamError('the file ends early');
            Object.assign(reader, {fps, box, frames});
        } catch (error) {
            reader.end();
            throw error;
        }
        return reader;
    }

    /** The slice tree of a frame, as worker.js makes it, with the box of its group. Throws StreamError. */
    async tree(frame) {
        const chain = [frame];
        while (!this.frames[chain[0]].isKey) chain.unshift(chain[0] - 1);
        const fetched = await Promise.all(chain.map(one => this.#fetched(one)));
        const decoder = this.#decoderFor(frame, chain);
        const begin = decoder.last >= chain[0] && decoder.last < frame ? decoder.last + 1 - chain[0] : 0;
        decoder.last = frame;
        const trees = await Promise.all(fetched.slice(begin).map(
            (request, i, all) => decoder.decode({...request, wantsTree: i === all.length - 1})));
        const {boxMin, boxSize} = this.frames[frame].group;
        return {...trees.at(-1), boxMin, boxSize};
    }
    end() {
        this.#source.cancel();
        for (const decoder of this.#decoders) decoder.end();
    }

    // One that has just decoded what the frame repeats; else the one with the least to do.
    #decoderFor(frame, chain) {
        if (chain.length > 1)
            for (const decoder of this.#decoders)
                if (decoder.last >= chain[0] && decoder.last < frame) return decoder;
        return this.#decoders.reduce((a, b) => b.load < a.load ? b : a);
    }
    async #fetched(number) {
        const {group, parts} = this.frames[number];
        group.inflated ??= this.#source.read(group.tables.begin, group.tables.bytes)
            .then(bytes => inflated(expectWhole(bytes, group.tables.crc)));
        group.inflated.catch(() => group.inflated = undefined);
        const [tables, ...read] = await Promise.all(
            [group.inflated, ...parts.map(({begin, bytes}) => this.#source.read(begin, bytes))]);
        const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.bytes, 0));
        let at = 0;
        for (const [i, part] of parts.entries()) {
            bytes.set(expectWhole(read[i], part.crc), at);
            at += part.bytes;
        }
        const {depth, degree, mostLeaves, boxSize} = group;
        return {group: {key: group.tables.begin, tables, depth, degree, mostLeaves, boxSize}, bytes,
                sizes: parts.map(part => part.bytes), partCount: kParts};
    }
}
