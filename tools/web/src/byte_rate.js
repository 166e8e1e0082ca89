// How fast bytes come from a server, as the engine's HttpSource measures it: with the time that the server needs to
// answer, without the time in which nothing is asked for. Several requests at the same time count once.

const kOlder = 0.7;     // what was measured before counts after this
const kLeast_ms = 100;  // of a measurement: as long as the requests of HttpSource take

export class ByteRate {
    #running = 0; #since = 0; #bytes = 0; #milliseconds = 0; #recentBytes = 0; #recent_ms = 0;
    #now;
    constructor(now = () => performance.now()) { this.#now = now; }

    /** A request begins. */
    begin() {
        if (this.#running++ === 0) this.#since = this.#now();
    }
    add(bytes) { this.#bytes += bytes; }
    /** A request ends, answered or not. */
    end() {
        const now = this.#now();
        --this.#running;
        this.#milliseconds += now - this.#since;
        this.#since = now;
        if (this.#milliseconds < kLeast_ms) return;
        this.#recentBytes = kOlder * this.#recentBytes + this.#bytes;
        this.#recent_ms = kOlder * this.#recent_ms + this.#milliseconds;
        this.#bytes = this.#milliseconds = 0;
    }
    /** 0 where nobody knows yet. */
    get perSecond() {
        const open_ms = this.#running > 0 ? this.#now() - this.#since : 0;
        const milliseconds = this.#recent_ms + this.#milliseconds + open_ms;
        return milliseconds > 0 ? 1000 * (this.#recentBytes + this.#bytes) / milliseconds : 0;
    }
}
