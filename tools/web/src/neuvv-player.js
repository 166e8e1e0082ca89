// <neuvv-player src="show.nvs" autoplay loop controls>: plays a stream of a performer, who is seen from all sides.
import {FrameQueue} from './frame_queue.js';
import {FrameReader} from './frames.js';
import {lookAt, Renderer} from './renderer.js';

const kMostLate_s = 0.25;      // what is shown may be over for so long before the player waits for its frame
const kAngle = 0.7;            // from the top to the bottom of the image, radians
const kTurn = 0.008;           // radians per pixel of a drag
const kMostTilt = 1.4;         // radians above or below the performer
const kMostStep = 250;         // milliseconds; a page that was hidden goes on where it was
const kMostDensity = 2;        // rays across and down of a pixel of the page
const kStill = 300;            // milliseconds after which a picture that does not change gets more rays

const kStyle = `
:host { display: block; position: relative; aspect-ratio: 1; background: #181818; touch-action: pan-y; }
:host([hidden]) { display: none; }
:host(:fullscreen) { width: 100%; height: 100%; aspect-ratio: auto; }
canvas { width: 100%; height: 100%; display: block; cursor: grab; outline-offset: -2px; }
.bar { position: absolute; inset: auto 0 0 0; display: flex; gap: .5em; align-items: center; padding: .4em; background: #0008; color: #fff; font: 14px sans-serif; }
.bar[hidden], .problem:empty { display: none; }
.bar button { min-width: 2.6em; min-height: 2.2em; background: none; border: 0; color: inherit; cursor: pointer; }
.bar svg { width: 1.2em; fill: currentColor; vertical-align: middle; }
.bar input { flex: 1; min-width: 0; }
.problem { position: absolute; inset: 40% 10% auto; padding: .8em; text-align: center; background: #000c; color: #fff; font: 15px sans-serif; }`;

let walk = null;  // the text of performer.frag, once for all players
function loadedWalk() {
    walk ??= fetch(new URL('performer.frag', import.meta.url)).then(answer => {
        if (!answer.ok) throw new Error(`performer.frag could not be loaded: the server answers ${answer.status}`);
        return answer.text();
    }).catch(error => {
        walk = null;
        throw error;
    });
    return walk;
}

function minutes(seconds) {
    return `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, '0')}`;
}

// The path of a new icon, 16 units across and down.
function addIcon(button) {
    const add = (parent, name) => parent.appendChild(document.createElementNS('http://www.w3.org/2000/svg', name));
    const icon = add(button, 'svg');
    icon.setAttribute('viewBox', '0 0 16 16');
    return add(icon, 'path');
}

export class NeuvvPlayer extends HTMLElement {
    static observedAttributes = ['src', 'controls'];
    #canvas; #bar; #button; #icon; #line; #clock; #problem;
    #renderer = null; #reader = null; #opening = 0; #queue = null; #due = true;
    #time = 0; #paused = true; #rate = 1; #last = null; #seeking = false; #frameRequest = 0; #sizes;
    #hasData = false; #changed = 0; #isWaiting = false; #ended = false;
    error = null;
    #turn = 0; #tilt = 0.1; #zoom = 1;

