// Which frames of a stream a player asks for: those that are due as far as they come in time. What is not wanted any more
// is not fetched and not decoded.
import {kBeginnings, kParts} from './nvs.js';

const kAhead = 4, kMostAhead = 6;  // frames that are asked for before they are due; at most, where they take long to come
const kAsleep_ms = 1000;           // who has not asked for longer is hidden or sleeps: what comes then says nothing of later
const kStands_ms = 250;            // what is shown for longer is read as a whole: it may stand still for some time yet

export class FrameQueue {
    #reader; #asked = new Map(); #count = 0;
    #due = []; #since = 0;  // when the first that is due was there
    #followedAt = 0;
    #shown = {frame: -1, partCount: 0, number: -1};
    /** `reader`: a FrameReader, or what is like one. */
    constructor(reader) { this.#reader = reader; }

    /** The frame that is shown; −1: none is. */
    get shown() { return this.#shown.frame; }
    has(frame) { return frame === this.shown || Boolean(this.#asked.get(frame)?.tree); }
    /** Whether a frame is there, or cannot be read. */
    isSettled(frame) { return this.has(frame) || Boolean(this.#asked.get(frame)?.error); }
    /** How many frames it should be told of before they are due, where time passes so many times as fast as usual. */
    ahead(rate) { return Math.min(Math.max(kAhead, Math.ceil(this.#lead(rate)) + 1), kMostAhead); }
    /**
     * Asks for these frames: the first is due now, the others after it. `rate`: how fast time passes; 0: it stands still.
     * `waits`: until more is there. `seeks`: the first is asked for alone until it is there.
     */
    follow(due, {rate, waits = false, seeks = false}, now_ms = performance.now()) {
        const [first] = due, goesOn = this.#due.includes(first) && !seeks;
        if (first !== this.#due[0] || !this.has(first) || waits) this.#since = now_ms;
        this.#due = [...new Set(due)];
        this.#followedAt = performance.now();
        for (const [frame, one] of this.#asked) {
            if (this.#due.includes(frame) || (goesOn && one.number > this.#shown.number && !one.error)) continue;
            this.#asked.delete(frame);
            one.stop.abort();
        }
        const stands = now_ms - this.#since >= kStands_ms, lead = Math.min(Math.floor(this.#lead(rate)), due.length - 1);
        for (const [i, frame] of this.#due.entries()) {
            if (i > 0 && (seeks || this.shown < 0)) break;
            if (this.#asked.has(frame) || (frame === this.shown && (this.#shown.partCount === kParts || !stands))) continue;
            if (i < lead && !stands) continue;  // its time would be over before it is there
            const partCount = this.shown < 0 ? kBeginnings : stands ? kParts : this.#reader.partsInTime(frame);
            this.#ask(frame, partCount, rate !== 0 && !stands, now_ms);
        }
    }
    /**
     * What has come of the frame that is due, or else of the last before it that is later than what is shown, once: {tree}
     * to be shown from then on, or {error}; null where nothing has.
     */
    take() {
        const first = this.#asked.get(this.#due[0]);
        const late = [...this.#asked.values()].filter(one => one.tree && !this.#due.includes(one.frame) && one.number > this.#shown.number);
        const one = first?.tree ? first : late.at(-1) ?? (first?.error ? first : null);
        if (!one?.tree) return one;
        this.#asked.delete(one.frame);
        this.#shown = one;
        return one;
    }
    /** Those that could not be read are asked for again. */
    tryAgain() {
        this.#reader.tryAgain();
        for (const [frame, one] of this.#asked)
            if (one.error) this.#asked.delete(frame);
    }
    /** Nothing is shown any more, and nothing asked for. */
    clear() {
        for (const one of this.#asked.values()) one.stop.abort();
        this.#asked.clear();
        this.#due = [];
        this.#shown = {frame: -1, partCount: 0, number: -1};
        this.#reader.readsAheadFor(this, []);
    }

    // In how many frames one that is asked for now will be there.
    #lead(rate) { return this.#reader.lead_s * this.#reader.fps * Math.abs(rate); }
    // They are numbered in the order in which they are due, so that what is late is known from what is too old.
    #ask(frame, partCount, inTime, now_ms) {
        const one = {frame, partCount, number: this.#count++, tree: null, error: null, stop: new AbortController()};
        this.#asked.set(frame, one);
        this.#reader.tree(frame, partCount, one.stop.signal, this).then(tree => {
            const now = performance.now();
            one.tree = tree;
            if (inTime && now - this.#followedAt < kAsleep_ms) this.#reader.learnArrival((now - now_ms) / 1000);
        }, error => one.error = error);
    }
}
