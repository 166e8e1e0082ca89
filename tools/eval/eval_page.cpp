#include "tools/eval/eval_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "base/text.h"
#include "tools/html.h"
#include "training/data/contact_sheet.h"
#include "training/evaluation/flip.h"

namespace neuvv::tools {

namespace {

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light dark; --line: #8886; --accent: #2a7de1; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5rem auto; padding: 0 1rem; max-width: 1320px; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .15rem .7rem; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
th { cursor: pointer; } tr.mean { font-weight: 600; }
.tables { display: flex; flex-wrap: wrap; gap: 2rem; align-items: flex-start; }
.scroll { max-height: 26rem; overflow: auto; padding-right: 1rem; }
.controls { display: flex; flex-wrap: wrap; gap: .5rem 1.2rem; margin: .6rem 0; align-items: center; }
button, select { font: inherit; }
button[aria-pressed=true] { outline: 2px solid var(--accent); }
.stage { position: relative; overflow: auto; border: 1px solid var(--line); max-height: 85vh; cursor: col-resize; }
.stage img { display: none; position: absolute; left: 0; top: 0; image-rendering: pixelated; }
.stage img.shown { display: block; }
.stage .bar { position: absolute; top: 0; width: 2px; background: var(--accent); pointer-events: none; }
.plots { display: flex; flex-wrap: wrap; gap: 1rem; }
svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
figure { margin: 0; } figure[hidden] { display: none; }
</style>)";

// Layers are selected by number, so that no file name ever becomes code.
constexpr const char* kScript = R"(<script>
'use strict';
const figures = [...document.querySelectorAll('figure')], pick = document.getElementById('pick');
const sides = [document.getElementById('left'), document.getElementById('right')];
const zoom = document.getElementById('zoom'), blinkButton = document.getElementById('blink');
let split = 0.5, blinkTimer = null, blinkSide = 0;
const current = () => figures[pick.selectedIndex];
function draw() {
  figures.forEach(f => f.hidden = f !== current());
  if (!current()) return;
  const stage = current().querySelector('.stage'), layers = [...stage.querySelectorAll('img')];
  const scale = +zoom.value || Math.min((document.body.clientWidth - 40) / layers[0].naturalWidth,
                                        0.8 * innerHeight / layers[0].naturalHeight) || 1;
  const w = layers[0].naturalWidth * scale, h = layers[0].naturalHeight * scale;
  stage.style.height = Math.min(h, innerHeight * 0.85) + 'px';
  const bar = stage.querySelector('.bar');
  bar.style.height = h + 'px'; bar.style.left = split * w + 'px'; bar.hidden = !!blinkTimer;
  layers.forEach((img, i) => {
    const isLeft = i === +sides[0].value, isRight = i === +sides[1].value;
    img.style.width = w + 'px'; img.style.height = h + 'px'; img.style.clipPath = ''; img.style.zIndex = 0;
    if (blinkTimer) { img.classList.toggle('shown', i === +sides[blinkSide].value); return; }
    img.classList.toggle('shown', isLeft || isRight);
    if (isLeft && !isRight) { img.style.clipPath = `inset(0 ${(1 - split) * 100}% 0 0)`; img.style.zIndex = 1; }
  });
  bar.style.zIndex = 2;
}
function show(i) { pick.selectedIndex = (i + figures.length) % figures.length; draw(); }
function toggleBlink() {
  if (blinkTimer) { clearInterval(blinkTimer); blinkTimer = null; }
  else blinkTimer = setInterval(() => { blinkSide = 1 - blinkSide; draw(); }, 600);
  blinkButton.setAttribute('aria-pressed', !!blinkTimer); draw();
}
document.querySelectorAll('.stage').forEach(stage => {
  const move = e => { if (e.type === 'pointermove' && !(e.buttons & 1)) return;
    const img = stage.querySelector('img'), box = stage.getBoundingClientRect();
    split = Math.max(0, Math.min(1, (e.clientX - box.left + stage.scrollLeft) / parseFloat(img.style.width))); draw(); };
  stage.addEventListener('pointermove', move); stage.addEventListener('pointerdown', move);
  stage.addEventListener('dragstart', e => e.preventDefault());
});
[pick, ...sides, zoom].forEach(e => e.addEventListener('change', draw));
blinkButton.addEventListener('click', toggleBlink);
document.addEventListener('keydown', e => {
  if (e.target.tagName === 'SELECT' || e.ctrlKey || e.metaKey || e.altKey) return;
  if (e.key === 'ArrowRight') show(pick.selectedIndex + 1);
  else if (e.key === 'ArrowLeft') show(pick.selectedIndex - 1);
  else if (e.key === 'b') toggleBlink();
  else if ('1234'.includes(e.key)) { sides[1].value = +e.key - 1; draw(); }
  else return;
  e.preventDefault();
});
document.querySelectorAll('th').forEach(th => th.addEventListener('click', () => {
  const body = th.closest('table').tBodies[0], k = th.cellIndex, sign = th.dataset.sign = -(th.dataset.sign || -1);
  const value = row => row.cells[k].dataset.value ?? row.cells[k].textContent;
  [...body.rows].sort((a, b) => { const x = value(a), y = value(b), d = parseFloat(x) - parseFloat(y);
    return sign * (Number.isNaN(d) ? x.localeCompare(y) : d); }).forEach(row => body.append(row));
}));
addEventListener('resize', draw); addEventListener('load', draw); draw();
</script>)";

