// <neuvv-player src="show.nvs" autoplay loop controls>: plays a stream of a performer, who is seen from all sides.
import {Controls, kControlsStyle} from './controls.js';
import {loadedWalk} from './loaded.js';
import {Orbit} from './orbit.js';
import {leavesOf, playing} from './playing.js';
import {Renderer} from './renderer.js';
import {Immersion} from './xr.js';

const kMostDensity = 2;        // rays across and down of a pixel of the page
const kStill = 300;            // milliseconds after which an image that does not change gets more rays
const kStepTurn = 0.1;         // radians, of an arrow key
const kProperties = ['src', 'budget', 'poster', 'loop', 'autoplay', 'controls', 'muted', 'volume', 'playbackRate', 'currentTime'];

const kStyle = `
:host { display: block; position: relative; aspect-ratio: 1; background: #181818; touch-action: pan-y; }
:host([hidden]) { display: none; }
:host(:fullscreen) { width: 100%; height: 100%; aspect-ratio: auto; touch-action: none; }
canvas, .poster { width: 100%; height: 100%; display: block; }
canvas { cursor: grab; outline-offset: -2px; }
.poster { position: absolute; inset: 0; object-fit: contain; pointer-events: none; }
.poster[hidden], .problem:empty { display: none; }
.problem { position: absolute; inset: 45% 10% auto; translate: 0 -50%; padding: .8em; text-align: center; overflow-wrap: anywhere; background: #000c; color: #fff; font: 15px sans-serif; }`;

export class NeuvvPlayer extends playing(HTMLElement) {
    static observedAttributes = ['src', 'sound', 'budget', 'controls', 'poster', 'muted'];
    #canvas; #poster; #problem; #controls; #sizes; #orbit;
    #renderer = null; #opening = 0; #immersion = null; #entering = null; #frameRequest = 0; #due = true; #changed = 0;

    constructor() {
        super();
        const root = this.attachShadow({mode: 'open'}), sheet = new CSSStyleSheet();
        sheet.replaceSync(kStyle + kControlsStyle);  // which a strict policy for content allows
        root.adoptedStyleSheets = [sheet];
        const add = (name, properties) => root.appendChild(Object.assign(document.createElement(name), properties));
        this.#canvas = add('canvas', {tabIndex: 0});
        this.#canvas.setAttribute('role', 'application');  // which keys go to
        this.#canvas.setAttribute('aria-label', 'performer; arrow keys turn, space plays');
        this.#poster = add('img', {className: 'poster', hidden: true, alt: ''});
        this.#problem = add('div', {className: 'problem'});
        this.#problem.setAttribute('role', 'alert');
        this.#controls = new Controls(this, root, () => this.#fillScreen(), text => this.#problem.textContent = text);
        this.#sizes = new ResizeObserver(() => this.#due = true);
        this.#orbit = new Orbit(() => this.#due = true);
        this.#listen();
    }

    get src() { return this.getAttribute('src') ?? ''; }
    set src(url) { this.setAttribute('src', url); }
    /** How many leaves shall be shown at most; 0: no limit, also where the attribute is no number, which open() says. */
    get budget() { return leavesOf(this.getAttribute('budget')) ?? 0; }
    set budget(leaves) { leaves === 0 || leaves === null ? this.removeAttribute('budget') : this.setAttribute('budget', leaves); }
    get poster() { return this.getAttribute('poster') ?? ''; }
    set poster(url) { this.setAttribute('poster', url); }
    get loop() { return this.hasAttribute('loop'); }
    set loop(on) { this.toggleAttribute('loop', on); }
    get autoplay() { return this.hasAttribute('autoplay'); }
    set autoplay(on) { this.toggleAttribute('autoplay', on); }
    get controls() { return this.hasAttribute('controls'); }
    set controls(on) { this.toggleAttribute('controls', on); }

