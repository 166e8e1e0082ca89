// The bytes of a file: on a server, by ranges, or in the page.
import {ByteRate} from './byte_rate.js';
import {StreamError} from './nvs.js';

const kBlock = 1 << 12, kMostKept = 16384;  // bytes; blocks
const kRun = 4;                             // blocks that are asked for together, where nothing else is said
// Two requests at the same time, in their order: the server is always asked for something, and what is needed later
// slows down others little.
const kMostRequests = 2;
// Of what is read ahead, as much is asked for as comes in so many seconds, between so many blocks. Who waits for others
// must wait for these first.
const kRequestAhead_s = 0.25, kLeastOfARequest = 16, kMostOfARequest = 256;
const kTries = 4, kPatience_ms = 15000, kPause_ms = 500;

const later = (milliseconds, signal) => new Promise(resolve => {
    setTimeout(resolve, milliseconds);
    signal.addEventListener('abort', resolve);
});
const isPassing = status => status === 429 || status >= 500;
function problemOfStatus(status) {
    if (status === 200) return 'the server does not answer requests for ranges of bytes';
    return `the server answers ${status}${status === 404 || status === 410 ? ': there is no such file; check the address' : ''}`;
}

/** Reads ranges of a file in blocks of 4 KiB, of which it keeps 64 MiB. A request that brings nothing is made four times. */
export class RangeSource {
    #url; #blocks = new Map(); #requests = new Set(); #problem = null; #rate = new ByteRate();
    #ahead = new Map();  // ranges of blocks, by whom they are for
    #damaged = new Set();  // blocks that are not taken from the browser's cache until they have come anew
    size = Infinity;  // of the file, where its server says so
    constructor(url) { this.#url = url; }

    /** As bytes come from the server; 0 where nobody knows yet, below 0 where they are here. */
    get bytesPerSecond() { return this.#rate.perSecond; }
    /**
     * A Uint8Array of [begin, begin + bytes). Throws StreamError, and what the signal says where it aborts. `isAlone`: what lies
     * around it is not needed.
     */
    async read(begin, bytes, signal = null, isAlone = false) {
        signal?.throwIfAborted();
        if (bytes === 0) return new Uint8Array(0);
        const first = Math.floor(begin / kBlock), last = Math.floor((begin + bytes - 1) / kBlock);
        const result = new Uint8Array(bytes);
        for (const [i, from] of (await this.#awaited(this.#request(first, last, isAlone), signal)).entries()) {
            const at = (first + i) * kBlock, end = Math.min(begin + bytes - at, kBlock);
            if (from.length < end) {
                this.forget(at, end);
                this.size = Infinity;  // it may have been told wrong
                throw new StreamError('the file ends early');
            }
            result.set(from.subarray(Math.max(begin - at, 0), end), Math.max(at - begin, 0));
        }
        return result;
    }
    /**
     * Says what `user` reads next, the first first, as {begin, bytes}, so that it is fetched while nothing else is; in place
     * of what was said for it before.
     */
    readAhead(user, ranges) {
        const blocks = ranges.filter(({bytes}) => bytes > 0)
            .map(({begin, bytes}) => ({first: Math.floor(begin / kBlock), end: Math.floor((begin + bytes - 1) / kBlock) + 1}));
        ranges.length > 0 ? this.#ahead.set(user, blocks) : this.#ahead.delete(user);
        const all = [...this.#ahead.values()].flat();
        for (const request of this.#requests)
            if (request.waiting === 0 && !all.some(({first, end}) => request.first < end && first < request.end))
                this.#drop(request);
        this.#goOn();
    }
    /** Whether [begin, begin + bytes) has come and is kept. */
    has(begin, bytes) {
        for (let block = Math.floor(begin / kBlock); block * kBlock < begin + bytes; ++block)
            if (!this.#blocks.get(block)?.isThere) return false;
        return true;
    }
    /** Forgets [begin, begin + bytes), which is wrong, with all that came with it: next, they come from the server itself. */
    forget(begin, bytes) {
        const wrong = new Set();
        for (let block = Math.floor(begin / kBlock); block * kBlock < begin + bytes; ++block) {
            const one = this.#blocks.get(block);
            if (!one) this.#damaged.add(block);
            else if (one.isThere) wrong.add(one.request);  // else it comes anew already
        }
        for (const block of this.#forgetAll(wrong)) this.#damaged.add(block);
    }
    /** The first bytes, at most 4 KiB; what is asked for of those behind them comes with them. */
    begin() { return this.#request(0, 0, false)[0].bytes; }
    cancel() {
        this.#stop(new StreamError('the player has ended'));
    }
    /** Asks the server again, which has been given up. */
    tryAgain() {
        this.#problem = null;
        this.size = Infinity;  // it may have been told wrong
    }

    // Of requests for which nobody waits any more, those that are not answered end with the signal.
    #awaited(blocks, signal) {
        const all = Promise.all(blocks.map(({bytes}) => bytes));
        if (!signal) {
            for (const {request} of blocks) request.waiting = Infinity;
            return all;
        }
        const requests = new Set(blocks.map(({request}) => request));
        for (const request of requests) ++request.waiting;
        return new Promise((resolve, reject) => {
            const abort = () => {
                for (const request of requests)
                    if (--request.waiting === 0) this.#drop(request);
                reject(signal.reason);
            };
            signal.addEventListener('abort', abort);
            all.then(resolve, reject).finally(() => signal.removeEventListener('abort', abort));
        });
    }
    // All that waits ends with the problem, and what is asked for from now on.
    #stop(problem) {
        this.#problem = problem;
        for (const request of this.#requests) request.stop.abort();
        this.#goOn();
    }
    // Lets the next requests begin, and where none waits, asks for what is read ahead.
    #goOn() {
        let running = 0;
        for (const request of this.#requests)
            if (++running <= kMostRequests || request.stop.signal.aborted) request.begin();
        const most = Math.min(Math.max(kLeastOfARequest, Math.floor(kRequestAhead_s * this.bytesPerSecond / kBlock)), kMostOfARequest);
        for (const range of [...this.#ahead.values()].flat())
            for (; range.first < range.end; ++range.first) {
                if (this.#requests.size >= kMostRequests || this.#problem) return;
                if (!this.#blocks.has(range.first)) this.#beginRuns(range.first, Math.min(range.end, range.first + most));
            }
    }
    #forgetAll(requests) {
        const blocks = [...this.#blocks.keys()].filter(block => requests.has(this.#blocks.get(block).request));
        for (const block of blocks) this.#blocks.delete(block);
        return blocks;
    }
    #isDamaged(begin, end) {
        for (let block = Math.floor(begin / kBlock); block * kBlock < end; ++block)
            if (this.#damaged.has(block)) return true;
        return false;
    }
    #drop(request) {
        if (!this.#requests.has(request)) return;  // it is answered
        this.#forgetAll(new Set([request]));
        request.stop.abort();
        request.begin();  // to its end
    }
    // The blocks, as promises. Asks once for each run of those that are not there, and forgets the oldest others.
    #request(first, last, isAlone) {
        for (let block = first; block <= last; ++block) {
            if (!this.#blocks.has(block)) isAlone ? this.#begin(block, last + 1) : this.#beginRuns(block, last + 1);
        }
        const wanted = Array.from({length: last - first + 1}, (_, i) => this.#blocks.get(first + i));
        for (const block of this.#blocks.keys()) {
            if (this.#blocks.size <= kMostKept) break;
            if (block < first || block > last) this.#blocks.delete(block);
        }
        return wanted;
    }
    // Asks for the blocks from `first` on that are not there, up to one that is, or to before `most`.
    #begin(first, most) {
        let end = first + 1;
        while (end < most && !this.#blocks.has(end)) ++end;
        const request = {first, end, stop: new AbortController(), waiting: 0, begin: null};  // waiting: how many reads
        const turn = new Promise(resolve => request.begin = resolve);
        this.#requests.add(request);
        const fetched = turn.then(() => this.#fetched(first * kBlock, end * kBlock, request.stop.signal)).finally(() => {
            this.#requests.delete(request);
            this.#goOn();
        });
        if (this.#requests.size <= kMostRequests) request.begin();
        for (let i = first; i < end; ++i) {
            const from = (i - first) * kBlock;
            const one = {request, isThere: false, bytes: fetched.then(bytes => bytes.slice(from, from + kBlock))};
            one.bytes.then(() => {
                one.isThere = true;
                this.#damaged.delete(i);
            }, () => {  // it may come when it is asked for again
                if (this.#blocks.get(i) === one) this.#blocks.delete(i);
            });
            this.#blocks.set(i, one);
        }
    }
    // The same of the whole runs in which these blocks are.
    #beginRuns(first, most) {
        while (first % kRun > 0 && !this.#blocks.has(first - 1)) --first;
        this.#begin(first, kRun * Math.ceil(most / kRun));
    }
    // Those from `begin` to before `end` that the file has. What has come is kept; tries in a row that bring nothing are counted.
    async #fetched(begin, end, signal) {
        const result = new Uint8Array(end - begin);
        let filled = 0, tries = 0;
        while (filled < result.length && begin + filled < this.size) {
            const before = filled;
            if (this.#problem) throw this.#problem;
            try {
                await this.#fetchedOnce(begin + filled, end, signal, piece => {
                    result.set(piece, filled);
                    filled += piece.length;
                });
                if (filled === before && this.size < Infinity) throw new StreamError('the server sends less than it has');
                if (filled === before) break;
            } catch (error) {
                if (signal.aborted || error.isFinal) throw this.#problem ?? error;
                tries = filled > before ? 1 : tries + 1;
                if (tries === kTries) {
                    this.#stop(new StreamError(`${error.message}; press play to try again`));
                    throw this.#problem;
                }
                await later(kPause_ms * tries, signal);
            }
        }
        return result.subarray(0, filled);
    }
    // Hands on what the server sends of a range: all of it, or its beginning. It may pause for so long, but no longer.
    async #fetchedOnce(begin, end, signal, take) {
        const stop = new AbortController(), abort = () => stop.abort();
        let timer = setTimeout(abort, kPatience_ms);
        signal.addEventListener('abort', abort);
        if (signal.aborted) abort();
        this.#rate.begin();
        try {
            const cache = this.#isDamaged(begin, end) ? 'reload' : 'default';
            const answer = await fetch(this.#url, {headers: {Range: `bytes=${begin}-${end - 1}`}, signal: stop.signal, cache});
            if (answer.status === 416) return;
            if (answer.status === 206)
                return await this.#takePieces(answer, begin, end, piece => {
                    clearTimeout(timer);
                    timer = setTimeout(abort, kPatience_ms);
                    take(piece);
                });
            answer.body?.cancel();
            const mayPass = isPassing(answer.status) || (answer.status === 200 && this.size < Infinity);  // it has answered them
            throw Object.assign(new StreamError(problemOfStatus(answer.status)), {isFinal: !mayPass});
        } catch (error) {
            if (error instanceof StreamError) throw error;
            const mayBeForbidden = !stop.signal.aborted && this.#url.origin !== globalThis.location?.origin;
            throw new StreamError(`the server does not answer${mayBeForbidden ? ', or does not allow this page to read (CORS)' : ''}`);
        } finally {
            this.#rate.end();
            clearTimeout(timer);
            signal.removeEventListener('abort', abort);
        }
    }
    async #takePieces(answer, begin, end, take) {
        const said = /^bytes (\d+)-\d+\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '');  // servers need not expose it
        const problem = said && this.#problemOf(Number(said[1]) - begin, Number(said[2]));
        if (problem) {
            answer.body.cancel();
            throw new StreamError(problem);
        }
        if (said) this.size = Number(said[2]);
        let left = end - begin;
        for (const reader = answer.body.getReader();;) {
            const {done, value} = await reader.read();
            if (done) return;
            this.#rate.add(value.length);
            if (value.length > left) {
                reader.cancel();
                throw new StreamError('the server sends more bytes than asked for');
            }
            left -= value.length;
            take(value);
        }
    }
    // Of a range that begins so much after the one that was asked for, of a file of so many bytes.
    #problemOf(after, size) {
        if (after !== 0) return 'the server sends other bytes than asked for';
        return this.size !== Infinity && this.size !== size ? 'the server has another file now' : '';
    }
}

/** The same of a Blob. */
class BlobSource {
    #blob;
    bytesPerSecond = -1;
    constructor(blob) { this.#blob = blob; }
    get size() { return this.#blob.size; }
    async read(begin, bytes) {
        const read = new Uint8Array(await this.#blob.slice(begin, begin + bytes).arrayBuffer());
        if (read.length < bytes) throw new StreamError('the file ends early');
        return read;
    }
    readAhead() {}
    has() { return true; }
    forget() {}
    tryAgain() {}
    begin() { return this.read(0, Math.min(this.size, kBlock)); }
    cancel() {}
}

/** The source of what is at an address. */
export async function opened(url) {
    return url.protocol === 'blob:' ? new BlobSource(await (await fetch(url)).blob()) : new RangeSource(url);
}
