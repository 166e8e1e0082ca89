// What the pages share: which file they show from where and in which size, and how well their canvas shows what NeuVV
// rendered.
export const file = new URLSearchParams(location.search).get("file");
export const view = await (await fetch("view.json")).json();
const side = view.side_px;
export const canvas = document.getElementById("canvas");
canvas.width = canvas.height = side;
canvas.style.width = canvas.style.height = `${side}px`;

const kImages = 60;  // viewers sort splats while they draw the first ones
let images = 0;
export function shown() {
    if (++images == kImages) compare();
}

function pixels(image) {
    const context = new OffscreenCanvas(side, side).getContext("2d");
    context.fillStyle = "white";
    context.fillRect(0, 0, side, side);
    context.drawImage(image, 0, 0, side, side);
    return context.getImageData(0, 0, side, side).data;
}

async function compare() {
    const truth = new Image();
    truth.src = "neuvv.png";
    await truth.decode();
    const a = pixels(truth), b = pixels(canvas);
    let sum = 0;
    for (let i = 0; i < a.length; i++)
        if (i % 4 != 3) sum += (a[i] - b[i]) ** 2;
    window.result = {psnr_db: 10 * Math.log10(255 ** 2 / (sum / (0.75 * a.length))), png: canvas.toDataURL("image/png")};
}
