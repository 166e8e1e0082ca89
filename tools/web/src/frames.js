// The frames of a stream as slice trees: fetched by ranges, decoded in workers.
import {instantiated} from './decoder.js';
import {FramePace} from './frame_pace.js';
import {loadedDecoder, newWorker} from './loaded.js';
import {StreamError, crc32, headBytes, kBeginnings, kCoarseParts, kLeastParts, kParts, readHead} from './nvs.js';
import {opened} from './source.js';

const kWorkers = Math.max(1, Math.min(4, (navigator.hardwareConcurrency ?? 2) - 1));
const kMostTableBytes = 1 << 20;  // inflated
const kMostTables = 8;            // groups whose tables are kept inflated
const kCoarsePlanes = 4;          // which are in that part
const kAhead_s = 3;               // of which the bytes are fetched before they are asked for

const kNothing = {frame: -1, partCount: 0};

/** A worker, which decodes what it is asked for in order. */
class Decoder {
    #worker = newWorker();
    #waiting = new Map(); #next = 0; #problem = ''; #ready; #group = null;  // whose tables it has
    last = kNothing;            // what it has decoded last
    planned = kNothing;         // what it is asked for last
    load = 0;                   // how many frames it is asked for and has not answered
    turn = Promise.resolve();   // when it has answered all of them
    constructor(module) {
        this.#worker.onmessage = ({data}) => {
            const {resolve, reject} = this.#waiting.get(data.id);
            this.#waiting.delete(data.id);
            if (data.error) this.#group = null;
            data.error ? reject(new StreamError(data.error)) : resolve(data);
        };
        this.#worker.onerror = () => this.#fail('the decoder could not be loaded');
        this.#ready = module.then(one => this.#worker.postMessage({module: one}), error => this.#fail(error.message));
    }
    get isBroken() { return this.#problem !== ''; }
    async decode(request) {
        await this.#ready;
        if (this.#problem) throw new StreamError(this.#problem);
        const id = this.#next++;
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, {resolve, reject});
            const {group} = request, tables = group.key === this.#group ? null : group.tables;
            this.#group = group.key;
            this.#worker.postMessage({id, ...request, group: {...group, tables}});
        });
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
    return joined(pieces);
}

function joined(all) {
    const bytes = new Uint8Array(all.reduce((sum, one) => sum + one.length, 0));
    let at = 0;
    for (const one of all) {
        bytes.set(one, at);
        at += one.length;
    }
    return bytes;
}

// The head of a stream, as readHead has it. A browser may keep one that came damaged: the server is asked once more.
async function headOf(source, isLast = false) {
    let bytes = await source.begin();
    try {
        const size = headBytes(bytes, source.size);
        bytes = await source.read(0, size);
        const head = readHead(bytes);
        if (source.size < head.end) throw new StreamError('the file ends early');
        return head;
    } catch (error) {
        if (isLast) throw error;
        source.forget(0, bytes.length);
        source.tryAgain();  // what it knows of the file may be wrong, too
        return headOf(source, true);
    }
}

export class FrameReader {
    #source; #inflated = new Map(); #decoders = []; #pace = null; #readsAhead = false; #budget = 0;
    #mostParts = new WeakMap();  // by group: how many are needed, where there is a budget
    /** So many bytes of the coarse part are fetched of a frame that is shown first. */
    static firstBytes = 48 << 10;
    fps = 0; frames = []; box = null;  // as readHead has them