    constructor() {
        super();
        const root = this.attachShadow({mode: 'open'}), sheet = new CSSStyleSheet();
        sheet.replaceSync(kStyle);  // which a strict policy for content allows
        root.adoptedStyleSheets = [sheet];
        const add = (parent, name, properties = {}) => parent.appendChild(Object.assign(document.createElement(name), properties));
        this.#canvas = add(root, 'canvas', {tabIndex: 0});
        this.#canvas.setAttribute('role', 'application');  // which keys go to
        this.#canvas.setAttribute('aria-label', 'performer; arrow keys turn, space plays');
        this.#problem = add(root, 'div', {className: 'problem'});
        this.#problem.setAttribute('role', 'alert');
        this.#bar = add(root, 'div', {className: 'bar', hidden: true});
        this.#button = add(this.#bar, 'button', {type: 'button', onclick: () => this.#paused ? this.play() : this.pause()});
        this.#icon = addIcon(this.#button);
        this.#line = add(this.#bar, 'input', {type: 'range', min: 0, max: 1, step: 'any', value: 0,
                                              oninput: () => { this.currentTime = Number(this.#line.value); }});
        this.#line.setAttribute('aria-label', 'time, seconds');
        this.#clock = add(this.#bar, 'span');
        const whole = add(this.#bar, 'button', {type: 'button', onclick: () => this.#fillScreen()});
        whole.setAttribute('aria-label', 'full screen');
        addIcon(whole).setAttribute('d', 'M2 6V2h4v1.5H3.5V6zM10 2h4v4h-1.5V3.5H10zM14 10v4h-4v-1.5h2.5V10zM6 14H2v-4h1.5v2.5H6z');
        this.#sizes = new ResizeObserver(() => this.#due = true);
        this.#listen();
        this.#label();
    }

    get src() { return this.getAttribute('src') ?? ''; }
    set src(url) { this.setAttribute('src', url); }
    get paused() { return this.#paused; }
    get ended() { return this.#ended; }
    get duration() { return this.#reader ? this.#reader.frames.length / this.#reader.fps : NaN; }
    get playbackRate() { return this.#rate; }
    set playbackRate(rate) {
        if (!(rate > 0 && rate <= 16)) throw new RangeError('playbackRate must be above 0 and at most 16');
        this.#rate = rate;
        this.dispatchEvent(new Event('ratechange'));
    }
    get currentTime() { return this.#time; }
    set currentTime(seconds) {
        if (!Number.isFinite(seconds)) throw new TypeError('currentTime must be a number of seconds');
        this.#time = Math.max(0, Math.min(seconds, this.#end()));
        this.#seeking = true;
        this.#ended = false;
        this.dispatchEvent(new Event('seeking'));
    }
    /** HTMLMediaElement's: 0 nothing, 1 the head is known, 2 the frame of this time is there, 4 those after it, too. */
    get readyState() {
        if (!this.#reader) return 0;
        const frame = this.#frameOf(this.#time);
        if (!this.#queue.has(frame)) return 1;
        return this.#queue.has(Math.min(frame + 1, this.#reader.frames.length - 1)) ? 4 : 2;
    }
    get loop() { return this.hasAttribute('loop'); }
    set loop(on) { this.toggleAttribute('loop', on); }

    /** Returns a promise, as HTMLMediaElement's does. Frames that could not be read are asked for again. */
    async play() {
        if (!this.#paused) return;
        this.#queue?.tryAgain();
        if (this.#reader) this.#tell(null);
        if (this.#time >= this.#end() && !this.loop) this.#time = 0;
        this.#paused = this.#ended = false;
        this.#isWaiting = true;  // `playing` comes with the first frame
        this.#last = null;
        this.#label();
        this.dispatchEvent(new Event('play'));
    }
    pause() {
        if (this.#paused) return;
        this.#paused = true;
        this.#label();
        this.dispatchEvent(new Event('pause'));
    }
    /** Goes so many frames on, or back, and pauses. */
    step(frames = 1) {
        if (!this.#reader) return;
        this.pause();
        this.currentTime = (this.#frameOf(this.#time) + frames + 0.5) / this.#reader.fps;
    }
    /** Ends all that runs, and frees what it has, as removing it from the page does. A new `src` begins anew. */
    dispose() {
        cancelAnimationFrame(this.#frameRequest);
        this.#close();
        this.#renderer?.end();
        this.#renderer = null;
        this.#sizes.disconnect();
    }

    connectedCallback() {
        if (!this.#reader) this.#open();
    }
    disconnectedCallback() {
        setTimeout(() => {  // it may only be moved
            if (!this.isConnected) this.dispose();
        });
    }
    attributeChangedCallback(name) {
        if (name === 'controls') this.#bar.hidden = !this.hasAttribute('controls');
        if (name === 'src' && this.isConnected) this.#open();
    }

    async #open() {
        this.#close();
        const opening = this.#opening;
        if (!this.src) return;
        try {
            const text = await loadedWalk();
            if (opening !== this.#opening) return;
            this.#renderer ??= new Renderer(this.#canvas, text);
            this.#sizes.observe(this.#canvas);
            this.#schedule();
            const reader = await FrameReader.open(new URL(this.src, document.baseURI));
            if (opening !== this.#opening) return reader.end();
            this.#reader = reader;
            this.#queue = new FrameQueue(reader);
            this.#line.max = this.duration;
            this.#showClock();
            this.dispatchEvent(new Event('durationchange'));
            this.dispatchEvent(new Event('loadedmetadata'));
            if (this.hasAttribute('autoplay')) this.play();
        } catch (error) {
            if (opening === this.#opening) this.#fail(error);
        }
    }
    #close() {
        ++this.#opening;  // what is being opened is dropped when it is there
        this.#reader?.end();
        this.#queue?.clear();
        this.#reader = this.#queue = null;
        this.#time = 0;
        this.#hasData = this.#seeking = this.#isWaiting = this.#ended = false;
        this.#tell(null);
    }
    #tell(error) {
        this.error = error;
        this.#problem.textContent = error ? `${this.src}: ${error.message}` : '';
    }
    #fail(error) {
        this.pause();
        this.#tell(error);
        this.dispatchEvent(new ErrorEvent('error', {error, message: error.message}));
    }

    #frameOf(seconds) { return Math.min(Math.floor(seconds * this.#reader.fps), this.#reader.frames.length - 1); }
    // The last time at which the last frame is shown.
    #end() { return this.#reader ? (this.#reader.frames.length - 0.001) / this.#reader.fps : 0; }

    #schedule() {
        cancelAnimationFrame(this.#frameRequest);
        this.#frameRequest = requestAnimationFrame(now => {
            this.#schedule();
            try {
                this.#tick(now);
            } catch (error) {
                cancelAnimationFrame(this.#frameRequest);
                this.#fail(error);
            }
        });
    }
    #tick(now) {
        if (!this.#renderer) return;
        if (this.#reader) {
            this.#advance(now);
            this.#request();
            this.#takeFrame();
        }
        if (this.#due) this.#changed = now;
        if (this.#resize(now) || this.#due) {
            this.#due = false;
            this.#renderer.draw(this.#rays());
        }
    }
    // Moves the clock on, but not while its frame is missing.
    #advance(now) {
        const passed = Math.min(now - (this.#last ?? now), kMostStep);
        this.#last = now;
        if (this.#paused) return;
        if (this.#isWaiting !== this.#isLate()) {
            this.#isWaiting = !this.#isWaiting;
            this.dispatchEvent(new Event(this.#isWaiting ? 'waiting' : 'playing'));
        }
        if (this.#isWaiting) return;
        this.#time += passed / 1000 * this.#rate;
        if (this.#time < this.#end()) return;
        if (this.loop) {
            this.#time %= this.duration;
        } else {
            this.#time = this.#end();
            this.#ended = true;
            this.pause();
            this.dispatchEvent(new Event('ended'));
        }
    }
    // A frame that comes late is left out. Where none comes, the player waits for that of its time.
    #isLate() {
        if (this.readyState >= (this.#isWaiting ? 4 : 2)) return false;
        const shown_s = (this.#queue.shown + 1) / this.#reader.fps;  // what is shown is over then
        const late_s = this.#time >= shown_s ? this.#time - shown_s : this.#time + this.duration - shown_s;
        return this.#isWaiting || this.#seeking || this.#queue.shown < 0 || late_s > kMostLate_s * this.#rate;
    }
    // Asks for the frame of this time and those after it, and forgets all others.
    #request() {
        const plays = !this.#paused && !this.#isWaiting, waits = !this.#paused && this.#isWaiting;
        this.#queue.follow(this.#frameOf(this.#time), {plays, waits, seeks: this.#seeking, rate: this.#rate, loops: this.loop});
    }
    #takeFrame() {
        const frame = this.#frameOf(this.#time), come = this.#queue.take();
        if (come?.error && come.error !== this.error) this.#fail(come.error);  // once, until play() tries again
        if (come?.tree) {
            const begin = performance.now();
            this.#renderer.show(come.tree);
            this.#reader.learnShown(come.tree, (performance.now() - begin) / 1000);
            this.#due = true;
            if (!this.#hasData) {
                this.#hasData = true;
                this.dispatchEvent(new Event('loadeddata'));
                this.dispatchEvent(new Event('canplay'));
            }
        }
        if (this.#seeking && frame === this.#queue.shown) {
            this.#seeking = false;
            this.dispatchEvent(new Event('seeked'));
        }
        if (this.#line.value !== String(this.#time)) {
            this.#showClock();
            this.dispatchEvent(new Event('timeupdate'));
        }
    }
    #showClock() {
        this.#line.value = this.#time;
        this.#clock.textContent = `${minutes(this.#time)} / ${minutes(this.duration)}`;
    }
    // A ray for each pixel of the screen, and where nothing moves, four.
    #resize(now) {
        const isStill = this.#paused && now - this.#changed > kStill, canvas = this.#canvas;
        const density = isStill ? kMostDensity : Math.min(devicePixelRatio, kMostDensity);
        const width = Math.max(1, Math.round(canvas.clientWidth * density)), height = Math.max(1, Math.round(canvas.clientHeight * density));
        if (canvas.width === width && canvas.height === height) return false;
        canvas.width = width;
        canvas.height = height;
        return true;
    }
    // A camera that sees all that is shown, from around its middle.
    #rays() {
        const {min, max} = this.#reader?.box ?? {min: [0, 0, 0], max: [1, 1, 1]}, canvas = this.#canvas;
        const target = min.map((low, axis) => (low + max[axis]) / 2);
        const radius = Math.hypot(...max.map((high, axis) => high - min[axis])) / 2;
        const distance = this.#zoom * Math.max(1, canvas.height / canvas.width) * radius / Math.tan(kAngle / 2);
        const across = Math.cos(this.#tilt) * distance;
        const eye = [target[0] + Math.sin(this.#turn) * across, target[1] + Math.sin(this.#tilt) * distance,
                     target[2] + Math.cos(this.#turn) * across];
        return lookAt(eye, target, kAngle, canvas.width, canvas.height);
    }

    #orbit(turn, tilt, zoom = 1) {
        this.#turn += turn;
        this.#tilt = Math.max(-kMostTilt, Math.min(this.#tilt + tilt, kMostTilt));
        this.#zoom = Math.max(0.1, Math.min(this.#zoom * zoom, 10));
        this.#due = true;
    }
    #listen() {
        const canvas = this.#canvas, pointers = new Map();
        const apart = () => {
            const [a, b] = [...pointers.values()];
            return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
        };
        canvas.addEventListener('pointerdown', event => {
            canvas.setPointerCapture(event.pointerId);
            pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
        });
        canvas.addEventListener('pointermove', event => {
            const from = pointers.get(event.pointerId), before = apart();
            if (!from) return;
            const [dx, dy] = [event.clientX - from.x, event.clientY - from.y];
            Object.assign(from, {x: event.clientX, y: event.clientY});
            if (pointers.size === 1) this.#orbit(-dx * kTurn, dy * kTurn);
            else if (before > 0 && apart() > 0) this.#orbit(0, 0, before / apart());
        });
        for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => pointers.delete(event.pointerId));
        canvas.addEventListener('wheel', event => {  // else the page scrolls
            if (this.shadowRoot.activeElement !== canvas && !event.ctrlKey) return;
            event.preventDefault();
            this.#orbit(0, 0, Math.exp(0.001 * event.deltaY));
        }, {passive: false});
        const keys = {ArrowLeft: () => this.#orbit(-0.1, 0), ArrowRight: () => this.#orbit(0.1, 0), ArrowUp: () => this.#orbit(0, 0.1),
                      ArrowDown: () => this.#orbit(0, -0.1), '+': () => this.#orbit(0, 0, 0.9), '-': () => this.#orbit(0, 0, 1.1),
                      ' ': () => this.#paused ? this.play() : this.pause(), f: () => this.#fillScreen(), ',': () => this.step(-1), '.': () => this.step(1)};
        canvas.addEventListener('webglcontextlost', event => event.preventDefault());  // so that it comes again
        canvas.addEventListener('webglcontextrestored', () => {
            this.#renderer?.restore();
            this.#queue?.clear();
        });
        canvas.addEventListener('keydown', event => {
            if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
            event.preventDefault();
            keys[event.key]();
        });
    }
    #fillScreen() {
        const change = document.fullscreenElement === this ? document.exitFullscreen() : this.requestFullscreen?.();
        change?.catch(() => {});  // the browser does not want to, and says so itself
    }
    #label() {
        this.#icon.setAttribute('d', this.#paused ? 'M3 2v12l10-6z' : 'M3 2h4v12H3zM9 2h4v12H9z');
        this.#button.setAttribute('aria-label', this.#paused ? 'play' : 'pause');
    }
}

customElements.define('neuvv-player', NeuvvPlayer);
