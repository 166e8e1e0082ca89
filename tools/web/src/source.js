// The bytes of a file on a server, by ranges.
import {StreamError} from './nvs.js';

const kBlock = 1 << 16, kMostKept = 1024;  // bytes; blocks

/** Reads ranges of a file in blocks of 64 KiB, of which it keeps 64 MiB. */
export class RangeSource {
    #url; #blocks = new Map(); #stop = new AbortController();
    size = Infinity;  // of the file, where its server says so
    constructor(url) { this.#url = url; }

    /** A Uint8Array of [begin, begin + bytes). Throws StreamError. */
    async read(begin, bytes) {
        if (bytes === 0) return new Uint8Array(0);
        const first = Math.floor(begin / kBlock), last = Math.floor((begin + bytes - 1) / kBlock);
        this.#request(first, last);
        const result = new Uint8Array(bytes);
        for (let block = first; block <= last; ++block) {
            const from = await this.#blocks.get(block), at = block * kBlock;
            const cut = from.subarray(Math.max(begin - at, 0), Math.min(begin + bytes - at, kBlock));
            if (from.length < Math.min(begin + bytes - at, kBlock)) throw new StreamError('the file ends early');
            result.set(cut, Math.max(at - begin, 0));
        }
        return result;
    }
    /** The first bytes, at most 64 KiB. */
    async begin() {
        this.#request(0, 0);
        return this.#blocks.get(0);
    }
    cancel() { this.#stop.abort(); }

    // Asks once for each run of blocks that are not there.
    #request(first, last) {
        for (let block = first; block <= last; ++block) {
            if (this.#blocks.has(block)) continue;
            let end = block + 1;
            while (end <= last && !this.#blocks.has(end)) ++end;
            const fetched = this.#fetched(block * kBlock, end * kBlock);
            for (let i = block; i < end; ++i) {
                const from = (i - block) * kBlock;
                const one = fetched.then(bytes => bytes.subarray(from, from + kBlock));
                one.catch(() => this.#blocks.delete(i));  // it may come when it is asked for again
                this.#blocks.set(i, one);
            }
        }
        for (const block of this.#blocks.keys()) {
            if (this.#blocks.size <= kMostKept) break;
            if (block < first || block > last) this.#blocks.delete(block);
        }
    }
    async #fetched(begin, end) {
        let answer;
        try {
            answer = await fetch(this.#url, {headers: {Range: `bytes=${begin}-${end - 1}`}, signal: this.#stop.signal});
        } catch (error) {
            if (this.#stop.signal.aborted) throw error;
            throw new StreamError('the server does not answer, or does not allow this page to read (CORS)');
        }
        if (answer.status === 416) return new Uint8Array(0);
        if (answer.status === 200) {
            answer.body?.cancel();
            throw new StreamError('the server does not answer requests for ranges of bytes');
        }
        if (answer.status !== 206) throw new StreamError(`the server answers ${answer.status}`);
        const size = /\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '');
        if (size) this.size = Number(size[1]);
        return new Uint8Array(await answer.arrayBuffer());
    }
}
