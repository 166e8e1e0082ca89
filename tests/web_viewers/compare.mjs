// How web viewers show the splats of a clip's first frame, against `neuvv render`: PSNR, and a picture of each viewer.
//
//   node tests/web_viewers/compare.mjs build/release/neuvv CLIP FOLDER [option of neuvv export]...
//
// By hand: it needs npm with its registry and Debian's chromium. Exits with 1 where a viewer shows something else.
import {execFileSync, spawn} from "node:child_process";
import fs from "node:fs";
import http from "node:http";
import {createRequire} from "node:module";
import path from "node:path";
import {fileURLToPath} from "node:url";

const kRuns = [["babylon", "splats.glb"], ["playcanvas", "splats.glb"], ["playcanvas", "splats.ply"], ["spark", "splats.ply"]];
const kLeast_db = 20;  // upside down or mirrored: 9
const kAngle_deg = 40, kSide_px = 720, kMost_s = 300;

const [neuvv, clip, folder, ...options] = process.argv.slice(2);
if (!folder) {
    console.error("usage: node compare.mjs NEUVV CLIP FOLDER [option of neuvv export]...");
    process.exit(2);
}
const pages = path.dirname(fileURLToPath(import.meta.url));
const inFolder = name => path.join(folder, name);
fs.mkdirSync(folder, {recursive: true});
fs.copyFileSync(path.join(pages, "package.json"), inFolder("package.json"));
execFileSync("npm", ["install", "--ignore-scripts", "--no-audit", "--no-fund"], {cwd: folder, stdio: "inherit"});

for (const name of ["splats.glb", "splats.ply"])
    execFileSync(neuvv, ["export", clip, "-o", inFolder(name), "--frames", "0", ...options], {stdio: "inherit"});

// A camera before the splats, somewhat to their side and above them.
function lookAtSplats() {
    const glb = fs.readFileSync(inFolder("splats.glb"));
    const json = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)));
    const {min, max} = json.accessors[json.meshes[0].primitives[0].attributes.POSITION];
    const at = min.map((value, i) => (value + max[i]) / 2);
    const distance = 0.8 * Math.hypot(...min.map((value, i) => max[i] - value)) / 2 / Math.tan(kAngle_deg * Math.PI / 360);
    const towards = [Math.sin(0.5), 0.2, Math.cos(0.5)], length = Math.hypot(...towards);
    const z = towards.map(value => value / length), across = Math.hypot(z[0], z[2]);
    const x = [z[2] / across, 0, -z[0] / across];
    const y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]];
    const eye = at.map((value, i) => value + distance * z[i]);
    const focal_px = kSide_px / 2 / Math.tan(kAngle_deg * Math.PI / 360);
    fs.writeFileSync(inFolder("view.json"), JSON.stringify({eye, at, angle_deg: kAngle_deg, side_px: kSide_px, near: 0.01 * distance, far: 10 * distance}));
    fs.writeFileSync(inFolder("camera.json"), JSON.stringify({
        w: kSide_px, h: kSide_px, fl_x: focal_px, fl_y: focal_px, cx: kSide_px / 2, cy: kSide_px / 2,
        frames: [{transform_matrix: [0, 1, 2].map(i => [x[i], y[i], z[i], eye[i]]).concat([[0, 0, 0, 1]])}]}));
}
lookAtSplats();
execFileSync(neuvv, ["render", clip, "-o", inFolder("neuvv.png"), "--camera", inFolder("camera.json"), "--frames", "0",
                     "--background", "white"], {stdio: "inherit"});

const kTypes = {".html": "text/html", ".mjs": "text/javascript", ".js": "text/javascript", ".json": "application/json"};
const server = http.createServer((request, response) => {
    const name = path.normalize(new URL(request.url, "http://x").pathname);
    const file = [pages, folder].map(root => path.join(root, name)).find(file => fs.existsSync(file) && fs.statSync(file).isFile());
    response.writeHead(file ? 200 : 404, {"Content-Type": kTypes[path.extname(name)] ?? "application/octet-stream"});
    response.end(file ? fs.readFileSync(file) : "");
});
await new Promise(resolve => server.listen(0, "127.0.0.1", resolve));

const sleep = ms => new Promise(resolve => setTimeout(resolve, ms));
const profile = inFolder("profile");
const browser = spawn("chromium", ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
                                   "--enable-unsafe-swiftshader", "--remote-debugging-port=0", `--window-size=${kSide_px},900`,
                                   "--force-device-scale-factor=1", `--user-data-dir=${path.resolve(profile)}`, "about:blank"],
                      {stdio: "ignore"});
browser.once("error", problem => {
    console.error(`chromium cannot be started: ${problem.message}`);
    process.exit(1);
});
process.on("exit", () => browser.kill("SIGKILL"));
const portFile = path.join(profile, "DevToolsActivePort");
fs.rmSync(portFile, {force: true});
browser.once("exit", code => {
    console.error(`chromium ended with ${code}`);
    process.exit(1);
});
while (!fs.existsSync(portFile)) await sleep(200);
const port = fs.readFileSync(portFile, "utf8").split("\n")[0];

const {WebSocket} = createRequire(path.resolve(folder, "x.js"))("ws");
const tabs = await (await fetch(`http://127.0.0.1:${port}/json`)).json();
const socket = new WebSocket(tabs.find(tab => tab.type == "page").webSocketDebuggerUrl, {maxPayload: 1 << 30});
await new Promise(resolve => socket.once("open", resolve));
let last = 0;
const send = (method, params) => new Promise(resolve => {
    const id = ++last;
    const answer = text => {
        const message = JSON.parse(text);
        if (message.id != id) return;
        socket.off("message", answer);
        resolve(message.result);
    };
    socket.on("message", answer);
    socket.send(JSON.stringify({id, method, params}));
});

let good = true;
for (const [page, file] of kRuns) {
    await send("Page.navigate", {url: `http://127.0.0.1:${server.address().port}/${page}.html?file=${file}`});
    let result = {error: `nothing was shown within ${kMost_s} s`};
    for (const end = Date.now() + 1000 * kMost_s; Date.now() < end; await sleep(1000)) {
        const found = await send("Runtime.evaluate", {expression: "window.result", returnByValue: true});
        if (!found?.result?.value) continue;
        result = found.result.value;
        break;
    }
    if (result.png) fs.writeFileSync(inFolder(`${page}-${file}.png`), Buffer.from(result.png.split(",")[1], "base64"));
    good &&= result.psnr_db > kLeast_db;
    console.log(`${page} ${file}: ${result.error ?? result.psnr_db.toFixed(1) + " dB"}`);
}
process.exit(good ? 0 : 1);
