// The bytes of a file on a server, by ranges.
import {StreamError} from './nvs.js';

const kBlock = 1 << 14, kMostKept = 4096, kAhead = 4;  // bytes; blocks; how many are asked for at least, but at first
const kTries = 4, kPatience_ms = 15000, kPause_ms = 500;

const later = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));
const isPassing = status => status === 429 || status >= 500;

/** Reads ranges of a file in blocks of 16 KiB, of which it keeps 64 MiB. A request that fails is made four times. */
export class RangeSource {
    #url; #blocks = new Map(); #come = new Set(); #stop = new AbortController();
    size = Infinity;     // of the file, where its server says so
    readsAhead = false;  // whether at least 64 KiB are asked for at a time
    constructor(url) { this.#url = url; }

    /** A Uint8Array of [begin, begin + bytes). Throws StreamError. */
    async read(begin, bytes) {
        if (bytes === 0) return new Uint8Array(0);
        const first = Math.floor(begin / kBlock), last = Math.floor((begin + bytes - 1) / kBlock);
        const result = new Uint8Array(bytes);
        for (const [i, from] of (await Promise.all(this.#request(first, last))).entries()) {
            const at = (first + i) * kBlock, end = Math.min(begin + bytes - at, kBlock);
            if (from.length < end) throw new StreamError('the file ends early');
            result.set(from.subarray(Math.max(begin - at, 0), end), Math.max(at - begin, 0));
        }
        return result;
    }
    /** Whether [begin, begin + bytes) has come and is kept. */
    has(begin, bytes) {
        for (let block = Math.floor(begin / kBlock); block * kBlock < begin + bytes; ++block)
            if (!this.#come.has(block)) return false;
        return true;
    }
    /** The first bytes, at most 16 KiB. */
    begin() { return this.#request(0, 0)[0]; }
    cancel() { this.#stop.abort(); }

    // The blocks, as promises. Asks once for each run of those that are not there, and forgets the oldest others.
    #request(first, last) {
        for (let block = first; block <= last; ++block) {
            if (this.#blocks.has(block)) continue;
            const beyond = this.readsAhead ? Math.min(Math.max(last + 1, block + kAhead), Math.ceil(this.size / kBlock)) : last + 1;
            let end = block + 1;
            while (end < beyond && !this.#blocks.has(end)) ++end;
            const fetched = this.#fetched(block * kBlock, end * kBlock);
            for (let i = block; i < end; ++i) {
                const from = (i - block) * kBlock;
                const one = fetched.then(bytes => bytes.slice(from, from + kBlock));
                one.then(() => this.#come.add(i), () => this.#blocks.delete(i));  // it may come when it is asked for again
                this.#blocks.set(i, one);
            }
        }
        const wanted = Array.from({length: last - first + 1}, (_, i) => this.#blocks.get(first + i));
        for (const block of this.#blocks.keys()) {
            if (this.#blocks.size <= kMostKept) break;
            if (block >= first && block <= last) continue;
            this.#blocks.delete(block);
            this.#come.delete(block);
        }
        return wanted;
    }
    // Those from `begin` to before `end` that the file has.
    async #fetched(begin, end) {
        const result = new Uint8Array(end - begin);
        let filled = 0;
        while (filled < result.length && begin + filled < this.size) {
            const piece = await this.#tried(begin + filled, end);
            if (piece.length === 0) break;
            result.set(piece.subarray(0, result.length - filled), filled);
            filled += piece.length;
        }
        return result.subarray(0, Math.min(filled, result.length));
    }
    async #tried(begin, end) {
        for (let left = kTries - 1;; --left) {
            try {
                return await this.#fetchedOnce(begin, end);
            } catch (error) {
                if (this.#stop.signal.aborted || left === 0 || error.isFinal) throw error;
                await later(kPause_ms * (kTries - left));
            }
        }
    }
    // What the server sends of a range: all of it, or its beginning.
    async #fetchedOnce(begin, end) {
        const stop = new AbortController(), timer = setTimeout(() => stop.abort(), kPatience_ms), abort = () => stop.abort();
        this.#stop.signal.addEventListener('abort', abort);
        if (this.#stop.signal.aborted) abort();
        try {
            const answer = await fetch(this.#url, {headers: {Range: `bytes=${begin}-${end - 1}`}, signal: stop.signal});
            if (answer.status === 416) return new Uint8Array(0);
            if (answer.status === 206) return await this.#bytesOf(answer, begin);
            answer.body?.cancel();
            const problem = answer.status === 200 ? 'the server does not answer requests for ranges of bytes' : `the server answers ${answer.status}`;
            throw Object.assign(new StreamError(problem), {isFinal: !isPassing(answer.status)});
        } catch (error) {
            if (error instanceof StreamError) throw error;
            throw new StreamError(stop.signal.aborted ? 'the server does not answer'
                                                      : 'the server does not answer, or does not allow this page to read (CORS)');
        } finally {
            clearTimeout(timer);
            this.#stop.signal.removeEventListener('abort', abort);
        }
    }
    async #bytesOf(answer, begin) {
        const said = /^bytes (\d+)-\d+\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '');  // servers need not expose it
        if (said && Number(said[1]) !== begin) throw Object.assign(new StreamError('the server sends other bytes than asked for'), {isFinal: true});
        if (said) this.size = Number(said[2]);
        return new Uint8Array(await answer.arrayBuffer());
    }
}
