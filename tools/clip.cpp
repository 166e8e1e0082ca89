// neuvv clip: parts of clips, and clips one after the other, without training.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/platform.h"
#include "media/sound.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/unfinished_clip.h"
#include "training/run/claim.h"
#include "voctree/coarse.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_sound.h"
#include "voctree/files/nvv.h"
#include "voctree/files/world_frame.h"
#include "voctree/frames.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::tools {

namespace {

struct CutOptions {
    std::string clip, output, from, to;
};

struct JoinOptions {
    std::vector<std::string> clips;
    std::string output;
};

// Frames of a clip's file, which become a segment, with its overlap behind them.
struct Piece {
    voctree::ClipSegment source;
    uint32_t first = 0, frames = 1, overlap = 0;  // in the file
    bool is_whole() const { return frames + overlap == source.frames_of_file(); }
};

// The frames `begin` to `end` − 1 of a clip.
std::vector<Piece> pieces_of(const voctree::ClipIndex& index, uint32_t begin, uint32_t end) {
    std::vector<Piece> pieces;
    for (const voctree::ClipSegment& segment : index.segments) {
        const uint32_t first = std::max(begin, segment.first), last = std::min(end, segment.end());
        if (first >= last) continue;
        const bool goes_on = last == segment.end() && last < end;  // into the next segment
        pieces.push_back({segment, first - segment.first, last - first, goes_on ? segment.overlap : 0});
    }
    return pieces;
}

bool is_nvv(const Piece& piece) {
    return voctree::kind_of(piece.source.file) == voctree::ClipKind::kNvv;
}

// Whole .nvv files are copied byte by byte.
void write_piece(const Piece& piece, const std::filesystem::path& output) {
    if (piece.is_whole() && is_nvv(piece)) {
        std::error_code error;
        std::filesystem::copy_file(piece.source.file, output, error);
        if (error) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", output.string(), error.message()));
        return;
    }
    const voctree::VOctree part =
        voctree::frames_of(voctree::read_segment(piece.source), piece.first, piece.frames + piece.overlap);
    const voctree::ChunkOfFrame chunk(voctree::read_world_frame(piece.source.file));
    voctree::write_nvv(output, part, chunk.views(), 9, voctree::coarse_tree(part));
}

// What to say of a piece whose training is not finished. The .state of a file that is no segment says nothing: it stays
// when a run is finished.
std::string unfinished_text(const Piece& piece) {
    const std::filesystem::path& file = piece.source.file;
    const bool is_segment = voctree::is_segmented(file.parent_path());
    const auto claim = training::claim_of(file);
    if (!is_segment && !claim) return "";
    const std::string unfinished = training::unfinished_training(file);
    return unfinished.empty()
               ? ""
               : fmt::format("{} is half trained ({}): the part has it as it is now", file.string(), unfinished);
}

// Clips that stand elsewhere in their captures would jump where one follows the other.
void expect_one_frame(const std::vector<Piece>& pieces) {
    const voctree::WorldFrame first = voctree::read_world_frame(pieces.at(0).source.file);
    for (const Piece& piece : pieces)
        if (voctree::read_world_frame(piece.source.file) != first)
            throw InputError(piece.source.file.string(), "",
                             "has another origin or unit in its capture than the clip before it",
                             "`neuvv info` says which; put clips of several captures on a stage");
}

// Writes the pieces as one clip: as a file where there is only one, else in segments.
void write_clip(const std::vector<Piece>& pieces, float fps, const std::string& output) {
    for (const Piece& piece : pieces) {  // before anything is written
        std::error_code ignored;
        if (!std::filesystem::exists(piece.source.file, ignored))
            throw InputError(piece.source.file.string(), "", "is not there",
                             "train the clip to its end: the command that began it, with --resume");
        if (is_nvv(piece)) piece.source.source->header(piece.source);
    }
    expect_one_frame(pieces);
    catch_stop_signals();
    const UnfinishedClip clip(output);
    voctree::ClipIndex index{fps, {}};
    Progress progress("segments", pieces.size());
    for (const Piece& piece : pieces) {
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", output));
        const uint32_t first = index.segments.empty() ? 0 : index.frames();
        index.segments.push_back(
            {clip.folder() / voctree::segment_file_name(first), first, piece.frames, piece.overlap});
        write_piece(piece, index.segments.back().file);
        progress.update(index.segments.size());
    }
    progress.finish();
    // Said at the end, where it is seen.
    for (const Piece& piece : pieces)
        if (const std::string text = unfinished_text(piece); !text.empty()) say("{}\n", text);
    if (pieces.size() > 1) voctree::write_clip_index(clip.folder(), index);
    clip.finish(pieces.size() > 1 ? clip.folder() : index.segments[0].file);
    tell("wrote {}: {} frames in {} segment{}\n", output, index.frames(), pieces.size(), pieces.size() == 1 ? "" : "s");
}

// A part of a clip: what of its sound belongs to it, from a second on.
struct HeardPiece {
    std::filesystem::path clip;
    double from_s = 0, length_s = 0;
};

std::filesystem::path sound_of_output(const std::string& output) {
    return voctree::sound_file(voctree::clip_path(output));
}

// The sounds of pieces that follow each other, silence for those without; nothing where none has one. Throws InputError
// where a sound lies where that of the output would.
std::optional<media::Sound> heard_in(const std::vector<HeardPiece>& pieces, const std::string& output) {
    media::Sound all;
    bool any = false;
    double end_s = 0;
    for (const HeardPiece& piece : pieces) {
        if (const auto file = voctree::sound_beside(piece.clip)) {
            const media::Sound sound = media::read_sound(voctree::sound_here(*file));
            const auto first = std::min(static_cast<size_t>(piece.from_s * media::kSoundRate), sound.samples.size());
            const auto last =
                std::min(first + static_cast<size_t>(piece.length_s * media::kSoundRate), sound.samples.size());
            all.samples.insert(all.samples.end(), sound.samples.begin() + static_cast<ptrdiff_t>(first),
                               sound.samples.begin() + static_cast<ptrdiff_t>(last));
            any = true;
        }
        end_s += piece.length_s;
        all.samples.resize(static_cast<size_t>(end_s * media::kSoundRate));
    }
    if (!any) return std::nullopt;
    prepare_result("--output", sound_of_output(output));
    media::expect_sound_encoder();
    return all;
}

void cut(const CutOptions& options) {
    voctree::expect_no_stream(options.clip);
    const voctree::ClipIndex index = voctree::read_clip_index(options.clip);
    const double fps = double{index.fps};
    const uint32_t begin = options.from.empty() ? 0 : parse_frames("--from", options.from, fps);
    const uint32_t end = options.to.empty() ? index.frames() : parse_frames("--to", options.to, fps);
    if (begin >= end || end > index.frames())
        throw InputError("--from, --to", fmt::format("frames {} to {}", begin, end),
                         fmt::format("are no part of {}, which has {} frames", options.clip, index.frames()),
                         "--from is the first frame of the part, --to the first after it");
    const auto heard = heard_in({{voctree::clip_path(options.clip), begin / fps, (end - begin) / fps}}, options.output);
    write_clip(pieces_of(index, begin, end), index.fps, options.output);
    if (heard) media::write_sound(sound_of_output(options.output), *heard);
}

void join(const JoinOptions& options) {
    std::vector<Piece> pieces;
    std::vector<HeardPiece> heard_pieces;
    uint64_t frames = 0;
    std::optional<float> fps;
    if (options.clips.size() < 2) throw InputError("clips", options.clips[0], "is one clip alone", "name two or more");
    for (const std::string& clip : options.clips) {
        voctree::expect_no_stream(clip);
        const voctree::ClipIndex index = voctree::read_clip_index(clip);
        if (!fps) fps = index.fps;
        if (std::abs(*fps - index.fps) > 1e-3f * *fps)
            throw InputError(clip, "",
                             fmt::format("has {:g} frames a second, {} has {:g}", index.fps, options.clips[0], *fps),
                             "join clips of one frame rate; on a stage, `speed` changes it");
        frames += index.frames();
        heard_pieces.push_back({voctree::clip_path(clip), 0, index.frames() / double{index.fps}});
        for (const Piece& piece : pieces_of(index, 0, index.frames())) pieces.push_back(piece);
    }
    if (frames > voctree::kMaxClipFrames)
        throw InputError("--output", options.output, fmt::format("would have {} frames", frames),
                         fmt::format("a clip has at most {}", voctree::kMaxClipFrames));
    const auto heard = heard_in(heard_pieces, options.output);
    write_clip(pieces, *fps, options.output);
    if (heard) media::write_sound(sound_of_output(options.output), *heard);
}

constexpr const char* kClipExamples =
    "Examples:\n"
    "  neuvv clip cut work/long.nvv -o work/entrance.nvv --to 1s\n"
    "  neuvv clip cut work/long.nvv -o work/dance.nvv --from 25 --to 0:02.5\n"
    "  neuvv clip join work/dance.nvv work/entrance.nvv -o work/show.nvv\n";

}  // namespace

