// Images of the tests of pages.

/** Of what a canvas or an image shows: RGBA, a byte each, from the top left. */
export async function pixels(image, width, height) {
    const context = new OffscreenCanvas(width, height).getContext('2d');
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, width, height).data;
}

/** Of colours, without alpha; of the pixels that are chosen. */
export function psnr(a, b, isChosen = () => true) {
    let sum = 0, count = 0;
    for (let i = 0; i < a.length; ++i) {
        if (i % 4 === 3 || !isChosen(i >> 2)) continue;
        sum += (a[i] - b[i]) ** 2;
        ++count;
    }
    return 10 * Math.log10(255 ** 2 / Math.max(sum / count, 1e-9));
}
