// Cameras that Metashape exported as XML.
#include "training/data/layouts/loaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

struct Metashape : testing::Test {
    TemporaryFolder folder;
    std::string type = "frame", lens =
                                    "<f>90</f><cx>1.5</cx><cy>-2</cy><k1>0.1</k1><k2>-0.05</k2><k3>0.03</k3>"
                                    "<p1>0.01</p1><p2>0.02</p2>";
    std::string transform =
        "<transform><rotation locked=\"false\">0 -1 0 1 0 0 0 0 1</rotation>"
        "<translation>10 20 30</translation><scale>2</scale></transform>";
    std::string second_chunk, more_cameras;

    Metashape() {
        for (const char* camera : {"left", "middle", "right"})
            for (int frame = 0; frame < 2; ++frame)
                test::write_grey_png(folder.path / "images" / camera / fmt::format("{:04}.png", frame), 64, 48);
    }
    // The middle camera is turned by 90 degrees about its z and stands at (1, 2, 3) of its component.
    std::string xml() const {
        const auto camera = [](int id, const char* label, const char* pose) {
            return fmt::format(
                "<camera id=\"{}\" sensor_id=\"4\" component_id=\"0\" label=\"{}\">"
                "<transform>{}</transform></camera>\n",
                id, label, pose);
        };
        return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\">\n<chunk label=\"Chunk 1\">\n"
               "<sensors next_id=\"5\"><sensor id=\"4\" label=\"unknown\" type=\"" +
               type + "\"><resolution width=\"64\" height=\"48\"/>\n<calibration type=\"" + type +
               "\" class=\"initial\"><resolution width=\"64\" height=\"48\"/><f>1</f></calibration>\n"
               "<calibration type=\"" +
               type + "\" class=\"adjusted\"><resolution width=\"64\" height=\"48\"/>" + lens +
               "</calibration></sensor></sensors>\n<components next_id=\"1\" active_id=\"0\"><component id=\"0\">" +
               transform + "</component></components>\n<cameras next_id=\"9\">\n" +
               camera(0, "left.JPG", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1") + "<group id=\"0\" label=\"more\">\n" +
               camera(1, "middle", "0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1") +
               camera(2, "right", "1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1") + "</group>\n" + more_cameras +
               "<camera id=\"8\" sensor_id=\"4\" label=\"astray\"/>\n</cameras>\n</chunk>\n" + second_chunk +
               "</document>\n";
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        write_text(folder.path / "cameras.xml", xml());
        return training::read_rig(folder.path, split);
    }
    // Where NeuVV's world has a point that the middle camera sees at (x, y, z) in OpenCV's axes.
    static glm::dvec3 in_world(glm::dvec3 camera) {
        const glm::dvec3 component(-camera.y + 1, camera.x + 2, camera.z + 3);
        const glm::dvec3 chunk = 2.0 * glm::dvec3(-component.y, component.x, component.z) + glm::dvec3(10, 20, 30);
        return {chunk.x, chunk.z, -chunk.y};  // +Z up becomes +Y up
    }
    void expect_bad(std::string Metashape::*part, const std::string& value, std::initializer_list<std::string> words) {
        const std::string good = this->*part;
        this->*part = value;
        expect_input_error([&] { read(); }, words);
        this->*part = good;
    }
};

// A slave has no transform: it stands in its master as its sensor says.
TEST_F(Metashape, SlavesOfAMultiCameraSystemStandInTheirMaster) {
    const std::string slave = "<camera id=\"3\" sensor_id=\"5\" component_id=\"0\" label=\"slave\" master_id=\"1\"/>";
    test::write_grey_png(folder.path / "images" / "slave" / "0000.png", 64, 48);
    test::write_grey_png(folder.path / "images" / "slave" / "0001.png", 64, 48);
    const std::string one_sensor = xml();
    const std::string of_slave = one_sensor.substr(one_sensor.find("<sensor id"));
    std::string sensor = of_slave.substr(0, of_slave.find("</sensor>"));
    sensor.replace(sensor.find("\"4\""), 3, "\"5\" master_id=\"4\"");
    const auto write = [&](const std::string& place) {
        std::string text = xml();
        text.insert(text.find("</sensors>"), sensor + place + "</sensor>");
        write_text(folder.path / "cameras.xml", text);
        return training::read_rig(folder.path, training::Split::kTrain);
    };
    more_cameras = slave;
    // The slave is turned by 90 degrees about the master's x and stands half a unit to its right.
    const training::Rig rig = write("<rotation>1 0 0 0 0 -1 0 1 0</rotation><location>0.5 0 0</location>");
    ASSERT_EQ(rig.cameras.size(), 3u);
    const auto& placed = *std::ranges::find_if(rig.cameras, [](const auto& camera) { return camera.name == "slave"; });
    const glm::dvec3 in_slave(0.1, 0.2, 2), in_master = {0.6, -2, 0.2};
    const glm::dvec4 opengl(in_slave.x, -in_slave.y, -in_slave.z, 1);
    const glm::dvec3 found(placed.world_from_camera[3] +
                           2.0 * (placed.world_from_camera * (opengl - glm::dvec4(0, 0, 0, 1))));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], in_world(in_master)[i], 1e-9) << i;
    EXPECT_NE(rig.remarks.at(1).find("1 cameras of multi-camera systems"), std::string::npos);

    expect_input_error([&] { write(""); }, {"camera, line", "multi-camera system (master_id 1)"});
    more_cameras = slave;
    more_cameras.replace(more_cameras.find("sensor_id=\"5\""), 13, "sensor_id=\"4\"");
    expect_input_error([&] { read(); }, {"multi-camera system"});
    more_cameras.replace(more_cameras.find("master_id=\"1\""), 13, "master_id=\"7\"");
    expect_input_error([&] { read(); }, {"camera 7", "missing or disabled"});
    more_cameras.replace(more_cameras.find("master_id=\"7\""), 13, "master_id=\"8\"");
    EXPECT_EQ(read().cameras.size(), 2u) << "a master that is not aligned places none";
}

