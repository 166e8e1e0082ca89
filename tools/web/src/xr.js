// A performer in a headset, by WebXR: stands on the floor before who wears it; hands and controllers point at it, move,
// turn and scale it, and play.
import {Lines} from './lines.js';
import {inverse, multiply, placement, transformed} from './matrices.js';

const kAhead = 2;                       // metres from who wears the headset to the performer
const kNear = 0.05, kFar = 100;         // metres
const kTap_ms = 1000, kTap_m = 0.03;    // a press that is shorter, of a hand that moves less, plays or pauses
const kReach = 10;                      // metres of a pointer that hits nothing
const kLeastScale = 0.1, kMostScale = 10;  // of the performer
const kLeastRays = 0.4, kFewerRays = 0.9, kMoreRays = 1.02;  // across an eye: the least share; by which it changes
const kLate = 1.3, kSmoothed = 0.05;    // an image that takes so many times as long as planned is late; the share of a new image in the mean
const kRoom = [0.008, 0.009, 0.012, 1];  // linear, of what is around
const kPointer = [0.25, 0.3, 0.35, 1], kPointerAtPerformer = [0.2, 0.7, 1, 1], kGrid = [0.22, 0.24, 0.28, 1];

const add = (a, b) => a.map((value, i) => value + b[i]);
const subtract = (a, b) => a.map((value, i) => value - b[i]);
const xyz = point => [point.x, point.y, point.z];
// Which way a pose points, about +y, radians.
const yawOf = ([x, , z]) => Math.atan2(-x, -z);

// How far along a ray it comes into the box {min, max}; Infinity where it misses it.
function distanceTo({min, max}, from, along) {
    let [near, far] = [0, Infinity];
    for (let axis = 0; axis < 3; ++axis) {
        const ends = [min[axis], max[axis]].map(end => (end - from[axis]) / (along[axis] || 1e-20));
        near = Math.max(near, Math.min(...ends));
        far = Math.min(far, Math.max(...ends));
    }
    return near <= far ? near : Infinity;
}

// The squares of a floor, 10 × 10 of 1 m.
function floorLines() {
    const ends = [];
    for (let i = -5; i <= 5; ++i)
        for (let j = -5; j < 5; ++j) ends.push(i, 0, j, i, 0, j + 1, j, 0, i, j + 1, 0, i);
    return ends;
}

export class Immersion {
    #renderer; #player; #take; #session = null; #space = null; #lines = null; #isRoom = true;
    #turn = 0; #scale = 1; #at = [0, 0, -kAhead]; #grabs = new Map(); #rays = 1; #last = null; #late = 1; #isOver = false;
    /** Resolves when the headset is left. */
    ended;

