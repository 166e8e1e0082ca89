// Plays a stream: a clock with the names and events of HTMLMediaElement, and the frames around its time.
import {FrameQueue} from './frame_queue.js';
import {openShared} from './shared_reader.js';
import {Sound} from './sound.js';

const kMostLate_s = 0.25;      // what is shown may be over for so long before the player waits for its frame
const kPull = 0.2;             // of the way to where the sound is, an image
const kMostStep = 250;         // milliseconds; a page that was hidden goes on where it was

/** How many leaves a budget allows: a number below 2^32, without its fraction; 0: all. Null where it is something else. */
export function leavesOf(budget) {
    const leaves = String(budget).trim() === '' ? NaN : Number(budget);
    return leaves === 0 || (leaves >= 1 && leaves < 2 ** 32) ? Math.floor(leaves) : null;
}

/** What HTMLMediaElement calls TimeRanges, of [begin, end) in seconds. */
class Ranges {
    #ranges;
    constructor(ranges) { this.#ranges = ranges; }
    get length() { return this.#ranges.length; }
    start(i) { return this.#ranges[i][0]; }
    end(i) { return this.#ranges[i][1]; }
}

/** Adds all that to a class of EventTargets, which has the property `loop`. */
export const playing = Base => class extends Base {
    #reader = null; #letGo = null; #opening = 0; #isOpening = false; #queue = null;
    #time = 0; #paused = true; #rate = 1; #last = null; #told = -1;
    #seeking = false; #hasData = false; #isWaiting = false; #ended = false;
    #start_s = 0;     // where a stream that is opened begins
    #starting = [];   // promises of play()
    #wanted = null;   // what open() was told last
    #isDisposed = false;  // by end()
    #sound = new Sound(() => this.#tell('volumechange'));
    /** What was wrong last: an Error, or null. */
    error = null;

    get paused() { return this.#paused; }
    get ended() { return this.#ended; }
    get seeking() { return this.#seeking; }
    /** Seconds; NaN while it is not known. */
    get duration() { return this.#reader ? this.#reader.frames.length / this.#reader.fps : NaN; }
    /** Frames a second; NaN while that is not known. */
    get frameRate() { return this.#reader?.fps ?? NaN; }
    get playbackRate() { return this.#rate; }
    set playbackRate(rate) {
        if (!(rate > 0 && rate <= 16)) throw new RangeError('playbackRate must be above 0 and at most 16');
        this.#rate = rate;
        this.#tell('ratechange');
    }
    get currentTime() {
        if (!this.#reader) return this.#start_s;
        return this.#time < this.#end() ? this.#time : this.duration;
    }
    set currentTime(seconds) {
        if (!Number.isFinite(seconds)) throw new TypeError('currentTime must be a number of seconds');
        if (!this.#reader) return void (this.#start_s = Math.max(0, seconds));
        this.#queue.tryAgain();
        this.#time = Math.max(0, Math.min(seconds, this.#end()));
        this.#seeking = true;
        this.#ended = false;
        this.#tell('seeking');
    }
    /** HTMLMediaElement's: 0 nothing, 1 the head is known, 2 the frame of this time is there, 4 those after it, too. */
    get readyState() {
        if (!this.#reader) return 0;
        const frame = this.#frameOf(this.#time);
        if (!this.#queue.has(frame)) return 1;
        return this.#queue.has(Math.min(frame + 1, this.#reader.frames.length - 1)) ? 4 : 2;
    }
    /** The times whose frames have been fetched. */
    get buffered() {
        const ranges = [], fps = this.#reader?.fps;
        for (const [frame] of (this.#reader?.frames ?? []).entries()) {
            if (!this.#reader.isFetched(frame)) continue;
            if (ranges.at(-1)?.[1] === frame / fps) ranges.at(-1)[1] = (frame + 1) / fps;
            else ranges.push([frame / fps, (frame + 1) / fps]);
        }
        return new Ranges(ranges);
    }
    /** Of its sound, 0 to 1. */
    get volume() { return this.#sound.volume; }
    set volume(volume) {
        if (!(volume >= 0 && volume <= 1)) throw new RangeError('volume must be from 0 to 1');
        this.#sound.volume = volume;
        this.#tell('volumechange');
    }
    get muted() { return this.#sound.muted; }
    set muted(on) {
        this.#sound.muted = Boolean(on);
        this.#tell('volumechange');
    }
    get hasSound() { return this.#sound.isThere; }
    /** Around all that is shown, metres: {min, max}; null while that is not known. */
    get box() { return this.#reader?.box ?? null; }

    /**
     * What could not be read is asked for again. Returns a promise, as HTMLMediaElement's does: it resolves when the
     * stream plays, and rejects where it is paused, disposed of or cannot be read before.
     */
    play() {
        if (this.#isDisposed) return Promise.reject(new DOMException('play() was called after dispose()', 'AbortError'));
        if (this.error && !this.#wanted) return Promise.reject(this.error);  // no stream was opened
        const started = this.#paused || this.#isWaiting ? new Promise((resolve, reject) => this.#starting.push({resolve, reject})) : Promise.resolve();
        if (this.#paused) this.#begin();
        return started;
    }
    #begin() {
        this.#queue?.tryAgain();
        if (this.error && this.#wanted && !this.#reader) this.open(...this.#wanted);
        if (this.#wanted) this.error = null;
        if (this.#time >= this.#end() && !this.loop) this.#time = 0;
        this.#paused = this.#ended = false;
        this.#isWaiting = true;  // `playing` comes with the first frame
        this.#last = null;
        this.#tell('play');
    }
    pause() {
        if (this.#paused) return;
        this.#paused = true;
        this.#endStarting(new DOMException('play() was ended by pause()', 'AbortError'));
        this.#sound.follow(this.#time, 0);
        this.#tell('pause');
    }
    /** Goes so many frames on, or back, and pauses. */
    step(frames = 1) {
        if (!this.#reader) return;
        this.pause();
        this.currentTime = (this.#frameOf(this.#time) + frames + 0.5) / this.#reader.fps;
    }

    /**
     * Opens the stream at an address, and ends the one before. `soundUrl`: of what is heard with it, or null. `budget`:
     * how many leaves shall be shown at most; 0: no limit. What is no such number is none, and is named on the console.
     */
    async open(url, soundUrl, budget = 0) {
        if (this.#reader) this.close();
        const opening = ++this.#opening, leaves = leavesOf(budget);
        this.#isOpening = true;
        this.#isDisposed = false;
        this.#wanted = [url, soundUrl, leaves ?? 0];
        if (leaves === null) console.warn(`NeuVV: the budget "${budget}" is no number of leaves, so all are shown; 0 says so, too`);
        try {
            const {reader, letGo} = await openShared(url, leaves ?? 0);
            if (opening !== this.#opening) return letGo();
            this.#reader = reader;
            this.#queue = new FrameQueue(reader);
            this.#letGo = letGo;
            this.#sound.open(soundUrl);
            if (this.#start_s > 0) this.currentTime = this.#start_s;
            this.#start_s = 0;
            this.#tell('durationchange');
            this.#tell('loadedmetadata');
        } catch (error) {
            if (opening === this.#opening) this.fail(error);
        }
    }
    /** Ends the stream that is open, or being opened, and pauses. */
    close() {
        this.#isDisposed = false;
        this.#close('play() was ended by another stream');
    }
    /** The same where none is to be opened: play() rejects until close() or open() is called. */
    end() {
        this.#isDisposed = true;
        this.#close('play() was ended by dispose()');
    }
    #close(why) {
        const wasEmpty = !this.#reader && !this.#isOpening && !this.error;
        this.#paused = true;
        this.#isOpening = false;
        this.#endStarting(new DOMException(why, 'AbortError'));
        ++this.#opening;  // what is being opened is dropped when it is there
        this.#queue?.clear();
        this.#letGo?.();
        this.#reader = this.#queue = this.#letGo = this.#wanted = null;
        this.#sound.end();
        this.#told = -1;
        this.#time = 0;
        this.#hasData = this.#seeking = this.#isWaiting = this.#ended = false;
        this.error = null;
        if (!wasEmpty) this.#tell('emptied');
    }
    /** Stops, and says why by the event `error`. */
    fail(error) {
        this.#endStarting(error);
        this.pause();
        this.error = error;
        this.dispatchEvent(new ErrorEvent('error', {error, message: error.message}));
    }
    /** Moves the clock on to `now`, milliseconds. Returns the slice tree that is to be shown from now on; null: it stays. */
    tick(now) {
        if (!this.#reader) return null;
        const opening = this.#opening;
        this.#advance(now);
        if (opening !== this.#opening) return null;  // a listener has opened another stream, or ended this one
        const waits = this.#isWaiting && !this.#paused;
        this.#queue.follow(this.#due(), {rate: this.#paused || waits ? 0 : this.#rate, waits, seeks: this.#seeking});
        return this.#takenFrame();
    }
    /**
     * Instead of tick(), where a clock elsewhere says what is due: the first of these frames now, the others after it. What
     * is heard is at `heard`, seconds, and passes so many times as fast as time; 0, or backwards: nothing is.
     */
    follow(frames, heard, rate) {
        if (!this.#reader) return null;
        this.#time = (frames[0] + 0.5) / this.#reader.fps;
        this.#sound.follow(heard, Math.max(0, rate));
        this.#queue.follow(frames, {rate});
        return this.#takenFrame();
    }
    /** What was shown last is lost: tick() returns it once more. */
    forgetShown() {
        this.#queue?.clear();
    }
    /** Where the sound comes from, metres, as who hears it sees it: right, up and back. */
    hearFrom(place) { this.#sound.place(place); }

    #tell(name) { this.dispatchEvent(new Event(name)); }
    // Settles what play() has returned.
    #endStarting(error = null) {
        for (const {resolve, reject} of this.#starting.splice(0)) error ? reject(error) : resolve();
    }
    #frameOf(seconds) { return Math.min(Math.floor(seconds * this.#reader.fps), this.#reader.frames.length - 1); }
    // The last time at which the last frame is shown.
    #end() { return this.#reader ? (this.#reader.frames.length - 0.001) / this.#reader.fps : 0; }

    // Moves the clock on, but not while its frame is missing.
    #advance(now) {
        const passed = Math.min(now - (this.#last ?? now), kMostStep);
        this.#last = now;
        if (this.#paused) return;
        if (this.#isWaiting !== this.#isLate()) {
            const opening = this.#opening;
            this.#isWaiting = !this.#isWaiting;
            if (!this.#isWaiting) this.#endStarting();
            this.#tell(this.#isWaiting ? 'waiting' : 'playing');
            if (opening !== this.#opening || this.#paused) return;
        }
        const heard = this.#sound.follow(this.#time, this.#isWaiting ? 0 : this.#rate);
        if (this.#isWaiting) return;
        const next = this.#time + passed / 1000 * this.#rate;
        this.#time = Math.max(this.#time, heard === null ? next : next + kPull * (heard - next));
        if (this.#time < this.#end()) return;
        if (this.loop) {
            this.#time %= this.duration;
        } else {
            this.#time = this.#end();
            this.#ended = true;
            this.pause();
            this.#tell('ended');
        }
    }
    // A frame that comes late is left out. Where none comes, the player waits for that of its time and the one after it.
    #isLate() {
        const frame = this.#frameOf(this.#time), next = Math.min(frame + 1, this.#reader.frames.length - 1);
        if (this.#queue.has(frame) && (!this.#isWaiting || this.#queue.isSettled(next))) return false;
        const over_s = (this.#queue.shown + 1) / this.#reader.fps;  // when what is shown is
        const late_s = this.#time >= over_s ? this.#time - over_s : this.#time + this.duration - over_s;
        return this.#isWaiting || this.#seeking || this.#queue.shown < 0 || late_s > kMostLate_s * this.#rate;
    }
    // The frame of this time and those after it.
    #due() {
        const count = this.#reader.frames.length, first = this.#frameOf(this.#time), due = [];
        for (let i = 0; i <= Math.min(this.#queue.ahead(this.#rate), count - 1); ++i)
            if (this.loop || first + i < count) due.push((first + i) % count);
        return due;
    }
    #takenFrame() {
        const one = this.#queue.take(), opening = this.#opening;
        if (one?.error && one.error !== this.error) this.fail(one.error);  // once, until play() tries again
        if (one?.tree) {
            this.#reader.learn(one.tree.times);
            if (!this.#hasData) {
                this.#hasData = true;
                this.#tell('loadeddata');
                this.#tell('canplay');
            }
        }
        if (opening !== this.#opening) return null;
        if (this.#seeking && this.#frameOf(this.#time) === this.#queue.shown) {
            this.#seeking = false;
            this.#tell('seeked');
        }
        if (this.#told !== this.#time) {
            this.#told = this.#time;
            this.#tell('timeupdate');
        }
        return opening === this.#opening ? one?.tree ?? null : null;
    }
};
