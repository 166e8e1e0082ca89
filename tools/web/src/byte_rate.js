// How fast bytes come from a server, as the engine's HttpSource measures it: with the time that the server needs to
// answer, without the time in which nothing is asked for. Several requests at the same time count once.

const kOlder = 0.7;     // what was measured before counts after this
const kLeast_ms = 100;  // of a measurement: as long as the requests of HttpSource take
// Without a byte for longer, the server stalls or the page has slept, and neither says how fast bytes come.
const kMostGap_ms = 2000;

export class ByteRate {
    #running = 0; #since = 0; #bytes = 0; #milliseconds = 0; #recentBytes = 0; #recent_ms = 0;
    #now;
    constructor(now = () => performance.now()) { this.#now = now; }

    /** A request begins. */
    begin() {
        if (this.#running++ === 0) this.#since = this.#now();
    }
    add(bytes) {
        this.#pass();
        this.#bytes += bytes;
    }
    /** A request ends, answered or not. */
    end() {
        this.#pass();
        --this.#running;
        if (this.#milliseconds < kLeast_ms) return;
        this.#recentBytes = kOlder * this.#recentBytes + this.#bytes;
        this.#recent_ms = kOlder * this.#recent_ms + this.#milliseconds;
        this.#bytes = this.#milliseconds = 0;
    }
    /** 0 where nobody knows yet. */
    get perSecond() {
        const milliseconds = this.#recent_ms + this.#milliseconds + (this.#running > 0 ? this.#gap_ms() : 0);
        return milliseconds > 0 ? 1000 * (this.#recentBytes + this.#bytes) / milliseconds : 0;
    }

    #gap_ms() { return Math.min(this.#now() - this.#since, kMostGap_ms); }
    #pass() {
        this.#milliseconds += this.#gap_ms();
        this.#since = this.#now();
    }
}