TEST_F(Metashape, APointFallsWhereTheManualPutsIt) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "metashape");
    ASSERT_EQ(rig.cameras.size(), 2u) << "the first, left, is held out";
    EXPECT_EQ(rig.cameras[0].name, "middle");
    const double x = 0.3, y = -0.2, r2 = x * x + y * y;
    const double radial = 1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.03 * r2 * r2 * r2;
    const double u = 32 + 1.5 + 90 * (x * radial + 0.01 * (r2 + 2 * x * x) + 2 * 0.02 * x * y);
    const double v = 24 - 2 + 90 * (y * radial + 0.02 * (r2 + 2 * y * y) + 2 * 0.01 * x * y);
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], in_world({3 * x, 3 * y, 3}));
    EXPECT_NEAR(found.x, u, 1e-9);
    EXPECT_NEAR(found.y, v, 1e-9);
    ASSERT_EQ(rig.shots.size(), 4u);
    EXPECT_EQ(rig.shots[1].time, 1);
    EXPECT_NE(rig.world.find("metres"), std::string::npos);
    ASSERT_EQ(rig.remarks.size(), 1u);
    EXPECT_NE(rig.remarks[0].find("1 of 4"), std::string::npos) << rig.remarks[0];
    EXPECT_EQ(read(training::Split::kTest).cameras.at(0).name, "left") << "the label's extension is dropped";
}

TEST_F(Metashape, FisheyesBendByTheAngle) {
    type = "equidistant_fisheye";
    lens = "<f>40</f><b1>2</b1><k1>0.1</k1><k2>-0.05</k2><k3>0.03</k3><k4>0.01</k4><p1>0.01</p1><p2>0.02</p2>";
    const double r = 1.5, angle = std::atan(r), c = std::cos(0.7), s = std::sin(0.7);
    const double x = angle * c, y = angle * s, r2 = angle * angle;
    const double radial = 1 + r2 * (0.1 + r2 * (-0.05 + r2 * (0.03 + r2 * 0.01)));
    const double u = 32 + (40 + 2) * (x * radial + 0.01 * (r2 + 2 * x * x) + 2 * 0.02 * x * y);
    const double v = 24 + 40 * (y * radial + 0.02 * (r2 + 2 * y * y) + 2 * 0.01 * x * y);
    const glm::dvec2 found = test::pixel_of(read().cameras[0], in_world({r * c, r * s, 1}));
    EXPECT_NEAR(found.x, u, 1e-9);
    EXPECT_NEAR(found.y, v, 1e-9);
}

TEST_F(Metashape, WithoutAReferenceTheWorldIsSaidToBeArbitrary) {
    transform = "";
    const training::Rig rig = read();
    EXPECT_EQ(glm::dvec3(rig.cameras[0].world_from_camera[3]), glm::dvec3(1, 2, 3));
    EXPECT_NE(rig.world.find("arbitrary"), std::string::npos) << rig.world;
    more_cameras =
        "<camera id=\"7\" sensor_id=\"4\" component_id=\"1\" label=\"x\"><transform>1 0 0 0 0 1 0 0 0 0 1 0 0 "
        "0 0 1</transform></camera>";
    expect_input_error([&] { read(); }, {"cameras.xml", "camera, line 14", "component"});
}

