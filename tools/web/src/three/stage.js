// The time of a stage, and the performers, animations and lights that follow it.
import {AnimationMixer, Box3, LoopOnce, MathUtils, Vector3} from 'three';
import {TimeMap, timeMapText} from '../time_map.js';

const kAhead = 4;         // frames that are asked for before they are due
const kMostStep = 250;    // milliseconds; a page that was hidden goes on where it was
const kAround = 3;        // metres around performers in which directional lights cast shadows

/** Plays all that a glTF has. Its events are HTMLMediaElement's `loadedmetadata`, `play`, `pause`, `timeupdate`, `volumechange` and `ended`. */
export class Stage extends EventTarget {
    #performers; #mixer; #actions; #given; #scene; #time = 0; #last = null; #paused = true; #duration = 0; #muted = false; #volume = 1; #isShown = false;
    loop = true;
    background;  // a Color, for the scene in which the stage is
    omitted = [];  // what a browser does not show of it, in words

    /** `performers`: [{name, mesh, gain, time, spin_deg}], as NEUVV_performer has them. `duration`: seconds; else until all end. */
    constructor(gltf, performers, duration, background) {
        super();
        this.background = background;
        this.#scene = gltf.scene;
        this.#performers = performers.map(one => ({...one, map: null}));
        this.#mixer = new AnimationMixer(gltf.scene);
        this.#actions = gltf.animations.map(clip => this.#mixer.clipAction(clip).setLoop(LoopOnce).play());
        this.#given = Number.isFinite(duration) && duration >= 0 ? duration : null;
        for (const one of this.#performers) {
            one.mesh.media.addEventListener('loadedmetadata', () => this.#begin(one));
            one.mesh.media.addEventListener('volumechange', () => this.#tell('volumechange'));  // its sound may be there
        }
        this.volume = 1;
        this.#measure();
    }
    get performers() { return this.#performers.map(({name, mesh}) => ({name, mesh})); }
    get paused() { return this.#paused; }
    get duration() { return this.#duration; }
    get currentTime() { return this.#time; }
    set currentTime(seconds) {
        if (!Number.isFinite(seconds)) throw new TypeError('currentTime must be a number of seconds');
        this.#time = Math.max(0, Math.min(seconds, this.#duration));
    }
    /** Whether every performer that is seen has the frame of this time; one that cannot be read is not waited for. */
    get isReady() {
        return this.#performers.every(({mesh, map}) => !mesh.visible || mesh.media.error || (map && mesh.media.readyState >= 2));
    }
    /** HTMLMediaElement's: 0 nothing is known, 1 how long it lasts, 2 all frames of this time are there. */
    get readyState() { return this.isReady ? 2 : this.#performers.some(({map}) => map) ? 1 : 0; }
    get hasSound() { return this.#performers.some(({mesh}) => mesh.media.hasSound); }
    get muted() { return this.#muted; }
    set muted(on) {
        this.#muted = Boolean(on);
        for (const {mesh} of this.#performers) mesh.media.muted = this.#muted;
        this.#tell('volumechange');
    }
    /** Of all sounds, 0 to 1. */
    get volume() { return this.#volume; }
    set volume(volume) {
        this.#volume = volume;
        for (const {mesh, gain} of this.#performers) mesh.media.volume = volume * gain;
        this.#tell('volumechange');
    }
    async play() {
        if (!this.#paused) return;
        this.#paused = false;
        this.#last = null;
        if (this.#time >= this.#duration && !this.loop) this.#time = 0;
        for (const {mesh} of this.#performers) mesh.media.play().catch(() => {});
        this.#tell('play');
    }
    pause() {
        if (this.#paused) return;
        this.#paused = true;
        for (const {mesh} of this.#performers) mesh.media.pause();
        this.#tell('pause');
    }
    /** Shows what is due at `now`, milliseconds; it is heard from where the camera is. The time waits for frames that are missing. */
    update(now, camera = null) {
        const passed = Math.min(now - (this.#last ?? now), kMostStep) / 1000;
        this.#last = now;
        const isReady = this.isReady;
        if (!this.#paused && isReady && this.#isShown) this.#advance(passed);
        this.#isShown = isReady;  // an image with the frames that were waited for comes first
        for (const action of this.#actions) action.time = Math.min(this.#time, action.getClip().duration);
        this.#mixer.update(0);
        for (const one of this.#performers) this.#show(one, camera);
        this.#tell('timeupdate');
    }
    dispose() {
        this.#mixer.stopAllAction();
        for (const {mesh, map} of this.#performers) {
            mesh.dispose();
            map?.free();
        }
        this.#performers = [];
    }

    #tell(name) { this.dispatchEvent(new Event(name)); }
    async #begin(one) {
        const {mesh, time} = one, {duration, frameRate} = mesh.media;
        try {
            const map = await TimeMap.of(timeMapText(time), Math.round(duration * frameRate), frameRate);
            if (!this.#performers.includes(one)) return map.free();  // the stage has ended meanwhile
            one.map = map;
        } catch (error) {
            return mesh.media.fail(error);
        }
        this.#measure();
        this.#fitShadows();
        this.#tell('loadedmetadata');
    }
    // As the engine has it: one that plays for ever lasts as long as its clip.
    #measure() {
        const known = this.#performers.filter(({map}) => map);
        const ends = known.map(({map, mesh}) => Number.isFinite(map.length) ? map.length : mesh.media.duration);
        this.#duration = this.#given ?? Math.max(0, ...ends, ...this.#actions.map(action => action.getClip().duration));
    }
    #advance(seconds) {
        this.#time += seconds;
        if (this.#time < this.#duration) return;
        if (this.loop && this.#duration > 0) return void (this.#time %= this.#duration);
        this.#time = this.#duration;
        this.pause();
        this.#tell('ended');
    }
    #show({mesh, map, spin_deg}, camera) {
        mesh.rotation.y = MathUtils.degToRad(spin_deg * this.#time % 360);
        if (!map || !mesh.visible) return;
        const fps = mesh.media.frameRate, at = this.#time, heard = map.position(at) / fps;
        const frames = Array.from({length: kAhead + 1}, (_, i) => Math.floor(map.frame(this.#later(at, i / fps))));
        const rate = (map.position(at + 0.5 / fps) / fps - heard) * 2 * fps;
        mesh.show(mesh.media.follow(frames, heard, this.#paused || !this.isReady ? 0 : rate));
        if (camera) mesh.hearFrom(camera);
    }
    // The time of the stage so much later.
    #later(time, seconds) {
        const later = time + seconds;
        return this.loop && later >= this.#duration && this.#duration > 0 ? later % this.#duration : later;
    }
    // A directional light's shadows reach around all performers.
    #fitShadows() {
        this.#scene.updateMatrixWorld();
        const box = new Box3();
        for (const {mesh} of this.#performers)
            if (mesh.geometry.boundingBox) box.union(mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld));
        if (box.isEmpty()) return;
        const middle = box.getCenter(new Vector3()), radius = box.getSize(new Vector3()).length() / 2 + kAround;
        this.#scene.traverse(light => {
            if (!light.isDirectionalLight || !light.castShadow) return;
            const {shadow} = light, {camera} = shadow;
            shadow.updateMatrices(light);
            const {x, y, z} = middle.clone().applyMatrix4(camera.matrixWorldInverse);
            Object.assign(camera, {left: x - radius, right: x + radius, bottom: y - radius, top: y + radius});
            Object.assign(camera, {near: -z - radius, far: -z + radius});
            camera.updateProjectionMatrix();
        });
    }
}
