#include "interchange/mesh/mesh_files.h"

#include <fmt/format.h>

#include <cstring>
#include <iterator>
#include <string>

#include "base/output_path.h"
#include "base/platform.h"

namespace neuvv::interchange {

namespace {

std::filesystem::path beside(std::filesystem::path file, const char* ending) {
    return file.replace_extension(ending);
}

// Named so that it does not replace a rendered image that is numbered in the same way.
std::filesystem::path texture_of(const std::filesystem::path& file) {
    return file.parent_path() / (file.stem().string() + "_texture.png");
}

template <typename T>
void append_bytes(std::vector<uint8_t>& bytes, const T& value) {
    const size_t at = bytes.size();
    bytes.resize(at + sizeof(T));
    std::memcpy(&bytes[at], &value, sizeof(T));
}

}  // namespace

std::vector<std::filesystem::path> files_of_obj(const std::filesystem::path& file) {
    return {texture_of(file), beside(file, ".mtl"), file};
}

void write_mesh_obj(const std::filesystem::path& file, const ColouredMesh& mesh, const glm::dvec3& origin) {
    const bool is_empty = mesh.texture.width == 0;  // as that of a frame without a surface
    media::write_png(texture_of(file), is_empty ? media::Image(1, 1) : mesh.texture);
    write_text_file(beside(file, ".mtl"),
                    fmt::format("newmtl surface\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 0\nmap_Kd {}\n",
                                texture_of(file).filename().string()));
    std::string text = fmt::format("mtllib {}\nusemtl surface\n", beside(file, ".mtl").filename().string());
    const auto to = std::back_inserter(text);
    const int digits = origin == glm::dvec3(0) ? 7 : 14;
    for (const glm::vec3& position : mesh.mesh.positions) {
        const glm::dvec3 p = glm::dvec3(position) + origin;
        fmt::format_to(to, "v {:.{}g} {:.{}g} {:.{}g}\n", p.x, digits, p.y, digits, p.z, digits);
    }
    for (const glm::vec2& uv : mesh.mesh.uvs) fmt::format_to(to, "vt {:.6f} {:.6f}\n", uv.x, 1 - uv.y);
    for (const glm::vec3& n : mesh.mesh.normals) fmt::format_to(to, "vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
    for (const glm::uvec3& triangle : mesh.mesh.triangles) {
        const glm::uvec3 t = triangle + 1u;
        fmt::format_to(to, "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", t.x, t.y, t.z);
    }
    write_text_file(file, text);
}

void write_mesh_ply(const std::filesystem::path& file, const ColouredMesh& mesh, const glm::dvec3& origin) {
    const bool far = origin != glm::dvec3(0);
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    header += fmt::format("element vertex {}\n", mesh.mesh.positions.size());
    for (const char* name : {"x", "y", "z"}) header += fmt::format("property {} {}\n", far ? "double" : "float", name);
    for (const char* name : {"nx", "ny", "nz"}) header += fmt::format("property float {}\n", name);
    for (const char* name : {"red", "green", "blue"}) header += fmt::format("property uchar {}\n", name);
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                          mesh.mesh.triangles.size());
    std::vector<uint8_t> bytes(header.begin(), header.end());
    for (size_t i = 0; i < mesh.mesh.positions.size(); ++i) {
        if (far)
            append_bytes(bytes, glm::dvec3(mesh.mesh.positions[i]) + origin);
        else
            append_bytes(bytes, mesh.mesh.positions[i]);
        append_bytes(bytes, mesh.mesh.normals[i]);
        append_bytes(bytes, mesh.colours[i]);
    }
    for (const glm::uvec3& triangle : mesh.mesh.triangles) {
        bytes.push_back(3);
        append_bytes(bytes, triangle);
    }
    write_file_atomically(file, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

}  // namespace neuvv::interchange