    /**
     * Opens the stream at an address, which may be that of a Blob. `budget`: how many leaves a frame shall have at most; 0: no
     * limit. Throws StreamError.
     */
    static async open(url, budget = 0) {
        const reader = new FrameReader(), source = await opened(url);
        reader.#budget = budget;
        loadedDecoder().then(instantiated).then(codec => reader.#pace = new FramePace(codec, kWorkers))
            .catch(() => {});  // it is thrown where frames are asked for
        const {fps, box, frames} = await headOf(source);
        reader.#source = source;
        return Object.assign(reader, {fps, box, frames});
    }

    /**
     * The slice tree of a frame, as worker.js makes it, with the box of its group and the times that decoding took; from
     * its first `wantedParts` parts alone, or kBeginnings of nvs.js. Where the signal aborts, what has not come yet is not
     * fetched any more, and not decoded. What comes after it is read ahead for `user`. Throws StreamError, or what the signal
     * says.
     */
    async tree(frame, wantedParts = kParts, signal = null, user = null) {
        const partCount = this.#partCount(frame, wantedParts);
        this.#decoders = this.#decoders.filter(decoder => !decoder.isBroken);
        while (this.#decoders.length < kWorkers) this.#decoders.push(new Decoder(loadedDecoder()));
        const decoder = this.#decoderFor(frame, partCount), requests = new Map();
        const request = number => {
            if (!requests.has(number)) requests.set(number, this.#fetched(number, partCount, signal));
            requests.get(number).catch(() => {});  // it is thrown when its turn comes
            return requests.get(number);
        };
        for (let i = this.#firstFor(frame, partCount, decoder.planned); i <= frame; ++i) request(i);
        decoder.planned = {frame, partCount};
        ++decoder.load;
        const result = decoder.turn.then(() => this.#decoded(decoder, frame, partCount, request, signal));
        decoder.turn = result.catch(() => {}).finally(() => --decoder.load);
        if (this.#readsAhead) this.#readAhead(frame, partCount, user);
        const {boxMin, boxSize} = this.frames[frame].group, answer = await result.catch(error => {
            // Beginnings have no check of their own, so that damaged ones are found out late: the whole part has one.
            if (partCount !== kBeginnings || signal?.aborted || !(error instanceof StreamError)) throw error;
            return this.tree(frame, kLeastParts, signal, user);
        });
        this.#readsAhead = true;  // nothing shall come before the first frame that is shown
        return {...answer, boxMin, boxSize};
    }
    /** How many parts of a frame that is asked for now come in time while the stream plays. */
    partsInTime(frame) {
        return this.#pace?.parts(this.frames[frame].group, this.#source.bytesPerSecond, performance.now() / 1000) ?? kLeastParts;
    }
    /** What a tree took that is shown. What is done on this thread does not wait for decoders, and is left out. */
    learn(times) { this.#pace?.learn(times, times.tree_s); }
    /** A frame was there so many seconds after it was asked for so that it came in time. */
    learnArrival(seconds) { this.#pace?.learnArrival(seconds); }
    /** A frame that is asked for now is nearly always there after so many seconds. */
    get lead_s() { return this.#pace?.lead() ?? 0; }
    /** What is read ahead for one of those who read from it, in place of what was before. */
    readsAheadFor(user, ranges) { this.#source.readAhead(user, ranges); }
    /** Asks the server again, which has been given up. */
    tryAgain() { this.#source.tryAgain(); }
    /** Whether the bytes of a frame have come, of as many parts as are shown at least. */
    isFetched(frame) { return this.frames[frame].parts.slice(0, kLeastParts).every(({begin, bytes}) => this.#source.has(begin, bytes)); }
    end() {
        this.#source.cancel();
        for (const decoder of this.#decoders) decoder.end();
    }

    // Where there is little, the beginnings are not worth a second look.
    #partCount(frame, wanted) {
        const {isKey, parts, group} = this.frames[frame];
        if (wanted === kBeginnings && !(isKey && parts[1].bytes > FrameReader.firstBytes)) return kLeastParts;
        return Math.min(wanted, this.#mostParts.get(group) ?? kParts);
    }
    // Where decoding has to begin after what a decoder has decoded: with the frame after that, or with the key frame.
    #firstFor(frame, partCount, after) {
        let first = frame;
        while (!this.frames[first].isKey && first - 1 !== after.frame) --first;
        if (this.frames[first].isKey || after.partCount === partCount) return first;
        while (!this.frames[first].isKey) --first;
        return first;
    }
    // One that has decoded what the frame repeats; else the one with the least to do.
    #decoderFor(frame, partCount) {
        const count = decoder => frame - this.#firstFor(frame, partCount, decoder.planned);
        return this.#decoders.reduce((a, b) => count(b) < count(a) || (count(b) === count(a) && b.load < a.load) ? b : a);
    }
    // The bytes of the frames behind it are fetched meanwhile, of as many parts.
    #readAhead(frame, partCount, user) {
        const {group} = this.frames[frame], ranges = [];
        let end = frame + 1;  // of the frames that are read ahead
        while (end < this.frames.length && this.frames[end].group === group) ++end;
        for (let part = 0; part < partCount; ++part) {
            const {begin} = this.frames[frame].parts[part], last = this.frames[end - 1].parts[part];
            ranges.push({begin, bytes: last.begin + last.bytes - begin});
        }
        while (end < this.frames.length && end - frame < kAhead_s * this.fps) {
            const {tables, bytesUntil, frameCount} = this.frames[end].group;
            ranges.push({begin: tables.begin, bytes: bytesUntil[partCount - 1]});
            end += frameCount;
        }
        this.readsAheadFor(user, ranges);
    }
    // What was planned before may have been left out meanwhile.
    async #decoded(decoder, frame, partCount, request, signal) {
        const times = {shapes: 0, shapes_s: 0, planeBytes: 0, planes_s: 0, tree_s: 0};
        for (let i = this.#firstFor(frame, partCount, decoder.last);; ++i) {
            const one = await request(i);
            signal?.throwIfAborted();
            decoder.last = kNothing;
            const answer = await decoder.decode({...one, wantsTree: i === frame}).catch(error => {
                const {begin, bytes} = this.frames[i].parts[1];
                if (partCount === kBeginnings) this.#source.forget(begin, bytes);  // beginnings have no check of their own
                throw error;
            });
            decoder.last = {frame: i, partCount};
            this.#mostParts.set(this.frames[i].group, answer.coarser > 0 ? kCoarseParts : kParts);
            for (const [name, value] of Object.entries(answer.times)) times[name] += value;
            if (i === frame) return {...answer.tree, times};
        }
    }
    // Bytes of the file, as the head says that they are. Those that are not are asked for once more.
    async #read({begin, bytes, crc}, signal = null, isLast = false) {
        const read = await this.#source.read(begin, bytes, signal);
        if (crc32(read) === crc) return read;
        if (isLast) this.#refuse(begin, bytes);
        this.#source.forget(begin, bytes);
        return this.#read({begin, bytes, crc}, signal, true);
    }
    #refuse(begin, bytes) {
        this.#source.forget(begin, bytes);
        throw new StreamError('a part of the stream is damaged');
    }
    // The tables of a group, inflated. Those of the last few groups are kept.
    #tables(group) {
        if (!this.#inflated.has(group)) {
            const one = this.#read(group.tables).then(inflated);
            one.catch(() => this.#inflated.delete(group));  // they may come when they are asked for again
            this.#inflated.set(group, one);
        }
        for (const oldest of this.#inflated.keys()) {
            if (this.#inflated.size <= kMostTables) break;
            if (oldest !== group) this.#inflated.delete(oldest);
        }
        return this.#inflated.get(group);
    }
    // The coarse part of a frame as far as its streams shall be there: their lengths, then the same share of each.
    async #beginnings({begin, bytes}, signal) {
        const all = new Uint32Array((await this.#source.read(begin, 4 * kCoarsePlanes, signal, true)).buffer);
        if (all.reduce((sum, length) => sum + length, 4 * kCoarsePlanes) !== bytes) this.#refuse(begin, bytes);
        const lengths = all.map(length => 2 * Math.ceil(length * FrameReader.firstBytes / bytes / 2)), result = [new Uint8Array(lengths.buffer)];
        let at = begin + 4 * kCoarsePlanes;
        for (const [plane, length] of all.entries()) {
            result.push(this.#source.read(at, Math.min(lengths[plane], length), signal, true));
            at += length;
        }
        return joined(await Promise.all(result));
    }
    async #fetched(number, partCount, signal) {
        const {group, isKey, parts} = this.frames[number];
        const reads = parts.slice(0, partCount).map(part => this.#read(part, signal));
        if (partCount === kBeginnings) reads.push(this.#beginnings(parts[1], signal));
        const [tables, ...read] = await Promise.all([this.#tables(group), ...reads]);
        const bytes = joined(read), sizes = read.map(one => one.length);
        if (isKey !== (bytes[0] === 1)) throw new StreamError('a frame is a key frame or not, other than the head says');
        const {depth, degree, mostLeaves, boxSize} = group;
        return {group: {key: group.tables.begin, tables, depth, degree, mostLeaves, boxSize, budget: this.#budget}, bytes,
                sizes, partCount};
    }
}
