// Matrices of 4×4, column after column, as WebGL, WebXR and three.js have them.

/** a · b. */
export function multiply(a, b) {
    const result = new Array(16);
    for (let column = 0; column < 4; ++column)
        for (let row = 0; row < 4; ++row)
            result[4 * column + row] = [0, 1, 2, 3].reduce((sum, i) => sum + a[4 * i + row] * b[4 * column + i], 0);
    return result;
}

/** m · (x, y, z, w): four numbers. */
export function transformed(m, [x, y, z], w = 1) {
    return [0, 1, 2, 3].map(row => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row] * w);
}

/** Of a turn about +y by `turn` radians, a scaling, then a shift. */
export function placement(turn, scale, [x, y, z]) {
    const [c, s] = [scale * Math.cos(turn), scale * Math.sin(turn)];
    return [c, 0, -s, 0, 0, scale, 0, 0, s, 0, c, 0, x, y, z, 1];
}

/** The inverse of a matrix that has one. */
export function inverse(m) {
    const cofactor = (row, column) => {
        const [a, b, c, d, e, f, g, h, i] = [...m.keys()].filter(at => at % 4 !== row && Math.floor(at / 4) !== column).map(at => m[at]);
        return ((row + column) % 2 ? -1 : 1) * (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g));
    };
    const cofactors = Array.from({length: 16}, (_, at) => cofactor(at % 4, Math.floor(at / 4)));
    const determinant = [0, 1, 2, 3].reduce((sum, row) => sum + m[row] * cofactors[row], 0);
    return cofactors.map((_, at) => cofactors[4 * (at % 4) + Math.floor(at / 4)] / determinant);
}

/**
 * Where the rays of an image come from: [x, y, z, 1]; where they are parallel, [x, y, z, 0], of length 1 and against them:
 * the point that the projection sends to infinity.
 */
export function eyeOf(clipFromTree, isParallel) {
    const eye = transformed(inverse(clipFromTree), [0, 0, -1], 0);
    const size = isParallel ? Math.hypot(...eye.slice(0, 3)) : eye[3];
    return [...eye.slice(0, 3).map(part => part / size), isParallel ? 0 : 1];
}

/**
 * The rays of an image in the viewport [x, y, width, height]: pixel (x, y) from the bottom left of the framebuffer is on the
 * near plane at w·eye + corner + x·right + y·up; w: the fourth number of `eye`, 0 where rays are parallel.
 */
export function raysOf(eye, clipFromTree, [x, y, width, height]) {
    const treeFromClip = inverse(clipFromTree);
    const at = (across, above) => {
        const [px, py, pz, w] = transformed(treeFromClip, [2 * (across - x) / width - 1, 2 * (above - y) / height - 1, -1]);
        return [px, py, pz].map((part, axis) => part / w - eye[3] * eye[axis]);
    };
    const corner = at(0, 0);
    return {corner, right: subtract(at(width, 0), corner).map(part => part / width), up: subtract(at(0, height), corner).map(part => part / height)};
}

/** From the coordinates of a camera (right, up, back) to clip space. `angle`: from the image's top to its bottom, radians; no far end. */
export function perspective(angle, aspect, near) {
    const high = 1 / Math.tan(angle / 2);
    return [high / aspect, 0, 0, 0, 0, high, 0, 0, 0, 0, -1, -1, 0, 0, -2 * near, 0];
}

const subtract = (a, b) => a.map((value, i) => value - b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const normalised = a => a.map(value => value / Math.hypot(...a));

/** From the world to the coordinates of a camera at `eye` that looks at `target`, +y up. */
export function lookAt(eye, target) {
    const back = normalised(subtract(eye, target)), right = normalised(cross([0, 1, 0], back)), up = cross(back, right);
    return [0, 1, 2].flatMap(i => [right[i], up[i], back[i], 0]).concat([-dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
}
