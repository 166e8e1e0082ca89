// Draws slice trees with WebGL 2: the engine's own walk (performer.frag), a ray for each pixel.

const kWidth = 4096;      // of textures; kTextureWidthLog2 of shaders/arrays.glsl
const kStop = 1 / 4096;   // the transmittance below which a ray ends, as in render/volume/trace.h
const kVertex = `#version 300 es
void main() {  // one triangle over the whole image
    gl_Position = vec4(4 * (gl_VertexID & 1) - 1, 4 * (gl_VertexID >> 1) - 1, 0, 1);
}`;

// Throws where the browser cannot draw.
export class WebglMissing extends Error {}

const subtract = (a, b) => a.map((value, i) => value - b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, factor) => a.map(value => factor * value);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const normalised = a => scaled(a, 1 / Math.hypot(...a));
const srgbOf = linear => linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;

/**
 * The rays of a camera at `eye` that looks at `target`, +y up, metres: pixel (x, y) from the top left of an image of
 * width × height has the direction corner + x·right + y·down. `angle`: from its top to its bottom, radians.
 */
export function lookAt(eye, target, angle, width, height) {
    const back = normalised(subtract(eye, target)), x = normalised(cross([0, 1, 0], back)), y = cross(back, x);
    const step = 2 * Math.tan(angle / 2) / height;
    const right = scaled(x, step), down = scaled(y, -step);
    const corner = [0, 1, 2].map(i => -back[i] - width / 2 * right[i] - height / 2 * down[i]);
    return {eye, right, down, corner};
}

/**
 * The pixels that a box, metres, may cover in an image of width × height: {x, y, width, height} from the bottom left, as
 * gl.scissor takes them. All of them where a corner of the box is not before the eye.
 */
function coveredBy({min, max}, {eye, right, down, corner}, width, height) {
    const forward = normalised(cross(right, down)), plane = dot(corner, forward);
    let [left, top, end, bottom] = [width, height, 0, 0];
    for (let i = 0; i < 8; ++i) {
        const towards = subtract([0, 1, 2].map(axis => (i >> axis & 1 ? max : min)[axis]), eye), depth = dot(towards, forward);
        if (depth <= 1e-3 * plane) return {x: 0, y: 0, width, height};
        const onPlane = subtract(scaled(towards, plane / depth), corner);
        const x = dot(onPlane, right) / dot(right, right), y = dot(onPlane, down) / dot(down, down);
        [left, top, end, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(end, x), Math.max(bottom, y)];
    }
    const inside = (value, most) => Math.max(0, Math.min(value, most));
    const [x, above, beyond, below] = [inside(Math.floor(left), width), inside(Math.floor(top), height), inside(Math.ceil(end), width),
                                       inside(Math.ceil(bottom), height)];
    return {x, y: height - below, width: Math.max(0, beyond - x), height: Math.max(0, below - above)};
}

/** A slice tree in textures. */
class TreeOnDevice {
    constructor(gl, tree) {
        this.gl = gl;
        this.textures = [['tree_links', gl.R32UI, gl.RED_INTEGER, 1, tree.links], ['nodes', gl.RGBA32UI, gl.RGBA_INTEGER, 4, tree.nodes],
                         ['entries', gl.RG32UI, gl.RG_INTEGER, 2, tree.entries]].map(one => this.#uploaded(...one));
        const {degree, nodeLevels, topLevels, topFirst, topLast, boxMin} = tree, boxSize = scaled(tree.boxSize, tree.scale);
        const at = (packed, more) => [0, 1, 2].map(
            axis => boxMin[axis] + ((packed >>> 10 * axis & 1023) + more) / 4 ** topLevels * boxSize[axis]);
        const leaves = {min: at(topFirst, 0), max: at(topLast, 1)};  // around them, metres
        Object.assign(this, {degree, nodeLevels, topLevels, topFirst, topLast, boxMin, boxSize, leaves});
    }
    #uploaded(name, internal, format, channels, words) {
        const gl = this.gl, texels = words.length / channels, rows = Math.max(1, Math.ceil(texels / kWidth));
        if (rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new WebglMissing('a frame has more leaves than this browser draws');
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, internal, kWidth, rows);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        const whole = Math.floor(texels / kWidth), rest = texels - whole * kWidth;
        if (whole > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kWidth, whole, format, gl.UNSIGNED_INT, words);
        if (rest > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, whole, rest, 1, format, gl.UNSIGNED_INT, words, whole * kWidth * channels);
        return {name, texture};
    }
    free() { for (const {texture} of this.textures) this.gl.deleteTexture(texture); }
}