    constructor(renderer, player) {
        this.#renderer = renderer;
        this.#player = player;
    }
    /** `take`: is called with the time of each image, milliseconds, before it is drawn. Rejects where there is no such headset. */
    async begin(mode, take) {
        const session = await navigator.xr.requestSession(mode, {requiredFeatures: ['local-floor'], optionalFeatures: ['hand-tracking']});
        const expectToGoOn = () => {
            if (this.#isOver) throw new Error('the player was left before its headset was entered');
        };
        this.#session = session;
        this.#take = take;
        this.ended = new Promise(resolve => session.addEventListener('end', () => {
            this.#lines?.end();
            resolve();
        }));
        try {
            const gl = this.#renderer.gl;
            expectToGoOn();
            await gl.makeXRCompatible();
            expectToGoOn();
            const layer = new XRWebGLLayer(session, gl, {antialias: false});
            if (layer.fixedFoveation !== undefined && layer.fixedFoveation !== null) layer.fixedFoveation = 1;
            session.updateRenderState({baseLayer: layer, depthNear: kNear, depthFar: kFar});
            this.#space = await session.requestReferenceSpace('local-floor');
            expectToGoOn();
            this.#lines = new Lines(gl);
            this.#isRoom = mode === 'immersive-vr';
        } catch (error) {
            session.end().catch(() => {});
            throw error;
        }
        for (const name of ['select', 'squeeze']) {
            session.addEventListener(`${name}start`, event => this.#grab(event, name));
            session.addEventListener(`${name}end`, event => this.#letGo(event));
        }
        const draw = (now, frame) => {
            session.requestAnimationFrame(draw);
            try {
                this.#draw(now, frame);
            } catch (error) {
                this.leave();
                this.#player.fail(error);
            }
        };
        session.requestAnimationFrame(draw);
    }
    leave() {
        this.#isOver = true;
        this.#session?.end().catch(() => {});
    }

    // From the stream's coordinates to the room: the middle of the box's floor stands at #at.
    #worldFromTree() {
        const {min, max} = this.#player.box, foot = [(min[0] + max[0]) / 2, min[1], (min[2] + max[2]) / 2];
        const turned = transformed(placement(this.#turn, this.#scale, [0, 0, 0]), foot).slice(0, 3);
        return placement(this.#turn, this.#scale, subtract(this.#at, turned));
    }
    #draw(now, frame) {
        const pose = frame.getViewerPose(this.#space), layer = this.#session.renderState.baseLayer;
        this.#take(now);
        this.#follow(frame);
        if (!pose || !this.#player.box) return;
        this.#chooseRays(now);
        const gl = this.#renderer.gl, worldFromTree = this.#worldFromTree(), treeFromWorld = inverse(worldFromTree);
        const {min, max} = this.#player.box, middle = transformed(worldFromTree, min.map((low, i) => (low + max[i]) / 2));
        this.#player.hearFrom(transformed(pose.transform.inverse.matrix, middle).slice(0, 3));
        const pointers = this.#pointers(frame, treeFromWorld);
        gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
        this.#renderer.clear(this.#isRoom ? kRoom : undefined);
        for (const view of pose.views) {
            view.requestViewportScale?.(this.#rays);
            const {x, y, width, height} = layer.getViewport(view);
            const clipFromWorld = multiply(view.projectionMatrix, view.transform.inverse.matrix);
            gl.viewport(x, y, width, height);
            if (this.#isRoom) this.#lines.draw(floorLines(), clipFromWorld, kGrid);
            for (const {ends, hits} of pointers) this.#lines.draw(ends, clipFromWorld, hits ? kPointerAtPerformer : kPointer);
            const eye = transformed(treeFromWorld, xyz(view.transform.position)).slice(0, 3);
            this.#renderer.draw([...eye, 1], multiply(clipFromWorld, worldFromTree));
        }
    }
    // Fewer rays across where images come late, more where they come in time.
    #chooseRays(now) {
        const planned = 1000 / (this.#session.frameRate ?? 72), passed = now - (this.#last ?? now - planned);
        this.#last = now;
        this.#late += kSmoothed * (passed / planned - this.#late);
        if (this.#late > kLate) {
            this.#rays = Math.max(kLeastRays, this.#rays * kFewerRays);
            this.#late = 1;
        } else if (this.#late < 1 + (kLate - 1) / 4) {
            this.#rays = Math.min(1, this.#rays * kMoreRays);
        }
    }

    #rayOf(frame, source) {
        const pose = frame.getPose(source.targetRaySpace, this.#space);
        if (!pose) return null;
        const m = pose.transform.matrix;
        return {from: xyz(pose.transform.position), along: [-m[8], -m[9], -m[10]]};
    }
    #distance({from, along}, treeFromWorld) {
        const direction = transformed(treeFromWorld, along, 0).slice(0, 3);
        return distanceTo(this.#player.box, transformed(treeFromWorld, from).slice(0, 3), direction);
    }
    #pointers(frame, treeFromWorld) {
        const pointers = [];
        for (const source of this.#session.inputSources) {
            const ray = source.targetRayMode === 'tracked-pointer' && this.#rayOf(frame, source);
            if (!ray) continue;
            const distance = this.#distance(ray, treeFromWorld), hits = distance < kReach;
            pointers.push({ends: [...ray.from, ...add(ray.from, ray.along.map(part => part * Math.min(distance, kReach)))], hits});
        }
        return pointers;
    }
    #grab({frame, inputSource}, button) {
        const ray = this.#rayOf(frame, inputSource);
        if (!ray || !this.#player.box || this.#distance(ray, inverse(this.#worldFromTree())) > kReach) return;
        this.#grabs.set(inputSource, {button, ray, begin: performance.now(), moved: 0});
    }
    #letGo({inputSource}) {
        const grab = this.#grabs.get(inputSource);
        this.#grabs.delete(inputSource);
        if (!grab || grab.button !== 'select' || grab.moved > kTap_m || performance.now() - grab.begin > kTap_ms) return;
        this.#player.paused ? this.#player.play().catch(() => {}) : this.#player.pause();
    }
    // One hand that holds the performer moves and turns it; two also scale it.
    #follow(frame) {
        for (const source of this.#grabs.keys())
            if (![...this.#session.inputSources].includes(source)) this.#grabs.delete(source);
        const before = [...this.#grabs.values()].map(grab => grab.ray);
        for (const [source, grab] of this.#grabs) {
            const ray = this.#rayOf(frame, source);
            if (!ray) continue;
            grab.moved += Math.hypot(...subtract(ray.from, grab.ray.from));
            grab.ray = ray;
        }
        const after = [...this.#grabs.values()].map(grab => grab.ray);
        if (after.length === 1) this.#move(subtract(after[0].from, before[0].from), yawOf(after[0].along) - yawOf(before[0].along), 1);
        if (after.length < 2) return;
        const [lineBefore, lineAfter] = [before, after].map(([a, b]) => subtract(b.from, a.from));
        const middles = [before, after].map(([a, b]) => add(a.from, b.from).map(sum => sum / 2));
        this.#move(subtract(middles[1], middles[0]), yawOf(lineAfter) - yawOf(lineBefore), Math.hypot(...lineAfter) / Math.max(Math.hypot(...lineBefore), 1e-3));
    }
    #move(by, turn, scale) {
        this.#at = add(this.#at, by);
        this.#turn += turn;
        this.#scale = Math.max(kLeastScale, Math.min(this.#scale * scale, kMostScale));
    }
}
