#include "voctree/files/nvpaint.h"

#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/pack.h"

namespace neuvv::voctree {

namespace {

// The columns of the edits, in file order; PTHD and PTLF come before them.
enum ColumnIndex { kFirst, kLast, kRed, kGreen, kBlue, kAlpha, kSigma, kColumns };
constexpr const char* kHeadName = "PTHD";
constexpr const char* kLeafName = "PTLF";
constexpr const char* kColumnNames[kColumns] = {"PTF0", "PTF1", "PTCR", "PTCG", "PTCB", "PTAL", "PTSG"};
constexpr uint32_t kMaxEdits = 1u << 28;
constexpr const char* kWriteAgain = "write the file again";

struct PaintHeader {
    uint64_t topology;
    uint32_t leaf_count, frames, edit_count, reserved;
};
static_assert(sizeof(PaintHeader) == 24);

float& number_of(LeafEdit& edit, int column) {
    float* const numbers[kColumns] = {&edit.first,    &edit.last,  &edit.colour.r, &edit.colour.g,
                                      &edit.colour.b, &edit.alpha, &edit.sigma};
    return *numbers[column];
}

PaintHeader read_paint_header(ChunkReader& file) {
    PaintHeader header{};
    std::memcpy(&header, file.take(sizeof header).data(), sizeof header);
    if (header.edit_count > kMaxEdits)
        file.fail(fmt::format("edit_count is {}, must be 0 to {}", header.edit_count, kMaxEdits), kWriteAgain);
    if (header.reserved != 0) file.fail("has numbers that this program does not know", "open it with a newer neuvv");
    return header;
}

void expect_field(const ChunkReader& file, const PaintHeader& header, const PaintedField& field) {
    const PaintedField painted{header.topology, header.leaf_count, header.frames};
    if (painted == field) return;
    const bool other_clip = painted.topology == field.topology && painted.leaf_count == field.leaf_count;
    file.fail(other_clip ? fmt::format("is paint for a clip of {} frames, not {}", header.frames, field.frames)
                         : fmt::format("is paint for another scene or another training of it ({} leaves, here {})",
                                       header.leaf_count, field.leaf_count),
              "use the .nvv that it was painted on, or paint anew");
}

void expect_next(ChunkReader& file, ChunkHeader& chunk, const char* name) {
    if (!file.next(chunk)) throw InputError(file.path(), "", fmt::format("ends before chunk {}", name), kWriteAgain);
    if (chunk.name != name) file.fail_damaged(fmt::format("is where chunk {} must be", name));
}

}  // namespace

void write_paint(const std::filesystem::path& path, const EditLayer& layer) {
    std::string defect = defect_of(layer);
    if (defect.empty() && layer.edits.size() > kMaxEdits) defect = "too many edits";
    if (!defect.empty()) throw RuntimeFailure(fmt::format("{}: not written: {}", path.string(), defect));
    const auto count = static_cast<uint32_t>(layer.edits.size());
    write_file_atomically(path, [&](const ByteSink& sink) {
        ChunkWriter file(path.string(), sink, 3);
        const PaintHeader header{layer.field.topology, layer.field.leaf_count, layer.field.frames, count, 0};
        file.add(kHeadName, &header, sizeof header);
        std::vector<uint32_t> leaves;
        leaves.reserve(count);
        for (const LeafEdit& edit : layer.edits) leaves.push_back(edit.leaf);
        const std::vector<uint8_t> packed = pack_children(leaves);
        file.add(kLeafName, packed.data(), packed.size());
        std::vector<float> column(count);
        for (int i = 0; i < kColumns; ++i) {
            for (size_t k = 0; k < count; ++k) {
                LeafEdit edit = layer.edits[k];
                column[k] = number_of(edit, i);
            }
            file.add(kColumnNames[i], column.data(), column.size() * sizeof(float));
        }
        file.finish();
    });
}

EditLayer read_paint(const std::filesystem::path& path, const PaintedField& field) {
    if (content_of(path) == FileContent::kClip)
        throw InputError(path.string(), "", "is a clip, not a layer of paint", Remedy::kNamePaint);
    ChunkReader file(path, {".nvpaint", Remedy::kNamePaint});
    ChunkHeader chunk;
    if (!file.next(chunk) || chunk.name != kHeadName)
        throw InputError(path.string(), "", "is not a layer of paint", Remedy::kNamePaint);
    const PaintHeader header = read_paint_header(file);
    expect_field(file, header, field);
    EditLayer layer{field, {}};
    expect_next(file, chunk, kLeafName);
    const std::vector<uint32_t> leaves = unpack_children(file.take(uint64_t{4} * header.edit_count));
    layer.edits.resize(header.edit_count);
    for (size_t i = 0; i < leaves.size(); ++i) layer.edits[i].leaf = leaves[i];
    for (int i = 0; i < kColumns; ++i) {
        expect_next(file, chunk, kColumnNames[i]);
        const std::vector<uint8_t> bytes = file.take(uint64_t{4} * header.edit_count);
        for (size_t k = 0; k < layer.edits.size(); ++k)
            std::memcpy(&number_of(layer.edits[k], i), &bytes[4 * k], sizeof(float));
    }
    while (file.next(chunk)) {
        if (!is_ancillary(chunk.name)) file.fail("is unknown to this program", "open the file with a newer neuvv");
        file.skip(true);
    }
    const std::string defect = defect_of(layer);
    if (!defect.empty()) throw InputError(path.string(), "", defect, kWriteAgain);
    return layer;
}

std::filesystem::path paint_file(const std::filesystem::path& layer, const ClipSegment& segment) {
    return layer / segment.file.filename().replace_extension(".nvpaint");
}

void expect_paint_folder(const std::filesystem::path& layer) {
    std::error_code error;
    if (std::filesystem::is_directory(layer, error)) return;
    if (!std::filesystem::exists(layer, error))
        throw InputError(layer.string(), "", "there is no such folder", "check the path");
    throw InputError(layer.string(), "", "is a file, but paint on a clip in segments is a folder",
                     Remedy::kNamePaintFolder);
}

EditLayer read_segment_paint(const std::filesystem::path& layer, const ClipSegment& segment,
                             const PaintedField& field) {
    const std::filesystem::path file = paint_file(layer, segment);
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return {field, {}};
    return read_paint(file, field);
}

void write_segment_paint(const std::filesystem::path& file, const EditLayer& layer) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error)
        throw RuntimeFailure(fmt::format("{}: cannot be made: {}", file.parent_path().string(), error.message()));
    if (!layer.edits.empty()) return write_paint(file, layer);
    std::filesystem::remove(file, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be removed: {}", file.string(), error.message()));
}

}  // namespace neuvv::voctree
