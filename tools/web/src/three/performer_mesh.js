// A performer as an object of a scene of three.js.
import {Box3, BoxGeometry, BufferGeometry, DataTexture, LinearSRGBColorSpace, Matrix4, Mesh, Object3D, RGBAIntegerFormat, RGIntegerFormat,
        RedIntegerFormat, SRGBColorSpace, UnsignedIntType, Vector3} from 'three';
import {loadedWalk} from '../loaded.js';
import {eyeOf, raysOf} from '../matrices.js';
import {playing} from '../playing.js';
import {boxesOf, kStop, kWidth, texturesOf} from '../slice_tree.js';
import {walkMaterials, walkUniforms} from './walk_materials.js';

const kFormats = {1: [RedIntegerFormat, 'R32UI'], 2: [RGIntegerFormat, 'RG32UI'], 4: [RGBAIntegerFormat, 'RGBA32UI']};  // by channels
const kNeverStarts = 2;  // a transmittance at which no ray begins

/** Its clock and frames, with the names and events of HTMLMediaElement. */
class Media extends playing(EventTarget) {
    loop = true;
}

/** The texture of a part of a slice tree; its content is put into the storage that is there where that has the size. */
function filled(texture, {channels, words, rows}) {
    if (texture?.image.height !== rows) {
        texture?.dispose();
        const [format, internalFormat] = kFormats[channels];
        texture = Object.assign(new DataTexture(words, kWidth, rows, format, UnsignedIntType), {internalFormat});
    }
    texture.image.data = words;
    texture.needsUpdate = true;
    return texture;
}

/**
 * Plays a stream where it stands in a scene: opaque objects hide it and are hidden by it, and it may cast shadows. Its
 * transform is any that has an inverse. Call update() before each image. The renderer's depth is the usual one, neither
 * logarithmic nor reversed; tone mapping, fog and clipping planes do not change it.
 */
export class PerformerMesh extends Mesh {
    #options; #uniforms = walkUniforms(); #materials = null; #rows = 0; #isDisposed = false; #clipFromTree = new Matrix4();
    media = new Media();
    opacity = 1;

