// The bar of a player: play, time line with what is buffered, sound, headset, full screen.

const kIcons = {play: 'M3 2v12l10-6z', pause: 'M3 2h4v12H3zM9 2h4v12H9z', whole: 'M2 6V2h4v1.5H3.5V6zM10 2h4v4h-1.5V3.5H10zM14 10v4h-4v-1.5h2.5V10zM6 14H2v-4h1.5v2.5H6z',
                loud: 'M2 6h3l4-4v12l-4-4H2zM11 4a5 5 0 0 1 0 8V10a3 3 0 0 0 0-4z', silent: 'M2 6h3l4-4v12l-4-4H2zM11 6l1-1 4 5-1 1zM15 5l1 1-4 5-1-1z',
                headset: 'M1 4h14v8h-5l-2-3-2 3H1zM3 6v2h3V6zM10 6v2h3V6z'};

const kShort_s = 10;
const kPause = 250;  // milliseconds until what has been fetched is shown anew

export const kControlsStyle = `
.bar { position: absolute; inset: auto 0 0 0; display: flex; gap: .5em; align-items: center; padding: .4em; background: #0008; color: #fff;
       font: 14px sans-serif; container-type: inline-size; }
.bar[hidden], .bar button[hidden], .bar .volume[hidden] { display: none; }
.bar button { min-width: 2.6em; min-height: 2.2em; background: none; border: 0; color: inherit; cursor: pointer; }
.bar svg { width: 1.2em; fill: currentColor; vertical-align: middle; }
.bar .line { flex: 1; min-width: 0; position: relative; height: 2.2em; }
.bar .track { position: absolute; inset: calc(50% - 3px) 7px; overflow: hidden; border-radius: 3px; background: #fff3; }
.bar .track * { position: absolute; height: 100%; }
.bar .track .held { width: 100%; }
.bar .track span { background: #fff6; }
.bar .track .played { background: #fff; }
.bar .line input { position: absolute; width: 100%; height: 100%; margin: 0; appearance: none; background: none; cursor: pointer; }
.bar .line input::-webkit-slider-thumb { appearance: none; width: 14px; height: 14px; border-radius: 7px; background: #fff; }
.bar .clock { white-space: nowrap; }
.bar .volume { width: 5em; min-width: 0; }
@container (max-width: 30em) { .bar .volume { display: none; } }
@container (max-width: 22em) { .bar .clock { display: none; } }`;

// Of a stream of so many seconds; tenths where it is short.
function minutes(seconds, duration) {
    const isShort = duration < kShort_s, text = isShort ? (Math.floor(10 * seconds) / 10).toFixed(1) : String(Math.floor(seconds % 60));
    return `${Math.floor(seconds / 60)}:${text.padStart(isShort ? 4 : 2, '0')}`;
}

export class Controls {
    #player; #bar; #play; #line; #held; #played; #clock; #mute; #volume; #told = ''; #shownAt = 0;

    /** Adds itself to a parent. `fillScreen`: is called by its button. `say`: shows a line, or none where it is empty. */
    constructor(player, parent, fillScreen, say) {
        this.#player = player;
        const add = (to, name, properties = {}) => to.appendChild(Object.assign(document.createElement(name), properties));
        this.#bar = add(parent, 'div', {className: 'bar', hidden: true});
        this.#play = this.#button(() => player.paused ? player.play().catch(() => {}) : player.pause());
        const line = add(this.#bar, 'div', {className: 'line'}), track = add(line, 'div', {className: 'track'});
        this.#held = add(track, 'div', {className: 'held'});
        this.#played = add(track, 'div', {className: 'played'});
        this.#line = add(line, 'input', {type: 'range', min: 0, max: 1, step: 'any', value: 0,
                                         oninput: () => { player.currentTime = Number(this.#line.value); }});
        this.#line.setAttribute('aria-label', 'time');
        this.#clock = add(this.#bar, 'span', {className: 'clock'});
        this.#mute = this.#button(() => player.muted = !player.muted);
        this.#volume = add(this.#bar, 'input', {type: 'range', className: 'volume', min: 0, max: 1, step: 0.05,
                                                oninput: () => { player.volume = Number(this.#volume.value); }});
        this.#volume.setAttribute('aria-label', 'volume');
        const headset = this.#button(() => player.enterXR().catch(error => say(error.name === 'NotAllowedError' ? '' : error.message)), 'headset', 'enter the headset');
        headset.hidden = true;
        navigator.xr?.isSessionSupported('immersive-vr').then(is => headset.hidden = !is, () => {});
        this.#button(fillScreen, 'whole', 'full screen');
        for (const name of ['play', 'pause', 'volumechange', 'timeupdate', 'loadedmetadata', 'emptied']) player.addEventListener(name, () => this.#show());
        this.#show();
    }
    set hidden(on) { this.#bar.hidden = on; }
    /** Of the bar, pixels of the page. */
    get height() { return this.#bar.offsetHeight; }
    /** Shows which parts of the time have been fetched. */
    showHeld() {
        const now = performance.now();
        if (this.#bar.hidden || now - this.#shownAt < kPause) return;
        this.#shownAt = now;
        const {buffered, duration} = this.#player, parts = Array.from({length: buffered.length}, (_, i) => [buffered.start(i), buffered.end(i)]);
        const told = `${parts} of ${duration}`;
        if (told === this.#told) return;
        this.#told = told;
        this.#held.replaceChildren(...parts.map(([begin, end]) => {
            const part = document.createElement('span');
            part.style.left = `${100 * begin / duration}%`;
            part.style.width = `${100 * (end - begin) / duration}%`;
            return part;
        }));
    }

    #button(onclick, icon, label) {
        const button = this.#bar.appendChild(Object.assign(document.createElement('button'), {type: 'button', onclick}));
        const add = (parent, name) => parent.appendChild(document.createElementNS('http://www.w3.org/2000/svg', name));
        const drawing = add(button, 'svg');
        drawing.setAttribute('viewBox', '0 0 16 16');
        add(drawing, 'path');
        if (icon) this.#label(button, icon, label);
        return button;
    }
    #label(button, icon, label) {
        if (button.getAttribute('aria-label') === label) return;
        button.setAttribute('aria-label', label);
        button.querySelector('path').setAttribute('d', kIcons[icon]);
    }
    #show() {
        const player = this.#player, isSilent = player.muted || player.volume === 0;
        this.#label(this.#play, player.paused ? 'play' : 'pause', player.paused ? 'play' : 'pause');
        this.#label(this.#mute, isSilent ? 'silent' : 'loud', isSilent ? 'unmute' : 'mute');
        this.#mute.hidden = this.#volume.hidden = !player.hasSound;
        this.#volume.value = player.volume;
        this.#line.max = player.duration || 1;
        this.#line.value = player.currentTime;
        this.#played.style.width = `${100 * player.currentTime / (player.duration || 1)}%`;
        const clock = player.readyState > 0 ? `${minutes(player.currentTime, player.duration)} / ${minutes(player.duration, player.duration)}` : '';
        this.#line.setAttribute('aria-valuetext', clock);
        if (this.#clock.textContent !== clock) this.#clock.textContent = clock;
    }
}