TEST_F(Metashape, ScaledCopiesAreTakenAndCropsRefused) {
    for (int frame = 0; frame < 2; ++frame)
        test::write_grey_png(folder.path / "images" / "middle" / fmt::format("{:04}.png", frame), 32, 24);
    EXPECT_EQ(read().cameras[0].lens.fx, 45);
    EXPECT_EQ(read().cameras[0].lens.cx, 0.5 * (32 + 1.5));
    for (int frame = 0; frame < 2; ++frame)
        test::write_grey_png(folder.path / "images" / "middle" / fmt::format("{:04}.png", frame), 64, 40);
    expect_input_error([&] { read(); }, {"64×40", "64×48", "another shape"});
}

// In coordinates of the whole earth, which have no axis that is up, nothing is turned.
TEST_F(Metashape, GeocentricCamerasAreMovedToTheOriginAndNotTurned) {
    const training::Rig turned = read();
    transform =
        "<transform><rotation>0 -1 0 1 0 0 0 0 1</rotation><translation>4000010.25 3000020 4500030</translation>"
        "<scale>2</scale></transform>";
    const training::Rig rig = read();
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.frame.unit, 1);
    EXPECT_LT(glm::length(glm::dvec3(rig.cameras[0].world_from_camera[3])), 100);
    const glm::dvec3 middle = rig.frame.to_capture(glm::dvec3(rig.cameras[0].world_from_camera[3]));
    const glm::dvec3 expected = glm::dvec3(4000010.25, 3000020, 4500030) + 2.0 * glm::dvec3(-2, 1, 3);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(middle[i], expected[i], 1e-8) << i;
        EXPECT_EQ(rig.frame.origin[i], std::round(rig.frame.origin[i]));
        const glm::dvec3 axis(rig.cameras[0].world_from_camera[i]), of_turned(turned.cameras[0].world_from_camera[i]);
        EXPECT_EQ(axis, glm::dvec3(of_turned.x, -of_turned.z, of_turned.y)) << "without +Z up to +Y up";
    }
    EXPECT_NE(rig.world.find("geocentric"), std::string::npos) << rig.world;
    EXPECT_NE(rig.world.find("Local Coordinates"), std::string::npos) << rig.world;

    more_cameras =
        "<camera id=\"3\" sensor_id=\"4\" component_id=\"0\" label=\"core\"><transform>1 0 0 -1.5e6 0 1 0 2e6 0 0 1 "
        "-2.25e6 0 0 0 1</transform></camera>";
    expect_input_error([&] { read(); }, {"cameras.xml", "Local Coordinates"});
}

TEST_F(Metashape, WhatNoLensHasIsRefusedByName) {
    constexpr auto calibration = &Metashape::lens;
    expect_bad(calibration, "<f>90</f><k4>0.1</k4>", {"cameras.xml", "calibration, line 6", "k4", "optimise"});
    expect_bad(calibration, "<f>90</f><b2>1</b2>", {"b2"});
    expect_bad(calibration, "<f>90</f><p3>1</p3>", {"p3"});
    expect_bad(calibration, "<cx>1</cx>", {"has no f"});
    expect_bad(calibration, "<f>ninety</f>", {"f, line 6", "not 1 numbers"});
    expect_bad(calibration, "<f>-90</f>", {"focal"});
    expect_bad(calibration, "<f>nan</f>", {"f, line 6"});
    expect_bad(&Metashape::type, "spherical", {"spherical", "undistorted"});
    expect_bad(&Metashape::second_chunk, "<chunk/>", {"2 chunks"});
    expect_bad(&Metashape::second_chunk, "<chunk>", {"cameras.xml", "no XML"});
    expect_bad(&Metashape::transform, "<transform><scale>0</scale></transform>", {"transform, line 7", "scale"});
    expect_bad(&Metashape::more_cameras, "<camera label=\"a\" sensor_id=\"4\"><transform>1 2</transform></camera>",
               {"16 numbers"});
    expect_bad(&Metashape::more_cameras,
               "<camera label=\"a\" sensor_id=\"5\"><transform>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</transform></camera>",
               {"sensor_id"});
    expect_bad(&Metashape::more_cameras,
               "<camera label=\"../a\" sensor_id=\"4\" component_id=\"0\"><transform>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
               "</transform></camera>",
               {"../a", "folder"});
    expect_bad(&Metashape::more_cameras,
               "<camera label=\"left\" sensor_id=\"4\" component_id=\"0\"><transform>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
               "</transform></camera>",
               {"left", "name"});
}

TEST_F(Metashape, TruncatedAnywhereIsNeverSilent) {
    const std::string whole = xml();
    for (size_t length = 60; length + 12 < whole.size(); length += 11) {
        write_text(folder.path / "cameras.xml", whole.substr(0, length));
        EXPECT_THROW(training::read_rig(folder.path, training::Split::kTrain), InputError) << length;
    }
}

}  // namespace
}  // namespace neuvv