    /**
     * Shows the performer in a headset; `mode`: 'immersive-vr' or 'immersive-ar'. A browser allows it only while it handles a
     * click or a key. The promise rejects where there is no headset, or while nothing is shown.
     */
    enterXR(mode = 'immersive-vr') {
        this.#entering ??= this.#enter(mode).catch(error => {
            this.#entering = null;
            throw error;
        });
        return this.#entering;
    }
    async #enter(mode) {
        if (!['immersive-vr', 'immersive-ar'].includes(mode)) throw new TypeError(`${mode} is neither immersive-vr nor immersive-ar`);
        if (!navigator.xr) throw new Error('this browser has no WebXR; headsets need a page that comes by https');
        if (!this.#renderer || !this.box) throw new Error('there is nothing to be shown yet');
        const immersion = new Immersion(this.#renderer, this);
        this.#immersion = immersion;
        try {
            await immersion.begin(mode, time => this.#take(time));
            cancelAnimationFrame(this.#frameRequest);
            this.dispatchEvent(new Event('enterxr'));
            immersion.ended.then(() => {
                this.#immersion = this.#entering = null;
                if (!this.#canvas.parentNode) this.shadowRoot.prepend(this.#canvas);  // simulated headsets take it away
                this.dispatchEvent(new Event('leavexr'));
                if (this.#renderer) this.#schedule();
                this.#due = true;
            });
        } catch (error) {
            this.#immersion = null;
            throw error;
        }
    }
    /** Ends all that runs, and frees what it has, as removing it from the page does. A new `src` begins anew. */
    dispose() {
        cancelAnimationFrame(this.#frameRequest);
        ++this.#opening;
        this.#immersion?.leave();
        this.end();
        this.#renderer?.end();
        this.#renderer = null;
        this.#sizes.disconnect();
    }

    connectedCallback() {
        for (const name of kProperties) {  // that were set before this class was known
            if (!Object.hasOwn(this, name)) continue;
            const value = this[name];
            delete this[name];
            this[name] = value;
        }
        if (this.readyState === 0) this.#begin();
    }
    disconnectedCallback() {
        setTimeout(() => {  // it may only be moved
            if (!this.isConnected) this.dispose();
        });
    }
    attributeChangedCallback(name, _, value) {
        if (name === 'controls') this.#controls.hidden = !this.controls;
        this.#due = true;
        if (name === 'muted') this.muted = value !== null;
        if (name === 'poster') Object.assign(this.#poster, {src: this.poster, hidden: !this.poster || this.readyState >= 2});
        if ((name === 'src' || name === 'sound') && this.isConnected) this.#begin();
        if (name === 'budget' && this.#renderer) this.#goOnAnew();
    }
    // Where it is, with what can only be chosen when a stream is opened.
    #goOnAnew() {
        const {currentTime, paused} = this;
        this.#begin(false);
        this.currentTime = currentTime;
        if (!paused) this.play().catch(() => {});  // the event `error` says it
    }

    async #begin(plays = this.autoplay) {
        const opening = ++this.#opening;
        this.close();
        if (!this.src) return;
        try {
            const walk = await loadedWalk();
            if (opening !== this.#opening) return;
            this.#renderer ??= new Renderer(this.#canvas, walk);
            this.#sizes.observe(this.#canvas);
            if (!this.#immersion) this.#schedule();
            await this.open(new URL(this.src, document.baseURI), this.#soundUrl(), this.getAttribute('budget') ?? 0);
            if (opening === this.#opening && this.readyState > 0 && plays) this.play().catch(() => {});  // the event `error` says it
        } catch (error) {
            if (opening === this.#opening) this.fail(error);
        }
    }
    // The address of the attribute `sound`; without one that of the .m4a beside the stream, as `neuvv publish` leaves it.
    #soundUrl() {
        const sound = this.getAttribute('sound');
        if (sound !== null) return sound ? new URL(sound, document.baseURI) : null;
        const url = new URL(this.src, document.baseURI);
        url.pathname = url.pathname.replace(/\.nvs$/, '.m4a');
        return url.pathname.endsWith('.m4a') ? url : null;
    }

    #schedule() {
        cancelAnimationFrame(this.#frameRequest);
        this.#frameRequest = requestAnimationFrame(now => {
            this.#schedule();
            try {
                this.#tick(now);
            } catch (error) {
                cancelAnimationFrame(this.#frameRequest);
                this.fail(error);
            }
        });
    }
    #tick(now) {
        this.#take(now);
        this.#controls.showHeld();
        if (!this.#renderer) return;  // an event's listener has ended the player
        if (this.#due) this.#changed = now;
        if (!this.#resize(now) && !this.#due) return;
        this.#due = false;
        const canvas = this.#canvas, box = this.box ?? {min: [0, 0, 0], max: [1, 1, 1]};
        // The bar covers no feet.
        const low = Math.round(this.#controls.height * canvas.height / Math.max(canvas.clientHeight, 1)), height = Math.max(1, canvas.height - low);
        const {eye, clipFromTree, middle} = this.#orbit.camera(box, canvas.width / height);
        const gl = this.#renderer.gl;
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.viewport(0, low, canvas.width, height);
        this.#renderer.clear();
        this.#renderer.draw(eye, clipFromTree);
        this.hearFrom(middle);
    }
    // Shows the frame of this time, where it is another one.
    #take(now) {
        const tree = this.tick(now);
        if (!tree || !this.#renderer) return;
        this.#renderer.show(tree);
        this.#poster.hidden = true;
        this.#due = true;
    }
    // A ray for each pixel of the screen, and where nothing moves, four.
    #resize(now) {
        const isStill = this.paused && now - this.#changed > kStill, canvas = this.#canvas;
        const density = isStill ? kMostDensity : Math.min(devicePixelRatio, kMostDensity);
        const width = Math.max(1, Math.round(canvas.clientWidth * density)), height = Math.max(1, Math.round(canvas.clientHeight * density));
        if (canvas.width === width && canvas.height === height) return false;
        canvas.width = width;
        canvas.height = height;
        return true;
    }

    #listen() {
        const canvas = this.#canvas, orbit = this.#orbit;
        orbit.listen(canvas, () => this.shadowRoot.activeElement === canvas);
        const keys = {ArrowLeft: () => orbit.turn(-kStepTurn, 0), ArrowRight: () => orbit.turn(kStepTurn, 0), ArrowUp: () => orbit.turn(0, kStepTurn),
                      ArrowDown: () => orbit.turn(0, -kStepTurn), '+': () => orbit.turn(0, 0, 0.9), '-': () => orbit.turn(0, 0, 1.1), Home: () => orbit.reset(),
                      ' ': () => this.paused ? this.play().catch(() => {}) : this.pause(), f: () => this.#fillScreen(), m: () => this.muted = !this.muted,
                      ',': () => this.step(-1), '.': () => this.step(1)};
        canvas.addEventListener('keydown', event => {
            if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
            event.preventDefault();
            keys[event.key]();
        });
        canvas.addEventListener('webglcontextlost', event => event.preventDefault());  // so that it comes again
        canvas.addEventListener('webglcontextrestored', () => {
            this.#renderer?.restore();
            this.forgetShown();
        });
        for (const name of ['error', 'emptied', 'play'])
            this.addEventListener(name, () => this.#problem.textContent = this.error ? `${this.src}: ${this.error.message}` : '');
        this.addEventListener('play', () => {  // which an error of drawing has ended
            if (this.#renderer && !this.#immersion) this.#schedule();
        });
        this.addEventListener('emptied', () => {
            this.#poster.hidden = !this.poster;
            this.#renderer?.hide();
            this.#due = true;
        });
    }
    #fillScreen() {
        const change = document.fullscreenElement === this ? document.exitFullscreen() : this.requestFullscreen?.();
        change?.catch(() => {});  // the browser does not want to, and says so itself
    }
}

customElements.define('neuvv-player', NeuvvPlayer);
