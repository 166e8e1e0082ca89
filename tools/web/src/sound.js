// The sound of a stream, which comes from where the performer is. Where sound and frames are a little apart, the frames
// wait, which nobody notices.

const kJump = 0.5;       // seconds; a clock that goes on by more of its own between two images has jumped
const kLeastRate = 1 / 16, kMostRate = 16;  // outside of which browsers play no sound
const kMostApart = 1;    // seconds between sound and frames that are waited for
const kUsualDistance = 2;  // metres at which it is as loud as its file: kUsualDistance_m of engine/stage/sound/pan.h

export class Sound {
    #audio = null; #context = null; #panner = null; #volume = 1; #muted = false; #isBlocked = false; #last = 0; #changed;
    #whenHidden = () => document.hidden && this.#audio?.pause();
    /** `changed`: is called when it is known whether there is a sound. */
    constructor(changed) { this.#changed = changed; }

    get isThere() { return this.#audio?.readyState > 0; }

    get volume() { return this.#volume; }
    set volume(volume) {
        this.#volume = volume;
        if (this.#audio) this.#audio.volume = volume;
        this.#context?.resume();  // which a browser may have refused before it could be heard
    }
    get muted() { return this.#muted; }
    set muted(on) {
        this.#muted = on;
        if (this.#audio) this.#audio.muted = on;
        this.#context?.resume();
    }
    /** Opens the sound at an address; null: there is none. One that cannot be read is silent. */
    open(url) {
        this.end();
        if (!url) return;
        this.#audio = Object.assign(new Audio(), {crossOrigin: 'anonymous', preload: 'auto', volume: this.#volume, muted: this.#muted, src: url});
        this.#audio.onloadedmetadata = this.#changed;
        document.addEventListener('visibilitychange', this.#whenHidden);  // no image is drawn then, which could stop it
    }
    /**
     * It is heard from `time`, seconds, on, so many times as fast; it is silent where that is too slow or too fast, so also
     * at 0. Returns where it is, which frames have to keep to; null where it does not run. It begins anew only where `time`
     * jumps: a browser may take long for that.
     */
    follow(time, rate) {
        const audio = this.#audio, isJump = time < this.#last || time > this.#last + kJump * Math.max(1, rate);
        this.#last = time;
        if (!audio || audio.error) return null;
        if (rate < kLeastRate || rate > kMostRate || time >= audio.duration || document.hidden) {
            audio.pause();
            return null;
        }
        audio.playbackRate = rate;
        if (audio.paused && this.#mustWait()) return null;
        if (isJump || audio.paused || Math.abs(time - audio.currentTime) > kMostApart * Math.max(1, rate)) audio.currentTime = time;
        if (audio.paused) this.#begin();
        return audio.paused || audio.seeking || audio.readyState < HTMLMediaElement.HAVE_FUTURE_DATA ? null : audio.currentTime;
    }
    /** Where it comes from, metres: right of, above and behind who hears it. */
    place([right, up, back]) {
        if (!this.#panner) return;
        this.#panner.positionX.value = right;
        this.#panner.positionY.value = up;
        this.#panner.positionZ.value = back;
    }
    end() {
        document.removeEventListener('visibilitychange', this.#whenHidden);
        this.#audio?.pause();
        this.#audio?.removeAttribute('src');  // which ends its request
        this.#audio = this.#panner = null;
        this.#context?.close();
        this.#context = null;
    }

    // Browsers let no page be heard before somebody has touched it.
    #mustWait() { return this.#isBlocked && navigator.userActivation?.hasBeenActive === false; }
    #begin() {
        this.#isBlocked = false;
        this.#audio.play().then(() => this.#spread(), error => this.#isBlocked = error.name === 'NotAllowedError');
    }
    #spread() {
        if (this.#context || !this.#audio) return void this.#context?.resume();
        this.#context = new AudioContext();
        this.#panner = new PannerNode(this.#context, {panningModel: 'HRTF', distanceModel: 'inverse', refDistance: kUsualDistance, positionZ: -1});
        this.#context.createMediaElementSource(this.#audio).connect(this.#panner).connect(this.#context.destination);
        this.#context.resume();
    }
}