void add_clip(Command app, CommonOptions&) {
    Command verb = app.add_verb("clip", "Cut clips and join them, without training");
    verb.require_verb();
    verb.footer({kClipExamples});

    Command cut_verb = verb.add_verb("cut", "Write a part of a clip as a clip of its own");
    const auto cut_options = std::make_shared<CutOptions>();
    cut_verb.add_option("clip", cut_options->clip, "The .nvv, in segments or not").required();
    cut_verb.add_option("-o,--output", cut_options->output, "The .nvv to write").required();
    cut_verb.add_option("--from", cut_options->from,
                        "Where the part begins: a frame (24), seconds (1.5s) or minutes (2:10); else at the clip's "
                        "first frame");
    cut_verb.add_option("--to", cut_options->to,
                        "Where it ends: the first frame that is not in it; else at the clip's end");
    cut_verb.footer(
        {"Images of the part are those of the clip. Where the part has frames of several segments, it is in "
         "segments, too;\nwhole segments are copied as they are, but the last one without what it overlaps the next "
         "by.\nA sound beside the clip (.m4a) is cut, too; layers of paint stay with the clip.\n\n",
         kClipExamples});
    cut_verb.callback([cut_options] { cut(*cut_options); });

    Command join_verb = verb.add_verb("join", "Write clips that follow each other as one clip, in segments");
    const auto join_options = std::make_shared<JoinOptions>();
    join_verb.add_option("clips", join_options->clips, "Two or more .nvv, in segments or not, of one frame rate")
        .required();
    join_verb.add_option("-o,--output", join_options->output, "The .nvv to write").required();
    join_verb.footer(
        {"Files are copied as they are, so nothing is lost. Sounds beside the clips (.m4a) are joined, and encoded "
         "again;\nlayers of paint stay with their clips.\n\n",
         kClipExamples});
    join_verb.callback([join_options] { join(*join_options); });
}

}  // namespace neuvv::tools