    /**
     * `sound`: the address of what is heard. `isLit`: the scene's lights shine on it, as if it faced all of them; ambient light
     * of the intensity π leaves its colours as they were filmed. `budget`: how many leaves it shall have at most.
     */
    constructor({url, sound = null, loop = true, isLit = false, budget = 0} = {}) {
        if (!url) throw new TypeError('PerformerMesh needs the option `url`, the address of a .nvs');
        super(new BufferGeometry(), []);
        this.#options = {url, sound, loop, isLit, budget};
        this.media.loop = loop;
        this.media.addEventListener('loadedmetadata', () => this.#fit(this.media.box));
        this.media.addEventListener('error', ({message}) => console.error(`${url}: ${message}`));
        this.url = url;
        this.#open();
    }
    /** Another one with a clock of its own. */
    clone(recursive) { return new this.constructor(this.#options).copy(this, recursive); }
    copy(source, recursive) {
        Object3D.prototype.copy.call(this, source, recursive);  // neither its box nor its materials
        this.opacity = source.opacity;
        return this;
    }
    /** Shows what is due at `now`, as requestAnimationFrame gives it, milliseconds; it is heard from where the camera is. */
    update(now, camera = null) {
        this.show(this.media.tick(now));
        if (camera) this.hearFrom(camera);
    }
    /** Shows a slice tree from now on; null: what is shown stays. */
    show(tree) {
        if (!tree || !this.#materials) return;
        const uniforms = this.#uniforms, {push} = uniforms, {min, size, leaves} = boxesOf(tree), parts = texturesOf(tree);
        for (const part of parts) uniforms[part.name].value = filled(uniforms[part.name].value, part);
        this.#rows = Math.max(...parts.map(part => part.rows));
        uniforms.low.value = leaves.min;
        uniforms.high.value = leaves.max;
        Object.assign(push.value, {box_min: [...min, 0], box_size: [...size, 0], top: {first: tree.topFirst, last: tree.topLast}});
        this.#shape([tree.degree, tree.nodeLevels, tree.topLevels]);
        this.material.visible = true;
    }
    hearFrom(camera) {
        const {box} = this.media;
        if (!box) return;
        const middle = new Vector3(...box.min.map((low, axis) => (low + box.max[axis]) / 2));
        this.media.hearFrom(middle.applyMatrix4(this.matrixWorld).applyMatrix4(camera.matrixWorldInverse).toArray());
    }
    /** Hits the box around all leaves. */
    raycast(raycaster, hits) {
        if (!this.media.box) return;
        const ray = raycaster.ray.clone().applyMatrix4(this.matrixWorld.clone().invert());
        const point = ray.intersectBox(this.geometry.boundingBox, new Vector3())?.applyMatrix4(this.matrixWorld);
        const distance = point?.distanceTo(raycaster.ray.origin);
        if (distance >= raycaster.near && distance <= raycaster.far) hits.push({distance, point, object: this});
    }
    /** Ends all that runs, and frees what it has. */
    dispose() {
        this.#isDisposed = true;
        this.media.end();
        this.geometry.dispose();
        for (const material of Object.values(this.#materials ?? {})) material.dispose();
        for (const name of ['tree_links', 'nodes', 'entries']) this.#uniforms[name].value?.dispose();
    }

    // three.js calls these before it draws into an image, and into a shadow map.
    onBeforeRender(renderer, scene, camera, geometry, material) {
        const target = renderer.getRenderTarget();
        const space = target === null ? renderer.outputColorSpace : target.isXRRenderTarget ? target.texture.colorSpace : LinearSRGBColorSpace;
        this.#uniforms.is_srgb.value = space === SRGBColorSpace;
        this.#uniforms.opacity.value = this.opacity;
        this.#aim(renderer, camera, material);
        if (this.#rows > renderer.capabilities.maxTextureSize && !this.media.error)
            this.media.fail(new Error('a frame has more leaves than this browser draws'));
    }
    onBeforeShadow(renderer, scene, camera, shadowCamera, geometry, material) {
        this.#uniforms.near.value = shadowCamera.near;
        this.#uniforms.far.value = shadowCamera.far;
        this.#aim(renderer, shadowCamera, material);
    }

    async #open() {
        const {url, sound, isLit, budget} = this.#options;
        try {
            const walk = await loadedWalk();
            if (this.#isDisposed) return;
            this.#materials = walkMaterials(walk, this.#uniforms, isLit);
            this.material = this.#materials.image;
            this.material.visible = false;  // until a frame is there
            this.customDepthMaterial = this.#materials.depth;
            this.customDistanceMaterial = this.#materials.distance;
            await this.media.open(new URL(url, document.baseURI), sound && new URL(sound, document.baseURI), budget);
        } catch (error) {
            this.media.fail(error);
        }
    }
    #fit({min, max}) {
        this.geometry.dispose();
        const box = new Box3(new Vector3(...min), new Vector3(...max)), size = box.getSize(new Vector3());
        this.geometry = new BoxGeometry(size.x, size.y, size.z).translate(...box.getCenter(new Vector3()).toArray());
        this.geometry.boundingBox = box;
    }
    // The walk is compiled for trees of this shape; three.js keeps what it has compiled.
    #shape(constants) {
        const texts = [...constants.map(value => `${value}u`), 'true'];  // the last: it writes linear light
        const defines = Object.fromEntries(texts.map((text, id) => [`SPIRV_CROSS_CONSTANT_ID_${id}`, text]));
        for (const material of Object.values(this.#materials)) {
            if (JSON.stringify(material.defines) === JSON.stringify(defines)) continue;
            material.defines = defines;
            material.needsUpdate = true;
        }
    }
    // The rays of the viewport that is being drawn into.
    #aim(renderer, camera, material) {
        const uniforms = this.#uniforms, gl = renderer.getContext(), viewport = [...gl.getParameter(gl.VIEWPORT)];
        const matrix = this.#clipFromTree.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(this.matrixWorld);
        const isParallel = camera.projectionMatrix.elements[11] === 0, isFlat = !Number.isFinite(1 / matrix.determinant());
        uniforms.clip_from_tree.value = matrix.elements;
        uniforms.viewport.value = viewport;
        uniforms.view_from_clip.value = camera.projectionMatrixInverse.elements;
        const eye = eyeOf(matrix.elements, isParallel), rays = raysOf(eye, matrix.elements, viewport);
        for (const [name, vector] of Object.entries(rays)) uniforms.push.value[name] = [...vector, 0];
        Object.assign(uniforms.push.value, {eye, clip_from_tree: matrix.elements, stop: isFlat ? kNeverStarts : kStop});
        material.uniformsNeedUpdate = true;
    }
}
