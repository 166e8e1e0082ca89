// Which frames of a stream a player asks for: that of its time, and those after it as far as they come in time. What is
// not wanted any more is not fetched and not decoded.
import {kParts} from './nvs.js';

const kAhead = 4, kMostAhead = 6;  // frames that are asked for before they are due; at most, where they take long to come
const kFirstParts = 2;             // of a frame before any other is shown: its shape, and colours without harmonics
const kStands_ms = 250;            // what is shown for longer is read as a whole: it may stand still for some time yet

export class FrameQueue {
    #reader; #asked = new Map(); #first = -1; #since = 0; #shown = -1; #shownParts = 0;
    /** `reader`: a FrameReader, or what is like one. */
    constructor(reader) { this.#reader = reader; }

    /** The frame that is shown; −1: none is. */
    get shown() { return this.#shown; }
    has(frame) { return frame === this.#shown || Boolean(this.#asked.get(frame)?.tree); }
    /**
     * Follows a player to the frame of its time. `plays`: its time goes on; `waits`: it does as soon as that frame is
     * there. `seeks`: that frame is asked for alone until it is there. `frames`: that frame and those that are due after it,
     * where that is not the order of the stream.
     */
    follow(first, {plays, waits, seeks, rate, loops, frames = null}, now_ms = performance.now()) {
        if (first !== this.#first || waits) this.#since = now_ms;
        this.#first = first;
        const count = this.#reader.frames.length, lead = plays ? this.#reader.lead_s * this.#reader.fps * rate : 0;
        const ahead = Math.min(Math.max(kAhead, Math.ceil(lead) + 1), kMostAhead, count - 1);
        const wanted = new Map();  // frames, and how far ahead they are
        for (let i = 0; i <= ahead; ++i) {
            const frame = frames ? frames[i] : loops || first + i < count ? (first + i) % count : undefined;
            if (frame !== undefined && !wanted.has(frame)) wanted.set(frame, i);
        }
        const goesOn = (plays || waits) && !seeks;
        for (const [frame, one] of this.#asked) {
            if (wanted.has(frame) || (goesOn && this.#isLate(frame) && !one.error)) continue;
            this.#asked.delete(frame);
            one.stop.abort();
        }
        const stands = now_ms - this.#since >= kStands_ms;
        for (const [frame, i] of wanted) {
            if (i > 0 && (seeks || this.#shown < 0)) break;
            if (this.#asked.has(frame) || (frame === this.#shown && (this.#shownParts === kParts || !stands))) continue;
            if (i < Math.min(Math.floor(lead), ahead)) continue;  // its time would be over before it is there
            this.#ask(frame, this.#shown < 0 ? kFirstParts : stands ? kParts : this.#reader.partsInTime(frame), plays && !stands, now_ms);
        }
    }
    /**
     * What has come of the frame that is followed, or else of the last before it that is later than what is shown, once:
     * {tree} to be shown from then on, or {error}; null where nothing has.
     */
    take() {
        const come = [...this.#asked].filter(([frame, one]) => one.tree && (frame === this.#first || this.#isLate(frame)));
        if (come.length === 0) return this.#asked.get(this.#first)?.error ? this.#asked.get(this.#first) : null;
        const [frame, one] = come.reduce((a, b) => this.#behind(b[0]) < this.#behind(a[0]) ? b : a);
        this.#asked.delete(frame);
        this.#shown = frame;
        this.#shownParts = one.partCount;
        return one;
    }
    /** Those that could not be read are asked for again. */
    tryAgain() {
        for (const [frame, one] of this.#asked)
            if (one.error) this.#asked.delete(frame);
    }
    /** Nothing is shown any more, and nothing asked for. */
    clear() {
        for (const one of this.#asked.values()) one.stop.abort();
        this.#asked.clear();
        this.#shown = this.#first = -1;
    }

    // By how many frames it comes before the one that is followed.
    #behind(frame) {
        const count = this.#reader.frames.length;
        return (this.#first - frame + count) % count;
    }
    // What was begun and is over may still be shown before later frames are there.
    #isLate(frame) { return this.#shown >= 0 && this.#behind(frame) > 0 && this.#behind(frame) < this.#behind(this.#shown); }
    #ask(frame, partCount, inTime, now_ms) {
        const one = {tree: null, error: null, partCount, asked_ms: now_ms, stop: new AbortController()};
        this.#asked.set(frame, one);
        this.#reader.tree(frame, partCount, one.stop.signal).then(tree => {
            one.tree = tree;
            if (inTime) this.#reader.learnArrival((performance.now() - one.asked_ms) / 1000);
        }, error => one.error = error);
    }
}