export class Renderer {
    #gl; #walk; #programs = new Map(); #tree = null;

    /** `walk`: the text of performer.frag. Throws WebglMissing. */
    constructor(canvas, walk) {
        this.#gl = canvas.getContext('webgl2', {alpha: true, premultipliedAlpha: true, antialias: false, depth: false,
                                                powerPreference: 'high-performance'});
        if (!this.#gl) throw new WebglMissing('this browser has no WebGL 2');
        if (this.#gl.getParameter(this.#gl.MAX_TEXTURE_SIZE) < kWidth) throw new WebglMissing('this browser has too small textures');
        this.#walk = walk;
    }
    /** The slice tree that draw() shows from now on, as frames.js returns it. */
    show(tree) {
        if (this.#gl.isContextLost()) return;
        const next = new TreeOnDevice(this.#gl, tree);
        this.#tree?.free();
        this.#tree = next;
    }
    /** `rays`: of lookAt. `background`: linear RGB and alpha; what is not opaque is blended with the page. */
    draw(rays, background = [0, 0, 0, 0]) {
        const gl = this.#gl, tree = this.#tree;
        if (gl.isContextLost()) return;
        const width = gl.drawingBufferWidth, height = gl.drawingBufferHeight, alpha = background[3];
        gl.viewport(0, 0, width, height);
        gl.disable(gl.SCISSOR_TEST);
        gl.clearColor(...background.slice(0, 3).map(linear => srgbOf(linear) * alpha), alpha);
        gl.clear(gl.COLOR_BUFFER_BIT);
        if (!tree) return;
        const covered = coveredBy(tree.leaves, rays, width, height);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(covered.x, covered.y, covered.width, covered.height);
        const {program, places} = this.#program(tree);
        gl.useProgram(program);
        for (const [unit, {name, texture}] of tree.textures.entries()) {
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.uniform1i(places(name), unit);
        }
        const vector = (name, xyz, w = 0) => gl.uniform4f(places(`push.${name}`), ...xyz, w);
        vector('eye', rays.eye, kStop);
        vector('right', rays.right);
        vector('down', rays.down);
        vector('corner', rays.corner);
        vector('box_min', tree.boxMin);
        vector('box_size', tree.boxSize);
        vector('background', background.slice(0, 3), background[3]);
        gl.uniform1f(places('push.height'), height);
        gl.uniform1ui(places('push.top.first'), tree.topFirst);
        gl.uniform1ui(places('push.top.last'), tree.topLast);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    /** Forgets what it had on a device that was lost. */
    restore() {
        this.#tree = null;
        this.#programs.clear();
    }
    /** Frees all that it has on the device. */
    end() {
        this.#tree?.free();
        this.#tree = null;
        for (const {program} of this.#programs.values()) this.#gl.deleteProgram(program);
        this.#programs.clear();
    }

    // The walk for trees of this shape.
    #program({degree, nodeLevels, topLevels}) {
        const constants = [degree, nodeLevels, topLevels], key = constants.join();
        if (!this.#programs.has(key)) this.#programs.set(key, this.#compiled(constants));
        return this.#programs.get(key);
    }
    #compiled(constants) {
        const gl = this.#gl, program = gl.createProgram(), locations = new Map();
        const defined = constants.map((value, id) => `#define SPIRV_CROSS_CONSTANT_ID_${id} ${value}u\n`).join('');
        const version = '#version 300 es\n';
        for (const [type, text] of [[gl.VERTEX_SHADER, kVertex], [gl.FRAGMENT_SHADER, this.#walk.replace(version, version + defined)]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
                throw new WebglMissing(`the browser does not compile a shader: ${gl.getShaderInfoLog(shader)}`);
            gl.deleteShader(shader);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
            throw new WebglMissing(`the browser does not link a shader: ${gl.getProgramInfoLog(program)}`);
        const places = name => {
            if (!locations.has(name)) locations.set(name, gl.getUniformLocation(program, name));
            return locations.get(name);
        };
        return {program, places};
    }
}