struct Metric {
    const char *name, *unit;
    std::function<double(const training::Quality&)> of;
    int digits;
};

const std::array<Metric, 4>& metrics() {
    static const std::array<Metric, 4> all{{{"PSNR", " dB", [](const training::Quality& q) { return q.psnr; }, 2},
                                            {"SSIM", "", [](const training::Quality& q) { return q.ssim; }, 4},
                                            {"MAE", "", [](const training::Quality& q) { return q.mae; }, 4},
                                            {"FLIP", "", [](const training::Quality& q) { return q.flip; }, 4}}};
    return all;
}

std::string cells(const training::Quality& quality) {
    std::string text;
    for (const Metric& metric : metrics()) text += fmt::format("<td>{:.{}f}</td>", metric.of(quality), metric.digits);
    return text;
}

std::string table(const std::string& title, const std::string& first, const std::string& rows) {
    std::string head;
    for (const Metric& metric : metrics()) head += fmt::format("<th>{}{}</th>", metric.name, metric.unit);
    return fmt::format(
        "<section><h2>{}</h2><div class=\"scroll\"><table><thead><tr>{}{}</tr></thead><tbody>{}</tbody>"
        "</table></div></section>\n",
        title, first, head, rows);
}

// A curve of one number over the frames of the clip, as the mean over cameras.
std::string plot(const Metric& metric, const std::vector<training::Evaluation::Group>& frames) {
    constexpr double kWidth = 420, kHeight = 170, kLeft = 48, kBottom = 22, kTop = 10, kRight = 10;
    double low = 1e30, high = -1e30;
    for (const training::Evaluation::Group& frame : frames)
        if (frame.images > 0) {
            low = std::min(low, metric.of(frame.quality));
            high = std::max(high, metric.of(frame.quality));
        }
    const double margin = std::max(0.05 * (high - low), 1e-4);
    low -= margin;
    high += margin;
    const double last = std::max<double>(1, static_cast<double>(frames.size()) - 1);
    std::string points;
    for (size_t i = 0; i < frames.size(); ++i)
        if (frames[i].images > 0)
            points +=
                fmt::format("{:.1f},{:.1f} ", kLeft + static_cast<double>(i) / last * (kWidth - kLeft - kRight),
                            kTop + (high - metric.of(frames[i].quality)) / (high - low) * (kHeight - kTop - kBottom));
    return fmt::format(
        R"(<svg width="{0}" height="{1}" viewBox="0 0 {0} {1}" role="img"><title>{2} by frame</title>)"
        R"(<path d="M{3},{4}V{5}H{6}" fill="none" stroke="currentColor" opacity=".5"/>)"
        R"(<polyline points="{7}" fill="none" stroke="#2a7de1" stroke-width="1.8"/>)"
        R"(<text x="{8}" y="{9}" text-anchor="end">{10:.{11}f}</text><text x="{8}" y="{5}" text-anchor="end">)"
        R"({12:.{11}f}</text><text x="{3}" y="{13}">frame 0</text><text x="{6}" y="{13}" text-anchor="end">{14}</text>)"
        R"(<text x="{15}" y="{9}" text-anchor="middle">{2}{16}</text></svg>)",
        kWidth, kHeight, metric.name, kLeft, kTop, kHeight - kBottom, kWidth - kRight, points, kLeft - 4, kTop + 4,
        high, metric.digits, low, kHeight - 6, frames.size() - 1, kWidth / 2, metric.unit);
}

std::string all_tables(const training::Dataset& dataset, const training::Evaluation& evaluation,
                       const std::vector<std::string>& cameras) {
    std::string of_cameras, of_frames, of_views;
    for (size_t i = 0; i < cameras.size(); ++i)
        of_cameras += fmt::format("<tr><td>{}</td><td>{}</td>{}</tr>\n", html_text(cameras[i]),
                                  evaluation.cameras[i].images, cells(evaluation.cameras[i].quality));
    for (size_t i = 0; i < evaluation.frames.size(); ++i)
        of_frames += fmt::format("<tr><td>{}</td><td>{:.4f}</td><td>{}</td>{}</tr>\n", i, dataset.times[i],
                                 evaluation.frames[i].images, cells(evaluation.frames[i].quality));
    for (size_t i = 0; i < evaluation.views.size(); ++i)
        of_views += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td>{}</tr>\n", html_text(dataset.views[i].name),
                                html_text(cameras[dataset.views[i].camera]),
                                training::frame_of_view(dataset, dataset.views[i]), cells(evaluation.views[i]));
    return "<div class=\"tables\">\n" + table("Cameras", "<th>camera</th><th>images</th>", of_cameras) +
           table("Frames", "<th>frame</th><th>time</th><th>images</th>", of_frames) +
           table("All images", "<th>image</th><th>camera</th><th>frame</th>", of_views) + "</div>\n";
}

