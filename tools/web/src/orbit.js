// A camera that goes around a box, by pointers, wheel and keys.
import {lookAt, multiply, perspective, transformed} from './matrices.js';

const kAngle = 0.7;            // from the top to the bottom of the image, radians
const kTurn = 0.008;           // radians per pixel of a drag
const kMostTilt = 1.4;         // radians above or below the middle
const kNear = 0.01;            // metres

export class Orbit {
    #turn = 0; #tilt = 0.1; #zoom = 1; #shift = [0, 0]; #changed;
    /** `changed`: is called when the camera has moved. */
    constructor(changed) { this.#changed = changed; }

    /** Of an image so much wider than high that shows the box {min, max}, metres: {eye, clipFromTree}, as Renderer has them, and the middle as it sees it. */
    camera({min, max}, aspect) {
        const middle = min.map((low, axis) => (low + max[axis]) / 2), radius = Math.hypot(...max.map((high, axis) => high - min[axis])) / 2;
        const distance = this.#zoom * Math.max(1, 1 / aspect) * radius / Math.tan(kAngle / 2), across = Math.cos(this.#tilt);
        const [c, s] = [Math.cos(this.#turn), Math.sin(this.#turn)], up = [-s * Math.sin(this.#tilt), across, -c * Math.sin(this.#tilt)];
        const [x, y] = this.#shift.map(part => part * radius), target = [middle[0] + c * x + up[0] * y, middle[1] + up[1] * y, middle[2] - s * x + up[2] * y];
        const eye = [s * across, Math.sin(this.#tilt), c * across].map((part, axis) => target[axis] + distance * part);
        const view = lookAt(eye, target);
        return {eye: [...eye, 1], clipFromTree: multiply(perspective(kAngle, aspect, kNear), view), middle: transformed(view, middle).slice(0, 3)};
    }
    /** Radians to the right and up, and how many times as far away. */
    turn(right, up, zoom = 1) {
        this.#turn += right;
        this.#tilt = Math.max(-kMostTilt, Math.min(this.#tilt + up, kMostTilt));
        this.#zoom = Math.max(0.1, Math.min(this.#zoom * zoom, 10));
        this.#changed();
    }
    /** In halves of the box's diagonal. */
    shift(right, up) {
        this.#shift = [this.#shift[0] + right, this.#shift[1] + up].map(part => Math.max(-1, Math.min(part, 1)));
        this.#changed();
    }
    reset() {
        [this.#turn, this.#tilt, this.#zoom, this.#shift] = [0, 0.1, 1, [0, 0]];
        this.#changed();
    }
    /** Listens to pointers and the wheel on an element: a drag turns; two fingers, or a drag with Shift or the right button, shift. */
    listen(element, hasFocus) {
        const pointers = new Map();
        const both = () => {
            const [a, b] = [...pointers.values()];
            return b ? {apart: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2} : null;
        };
        const shiftBy = (dx, dy) => this.shift(-2 * this.#zoom * dx / element.clientHeight, 2 * this.#zoom * dy / element.clientHeight);
        element.addEventListener('pointerdown', event => {
            element.setPointerCapture(event.pointerId);
            pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
        });
        element.addEventListener('pointermove', event => {
            const from = pointers.get(event.pointerId), before = both();
            if (!from) return;
            const [dx, dy] = [event.clientX - from.x, event.clientY - from.y];
            Object.assign(from, {x: event.clientX, y: event.clientY});
            const after = both();
            if (after) {
                if (before.apart > 0 && after.apart > 0) this.turn(0, 0, before.apart / after.apart);
                shiftBy(after.x - before.x, after.y - before.y);
            } else if (event.shiftKey || event.buttons & 2) {
                shiftBy(dx, dy);
            } else {
                this.turn(-dx * kTurn, dy * kTurn);
            }
        });
        for (const end of ['pointerup', 'pointercancel']) element.addEventListener(end, event => pointers.delete(event.pointerId));
        element.addEventListener('contextmenu', event => event.preventDefault());
        element.addEventListener('wheel', event => {  // else the page scrolls
            if (!hasFocus() && !event.ctrlKey) return;
            event.preventDefault();
            this.turn(0, 0, Math.exp(0.001 * event.deltaY));
        }, {passive: false});
    }
}
