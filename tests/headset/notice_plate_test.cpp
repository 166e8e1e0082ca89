// Notices in view, and how errors are felt.
#include "tools/headset/draw/notice_plate.h"

#include <gtest/gtest.h>

#include "tools/headset/draw/label_font.h"

namespace neuvv::test {
namespace {

using headset::NoticePlate;

constexpr double kFrame_s = 1.0 / 90;
const xr::Pose kHead{{0.2, 1.6, 0.1}, {1, 0, 0, 0}};

double degrees_off(const NoticePlate& plate, const xr::Pose& head) {
    const glm::dvec3 to_plate = glm::normalize(plate.world_from_plate().position - head.position);
    return glm::degrees(std::acos(glm::clamp(glm::dot(to_plate, xr::forward_of(head)), -1.0, 1.0)));
}

TEST(NoticePlate, ItIsInViewForSomeSecondsWithoutThePanel) {
    NoticePlate plate;
    plate.update(kHead, {}, kFrame_s);
    EXPECT_TRUE(plate.lines().empty());
    plate.show({"saved show-2.gltf", false, 0});
    plate.update(kHead, {}, kFrame_s);
    EXPECT_EQ(plate.lines(), std::vector<std::string>{"saved show-2.gltf"});
    EXPECT_LT(degrees_off(plate, kHead), 20);
    EXPECT_LT(plate.world_from_plate().position.y, kHead.position.y) << "below the centre of the view";
    for (double t = 0; t < NoticePlate::kShown_s; t += kFrame_s) plate.update(kHead, {}, kFrame_s);
    EXPECT_TRUE(plate.lines().empty());
}

TEST(NoticePlate, APanelInViewHasTheNoticeAndOneElsewhereDoesNotCount) {
    NoticePlate plate;
    plate.show({"saved", false, 0});
    headset::PanelPlacement panel;
    panel.world_from_panel.position = kHead.position + glm::dvec3(0.2, 0, -1);
    plate.update(kHead, panel, kFrame_s);
    EXPECT_TRUE(plate.lines().empty());
    panel.world_from_panel.position = kHead.position + glm::dvec3(-1, -0.5, 0.2);
    plate.update(kHead, panel, kFrame_s);
    EXPECT_FALSE(plate.lines().empty());
}

TEST(NoticePlate, ItStaysInAViewThatTurnsAndDoesNotTremble) {
    NoticePlate plate;
    plate.show({"saved", false, 0});
    plate.update(kHead, {}, kFrame_s);
    const glm::dvec3 first = plate.world_from_plate().position;
    for (int degrees = -5; degrees <= 5; ++degrees) {
        plate.update({kHead.position, xr::turn_by(glm::radians(1.0 * degrees))}, {}, kFrame_s);
        EXPECT_LT(glm::distance(plate.world_from_plate().position, first), 1e-9) << degrees;
    }
    for (int degrees = 0; degrees < 400; degrees += 5) {
        const xr::Pose head{kHead.position, xr::turn_by(glm::radians(1.0 * degrees))};
        plate.update(head, {}, kFrame_s / 10);
        EXPECT_LT(degrees_off(plate, head), 25) << degrees;
    }
}

TEST(NoticePlate, AnErrorIsTwoPulsesAndSuccessNone) {
    const auto pulses = [](bool error) {
        NoticePlate plate;
        plate.update(kHead, {}, kFrame_s);
        plate.show({"it is locked", error, 0});
        int count = 0;
        for (int i = 0; i < 90; ++i) {
            plate.update(kHead, {}, kFrame_s);
            count += plate.pulse_begins();
            EXPECT_TRUE(!plate.pulse_begins() || plate.is_pulsing());
        }
        EXPECT_FALSE(plate.is_pulsing());
        return count;
    };
    EXPECT_EQ(pulses(true), 2);
    EXPECT_EQ(pulses(false), 0);
}

TEST(NoticePlate, AnErrorCanBeReadAndOneInEachFrameDoesNotHum) {
    NoticePlate plate;
    plate.show({"the sound has stopped", true, 0});
    plate.show({"saved", false, 0});
    plate.update(kHead, {}, kFrame_s);
    EXPECT_EQ(plate.lines(), std::vector<std::string>{"the sound has stopped"});
    int pulses = 0;
    for (int i = 0; i < 90; ++i) {
        plate.show({"the sound has stopped", true, 0});
        plate.update(kHead, {}, kFrame_s);
        pulses += plate.pulse_begins();
    }
    EXPECT_LE(pulses, 6);
}

TEST(NoticePlate, LongTextsAreWrappedAndCutOff) {
    const auto short_text = headset::plate_lines("the stroke is still being laid: undo waits for it");
    EXPECT_EQ(short_text, (std::vector<std::string>{"the stroke is still being laid:", "undo waits for it"}));
    const auto text = headset::plate_lines(
        "this headset cannot show your room: its runtime offers neither XR_FB_passthrough nor a blend mode for that");
    ASSERT_EQ(text.size(), NoticePlate::kLines);
    EXPECT_TRUE(text.back().ends_with(" …")) << text.back();
    for (const std::string& line : text) EXPECT_LE(line.size(), size_t{headset::LabelFont::kMaxLetters} + 2);
    std::string endless(500, 'x');
    EXPECT_EQ(headset::plate_lines(endless).size(), 1u);
    for (int i = 0; i < 9; ++i) endless.append(" y").append(100, 'y');
    EXPECT_EQ(headset::plate_lines(endless).size(), NoticePlate::kLines);
    EXPECT_TRUE(headset::plate_lines("").empty());
}

}  // namespace
}  // namespace neuvv::test
