// How many parts of its frames a player takes, so that they come in time: the engine's FramePace, in decoder.wasm.
import {copied} from './decoder.js';

export class FramePace {
    #codec; #pace;
    /** `codec`: the functions of decoder.wasm. `framesAtOnce`: how many frames are decoded at the same time. */
    constructor(codec, framesAtOnce) {
        this.#codec = codec;
        this.#pace = codec.neuvv_frame_pace_new(framesAtOnce);
        if (!this.#pace) throw new Error('there is no memory for the decoder');
    }
    /** What a frame took: as worker.js says it, and until it could be drawn. */
    learn({shapes, shapes_s, planeBytes, planes_s}, upload_s) {
        this.#codec.neuvv_frame_pace_learn(this.#pace, shapes, shapes_s, planeBytes, planes_s, upload_s);
    }
    /** A frame was there so many seconds after it was asked for. */
    learnArrival(seconds) { this.#codec.neuvv_frame_pace_learn_arrival(this.#pace, seconds); }
    /**
     * How many parts of the frames of a group come in time: the same for some seconds. `bytesUntil`: of all of its
     * frames, up to each part; `bytesPerSecond`: 0 where nobody knows yet, null of a file that is here.
     */
    parts({number, bytesUntil, frameCount, seconds}, bytesPerSecond, now_s) {
        const place = copied(this.#codec, new Uint8Array(Float64Array.from(bytesUntil).buffer));
        const count = this.#codec.neuvv_frame_pace_parts(this.#pace, number, place, frameCount, seconds, bytesPerSecond ?? -1, now_s);
        this.#codec.free(place);
        return count;
    }
    /** A frame that is asked for now is nearly always there after so many seconds. */
    lead() { return this.#codec.neuvv_frame_pace_lead(this.#pace); }
}