std::string layer(const media::Image& image, const char* name) {
    return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", name, base64(media::encode_png(image)));
}

// The image, scaled down by a whole factor where it is larger than the page shows.
media::Image page_sized(const media::Image& image) {
    return std::max(image.width, image.height) > kMaxPageSide ? training::scaled_to_fit(image, kMaxPageSide) : image;
}

std::string figure(const training::Dataset& dataset, const training::Evaluation& evaluation, const PageImage& image) {
    const training::Quality& quality = evaluation.views[image.view];
    std::string caption = html_text(dataset.views[image.view].name) + ":";
    for (const Metric& metric : metrics())
        caption += fmt::format(" {} {:.{}f}{}", metric.name, metric.of(quality), metric.digits, metric.unit);
    const media::Image flip_map =
        training::flip_image(training::flip(image.truth, image.render), image.truth.width, image.truth.height);
    return "<figure hidden><div class=\"stage\">\n" + layer(page_sized(image.truth), "truth") +
           layer(page_sized(image.render), "render") +
           layer(page_sized(training::error_image(image.truth, image.render)), "error") +
           layer(page_sized(flip_map), "FLIP") + "<div class=\"bar\"></div></div><figcaption>" + caption +
           "</figcaption></figure>\n";
}

std::string controls(const training::Dataset& dataset, const training::Evaluation& evaluation,
                     const std::vector<PageImage>& images) {
    std::string names;
    for (const PageImage& image : images)
        names += fmt::format("<option>{} ({:.2f} dB)</option>", html_text(dataset.views[image.view].name),
                             evaluation.views[image.view].psnr);
    const auto layers = [](size_t selected) {
        constexpr const char* kNames[] = {"truth", "render", "error", "FLIP"};
        std::string options;
        for (size_t i = 0; i < std::size(kNames); ++i)
            options +=
                fmt::format("<option value=\"{}\"{}>{}</option>", i, i == selected ? " selected" : "", kNames[i]);
        return options;
    };
    return fmt::format(
        "<div class=\"controls\"><label>image <select id=\"pick\">{}</select></label>\n"
        "<label>left <select id=\"left\">{}</select></label>\n<label>right <select id=\"right\">{}</select></label>\n"
        "<button id=\"blink\" aria-pressed=\"false\">blink</button>\n<label>zoom <select id=\"zoom\">"
        "<option "
        "value=\"0\">fit</option><option>1</option><option>2</option><option>4</option></select></label></div>\n"
        "<p>Drag in the image to move the border. Keys: ← → other image, 1 2 3 4 truth, render, error, FLIP on the "
        "right, b blink.</p>\n",
        names, layers(0), layers(1));
}

}  // namespace

std::string comparison_page(const PageFacts& facts, const training::Dataset& dataset,
                            const training::Evaluation& evaluation, const std::vector<PageImage>& images) {
    std::string page = kHtmlHead;
    page += fmt::format("<title>{}</title>\n{}</head><body>\n", html_text(facts.scene), kStyle);
    page += fmt::format("<h1>{} against {}</h1>\n", html_text(facts.scene), html_text(facts.dataset));
    page +=
        fmt::format("<p>{} images of {} cameras and {} frames, {} split, rendered on {}.<br>", evaluation.views.size(),
                    dataset.cameras.size(), dataset.times.size(), html_text(facts.split), html_text(facts.device));
    if (!facts.note.empty()) page += html_text(facts.note) + "<br>";
    page += "<b>";
    for (const Metric& metric : metrics())
        page += fmt::format("{} {:.{}f}{} &ensp;", metric.name, metric.of(evaluation.mean), metric.digits, metric.unit);
    page += "</b></p>\n<p>Means over images; 8-bit sRGB " + html_text(facts.compared) +
            ". Higher PSNR and SSIM, lower MAE and FLIP are better. The error image is white from a difference of "
            "0.25.</p>\n<h2>Images</h2>\n";
    page += controls(dataset, evaluation, images);
    for (const PageImage& image : images) page += figure(dataset, evaluation, image);
    page += "<h2>Over the clip</h2>\n<div class=\"plots\">";
    for (const Metric& metric : metrics()) page += plot(metric, evaluation.frames);
    page +=
        "</div>\n" + all_tables(dataset, evaluation, training::camera_labels(dataset)) + kScript + "</body></html>\n";
    return page;
}

}  // namespace neuvv::tools
